"""Perception: the local map, moving obstacles and where they may be."""

from dynastar.perception.detection import Known
from dynastar.perception.local_map import LocalMap, LocalMapConfig
from dynastar.perception.planning_map import PlanningMap
from dynastar.perception.prediction import PredictionConfig
from dynastar.perception.tracking import MovingObstacle, Track, Tracker, TrackerConfig

__all__ = [
    "Known", "LocalMap", "LocalMapConfig", "MovingObstacle", "PlanningMap", "PredictionConfig", "Track",
    "Tracker", "TrackerConfig",
]  # fmt: skip

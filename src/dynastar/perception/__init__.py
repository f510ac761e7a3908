"""Perception: the local map, moving obstacles and where they may be."""

from dynastar.perception.detection import Known
from dynastar.perception.local_map import LocalMap, LocalMapConfig
from dynastar.perception.prediction import PredictionConfig
from dynastar.perception.tracking import MovingObstacle, Track, Tracker, TrackerConfig

__all__ = [
    "Known", "LocalMap", "LocalMapConfig", "MovingObstacle", "PredictionConfig", "Track", "Tracker",
    "TrackerConfig",
]  # fmt: skip

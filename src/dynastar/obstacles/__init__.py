"""What the sensor saw: a layer that marks, clears and forgets, and a tracker of what moves."""

from dynastar.obstacles.layer import LayerConfig, ObstacleLayer
from dynastar.obstacles.tracker import Known, MovingObstacle, Tracker, TrackerConfig

__all__ = ["Known", "LayerConfig", "MovingObstacle", "ObstacleLayer", "Tracker", "TrackerConfig"]

"""The dynamic window approach: motion, window, admissibility, objective and search."""

from dynastar.dwa.config import DwaConfig, Weights
from dynastar.dwa.dwa import Body, Choice, DynamicWindow, body_of
from dynastar.dwa.scene import Scene

__all__ = [
    "Body", "Choice", "DwaConfig", "DynamicWindow", "Scene", "Weights", "body_of",
]  # fmt: skip

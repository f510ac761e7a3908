"""The dynamic window approach: window (5-7), rollouts, the certified stop, evaluation (8-9)."""

from dynastar.dwa.config import DwaConfig, Weights
from dynastar.dwa.dwa import Choice, DynamicWindow, Margins, Surroundings, Wish
from dynastar.dwa.passing import Passing, Start

__all__ = [
    "Choice",
    "DwaConfig",
    "DynamicWindow",
    "Margins",
    "Passing",
    "Start",
    "Surroundings",
    "Weights",
    "Wish",
]

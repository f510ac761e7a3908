"""The hybrid navigator of section V, and what goes in and comes out of it."""

from dynastar.navigator.config import PRESETS, NavigatorConfig, Preset, configured
from dynastar.navigator.guard import Guard, Guarded
from dynastar.navigator.navigator import Navigator
from dynastar.navigator.status import STATES, RobotState, State, Status

__all__ = [
    "PRESETS",
    "STATES",
    "Guard",
    "Guarded",
    "Navigator",
    "NavigatorConfig",
    "Preset",
    "RobotState",
    "State",
    "Status",
    "configured",
]

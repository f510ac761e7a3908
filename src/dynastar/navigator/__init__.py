"""The hybrid navigator of section V, and what goes in and comes out of it."""

from dynastar.navigator.config import PRESETS, NavigatorConfig, configured
from dynastar.navigator.navigator import Navigator
from dynastar.navigator.status import STATES, RobotState, State, Status

__all__ = [
    "PRESETS",
    "STATES",
    "Navigator",
    "NavigatorConfig",
    "RobotState",
    "State",
    "Status",
    "configured",
]

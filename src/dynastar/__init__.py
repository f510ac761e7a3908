"""dynastar (dynamic window + A*): navigation for differential-drive robots."""

from importlib import import_module
from typing import Any

from dynastar import _kernel_cache

__version__ = "0.1.0"

_kernel_cache.use()

_WHERE = {
    "Limits": "robot",
    "Robot": "robot",
    "ROBOTS": "robot",
    "Footprint": "robot",
    "Lidar": "robot",
    "Pose2D": "geometry",
    "Twist": "geometry",
    "Goal": "geometry",
    "OccupancyGrid": "grid",
    "GridFrame": "grid",
    "LaserScan": "scan",
    "Path": "path",
    "plan": "planning",
    "Navigator": "navigator",
    "NavigatorConfig": "navigator",
    "RobotState": "navigator",
    "Scenario": "simulation",
    "load_map": "io",
    "save_map": "io",
    "load_scenario": "io",
    "run": "io",
}

__all__ = ["__version__", *_WHERE]


def __getattr__(name: str) -> Any:
    """Imports a public name when it is first asked for, so that ``import dynastar`` costs nothing."""
    if name not in _WHERE:
        raise AttributeError(f"module 'dynastar' has no attribute '{name}'")
    return getattr(import_module(f"dynastar.{_WHERE[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)

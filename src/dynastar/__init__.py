"""dynastar (dynamic window + A*): navigation for differential-drive robots."""

__version__ = "0.1.0"

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


def __getattr__(name: str) -> object:
    """Imports a public name when it is first asked for, so that ``import dynastar`` costs nothing."""
    from importlib import import_module

    if name not in _WHERE:
        raise AttributeError(f"module 'dynastar' has no attribute '{name}'")
    return getattr(import_module(f"dynastar.{_WHERE[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)

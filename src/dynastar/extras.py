"""Packages that only some uses need; ``pip install 'dynastar[EXTRA]'`` installs them."""

import importlib.util
from collections.abc import Callable
from typing import Any

from dynastar.errors import MissingPackage

EXTRAS = {
    "viewer": ("matplotlib",),
    "bench": ("matplotlib", "scipy"),
    "bags": ("rosbags",),
    "play": ("starlette", "uvicorn", "websockets", "tomli_w"),
    "pandas": ("pandas",),
    "ros": ("rclpy", "nav_msgs", "visualization_msgs", "diagnostic_msgs", "std_srvs"),
}


def installed(extra: str) -> bool:
    """Whether an extra's packages are there."""
    return all(importlib.util.find_spec(package) for package in EXTRAS[extra])


def require(extra: str, what: str) -> None:
    """Raises MissingPackage, which calls what needs them ``what``, if an extra's packages are not there."""
    if not installed(extra):
        packages = ", ".join(EXTRAS[extra])
        raise MissingPackage(f"{what} {packages}: pip install 'dynastar[{extra}]'")


def plotter(name: str) -> Callable[..., Any]:
    """The function ``name`` of ``viewer.plots``, imported when something is drawn; MissingPackage.

    Every layer has objects to draw, and the viewer, which lies above them, draws them.
    """
    plots: Any = importlib.import_module("dynastar.viewer.plots")
    return getattr(plots, name)

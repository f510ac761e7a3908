"""Packages that only some uses need, by the name of the extra that installs them."""

import importlib.util
from collections.abc import Callable
from typing import Any

from dynastar.errors import MissingPackage

PUBLISHED = False  # whether pip finds dynastar by its name; until then it is installed from a clone

EXTRAS = {
    "viewer": ("matplotlib",),
    "bench": ("matplotlib", "scipy"),
    "bags": ("rosbags",),
    "tune": ("optuna", "matplotlib", "scipy"),
    "play": ("starlette", "uvicorn", "websockets", "tomli_w"),
    "pandas": ("pandas",),
    "ros": ("rclpy", "nav_msgs", "visualization_msgs", "diagnostic_msgs", "std_srvs"),
}


def install_command(extra: str) -> str:
    """The command that installs an extra; before publication it works in the folder of a clone."""
    return f"pip install '{'dynastar' if PUBLISHED else '.'}[{extra}]'"


def how_to_install(extra: str) -> str:
    """The command that installs an extra, and where to type it."""
    return f"{install_command(extra)}{'' if PUBLISHED else ' in your clone of dynastar'}"


def installed(extra: str) -> bool:
    """Whether an extra's packages are there."""
    return all(importlib.util.find_spec(package) for package in EXTRAS[extra])


def require(extra: str, what: str) -> None:
    """Raises MissingPackage, which calls what needs them ``what``, if an extra's packages are not there."""
    if not installed(extra):
        packages = ", ".join(EXTRAS[extra])
        raise MissingPackage(f"{what} {packages}: {how_to_install(extra)}")


def plotter(name: str) -> Callable[..., Any]:
    """The function ``name`` of ``viewer.plots``, imported when something is drawn; MissingPackage.

    Every layer has objects to draw, and the viewer, which lies above them, draws them.
    """
    plots: Any = importlib.import_module("dynastar.viewer.plots")
    return getattr(plots, name)

"""What can drive in a suite, by name: ``--controller``.

A controller is a class with the protocol ``dynastar.simulation.Controller``::

    class Mine:
        def __init__(self, grid, robot, config): ...   # OccupancyGrid, Robot, NavigatorConfig
        def set_goal(self, goals): ...                 # Goals to reach in order
        def command(self, state, scan) -> Twist: ...   # RobotState, LaserScan or None
        status                                         # see Status here; its fields are read
        def set_map(self, grid): ...                   # optional, another map under way

Of ``config`` it may read what the mission asks for: ``period`` and ``latency`` (s),
``goal_tolerance`` (m), ``heading_tolerance`` (rad) and ``unknown`` ("free" or "blocked").
``status.state`` ends a mission with "arrived" or "blocked", and counts as without data while it is
"sensor_lost"; other words are free.
"""

from collections.abc import Callable
from importlib import import_module
from importlib.util import find_spec
from typing import Any

from dynastar.config import nearest
from dynastar.errors import ConfigError
from dynastar.extras import how_to_install

BUILT_IN = {
    "navigator": "",
    "pure_pursuit": "dynastar.bench.controllers.pure_pursuit:PurePursuit",
    "printed": "dynastar.bench.controllers.printed:Printed",
    "kompass_dwa": "dynastar.bench.controllers.kompass:KompassDwa",
    "orca": "dynastar.bench.controllers.orca:Orca",
}
PACKAGES = {  # that a controller needs: module, name on the index, extra
    "kompass_dwa": ("kompass_core", "kompass-core", "kompass"),
    "orca": ("pyrvo", "pyrvo", "crowdnav"),
}
NEEDED = ("set_goal", "command")


def controller_named(name: str) -> Callable[..., Any] | None:
    """The controller class of a name or MODULE:CLASS; None is the project's own Navigator.

    Raises ConfigError for a name, module or class that is not there, and for a class that lacks
    what the protocol needs.
    """
    if name == "navigator":
        return None
    if name in PACKAGES:
        module, package, extra = PACKAGES[name]
        if find_spec(module) is None:
            raise ConfigError(f"the controller {name} needs {package}: {how_to_install(extra)}")
    where = BUILT_IN.get(name, name)
    module_name, colon, class_name = where.partition(":")
    if not (colon and module_name and class_name):
        raise ConfigError(
            f"unknown controller '{name}'{nearest(name, BUILT_IN)}; a class of your own is "
            "MODULE:CLASS, as in my_package.my_module:MyController"
        )
    return _imported(module_name, class_name)


def _imported(module_name: str, class_name: str) -> Callable[..., Any]:
    try:
        module = import_module(module_name)
    except ImportError as error:
        raise ConfigError(
            f"--controller {module_name}:{class_name}: the module cannot be imported ({error}); it "
            "has to be installed or on PYTHONPATH"
        ) from error
    found = getattr(module, class_name, None)
    if not callable(found):
        legal = [key for key, value in vars(module).items() if isinstance(value, type)]
        raise ConfigError(
            f"--controller {module_name}:{class_name}: no class '{class_name}' in {module_name}"
            f"{nearest(class_name, legal)}"
        )
    missing = [method for method in NEEDED if not callable(getattr(found, method, None))]
    if isinstance(found, type) and missing:
        raise ConfigError(
            f"--controller {module_name}:{class_name}: the class has no {' and no '.join(missing)}; "
            "a controller is described in dynastar.bench.controllers"
        )
    return found

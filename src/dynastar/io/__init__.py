"""Files in and out: maps, scenarios and episodes."""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from dynastar.io.episode_file import load_episode, save_episode
from dynastar.io.files import jsonable, write_json, written_aside
from dynastar.io.maps import load_map, save_map
from dynastar.io.movingai import load_movingai_map, load_scenarios
from dynastar.io.ros_map import load_ros_map, save_ros_map

if TYPE_CHECKING:
    from dynastar.io.scenario_file import load_scenario, run
    from dynastar.io.scenario_writing import save_scenario

__all__ = [
    "jsonable",
    "load_episode",
    "load_map",
    "load_movingai_map",
    "load_ros_map",
    "load_scenario",
    "load_scenarios",
    "run",
    "save_episode",
    "save_map",
    "save_ros_map",
    "save_scenario",
    "write_json",
    "written_aside",
]

_LATER = {
    "load_scenario": "scenario_file",
    "run": "scenario_file",
    "save_scenario": "scenario_writing",
}


def __getattr__(name: str) -> Any:
    """Imports what needs the simulation when it is first asked for: a map alone loads without."""
    if name in _LATER:
        return getattr(import_module(f"dynastar.io.{_LATER[name]}"), name)
    raise AttributeError(f"module 'dynastar.io' has no attribute '{name}'")

"""Files in and out: maps, scenarios and episodes."""

_WHERE = {
    "jsonable": "files",
    "load_episode": "episode_file",
    "load_faults": "scenario_file",
    "load_map": "maps",
    "load_movingai_map": "movingai",
    "load_robot": "scenario_file",
    "load_ros_map": "ros_map",
    "load_scenario": "scenario_file",
    "load_scenarios": "movingai",
    "run": "scenario_file",
    "save_episode": "episode_file",
    "save_map": "maps",
    "save_ros_map": "ros_map",
    "save_scenario": "scenario_writing",
    "write_json": "files",
}

TYPE_CHECKING = False
if TYPE_CHECKING:  # what _WHERE has, for type checkers
    from dynastar.io.episode_file import load_episode as load_episode
    from dynastar.io.episode_file import save_episode as save_episode
    from dynastar.io.files import jsonable as jsonable
    from dynastar.io.files import write_json as write_json
    from dynastar.io.maps import load_map as load_map
    from dynastar.io.maps import save_map as save_map
    from dynastar.io.movingai import load_movingai_map as load_movingai_map
    from dynastar.io.movingai import load_scenarios as load_scenarios
    from dynastar.io.ros_map import load_ros_map as load_ros_map
    from dynastar.io.ros_map import save_ros_map as save_ros_map
    from dynastar.io.scenario_file import load_faults as load_faults
    from dynastar.io.scenario_file import load_robot as load_robot
    from dynastar.io.scenario_file import load_scenario as load_scenario
    from dynastar.io.scenario_file import run as run
    from dynastar.io.scenario_writing import save_scenario as save_scenario
else:

    def __getattr__(name):
        """Imports a function when it is first asked for, so that each loads without the others."""
        from importlib import import_module

        if name not in _WHERE:
            raise AttributeError(f"module 'dynastar.io' has no attribute '{name}'")
        return getattr(import_module(f"dynastar.io.{_WHERE[name]}"), name)

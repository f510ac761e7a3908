"""dynastar (dynamic window + A*): navigation for differential-drive robots."""

from dynastar import notebook

__version__ = "0.2.0"

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
    "Guard": "navigator",
    "Guarded": "navigator",
    "NavigatorConfig": "navigator",
    "RobotState": "navigator",
    "Status": "navigator",
    "State": "navigator",
    "configured": "navigator",
    "Plan": "planning",
    "GridPlanner": "planning",
    "PlannerConfig": "planning",
    "MovingObstacle": "perception",
    "Episode": "episode",
    "Scenario": "simulation",
    "World": "simulation",
    "warm_up": "simulation",
    "DynastarError": "errors",
    "DynastarWarning": "errors",
    "InputError": "errors",
    "PlanningError": "errors",
    "load_episode": "io",
    "save_episode": "io",
    "load_map": "io",
    "save_map": "io",
    "load_scenario": "io",
    "run": "io",
}

__all__ = ["__version__", *_WHERE]

TYPE_CHECKING = False
if TYPE_CHECKING:  # what _WHERE has, for type checkers
    from dynastar.episode import Episode as Episode
    from dynastar.errors import DynastarError as DynastarError
    from dynastar.errors import DynastarWarning as DynastarWarning
    from dynastar.errors import InputError as InputError
    from dynastar.errors import PlanningError as PlanningError
    from dynastar.footprint import Footprint as Footprint
    from dynastar.geometry import Goal as Goal
    from dynastar.geometry import Pose2D as Pose2D
    from dynastar.geometry import Twist as Twist
    from dynastar.grid import GridFrame as GridFrame
    from dynastar.grid import OccupancyGrid as OccupancyGrid
    from dynastar.io import load_episode as load_episode
    from dynastar.io import load_map as load_map
    from dynastar.io import load_scenario as load_scenario
    from dynastar.io import run as run
    from dynastar.io import save_episode as save_episode
    from dynastar.io import save_map as save_map
    from dynastar.navigator import Guard as Guard
    from dynastar.navigator import Guarded as Guarded
    from dynastar.navigator import Navigator as Navigator
    from dynastar.navigator import NavigatorConfig as NavigatorConfig
    from dynastar.navigator import RobotState as RobotState
    from dynastar.navigator import State as State
    from dynastar.navigator import Status as Status
    from dynastar.navigator import configured as configured
    from dynastar.path import Path as Path
    from dynastar.perception import MovingObstacle as MovingObstacle
    from dynastar.planning import GridPlanner as GridPlanner
    from dynastar.planning import Plan as Plan
    from dynastar.planning import PlannerConfig as PlannerConfig
    from dynastar.planning import plan as plan
    from dynastar.robot import ROBOTS as ROBOTS
    from dynastar.robot import Lidar as Lidar
    from dynastar.robot import Limits as Limits
    from dynastar.robot import Robot as Robot
    from dynastar.scan import LaserScan as LaserScan
    from dynastar.simulation import Scenario as Scenario
    from dynastar.simulation import World as World
    from dynastar.simulation import warm_up as warm_up
else:

    def __getattr__(name):
        """Imports a public name when it is first asked for, so that ``import dynastar`` costs nothing."""
        from importlib import import_module

        if name not in _WHERE:
            raise AttributeError(f"module 'dynastar' has no attribute '{name}'")
        return getattr(import_module(f"dynastar.{_WHERE[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)


def _episode_html(episode: "Episode") -> str:
    """The page that replays the episode, in a frame."""
    from dynastar.page import framed

    return framed(episode)


notebook.episode_html = _episode_html

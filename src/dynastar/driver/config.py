"""The settings of the navigator by cost-to-go."""

from typing import Annotated, Any, Literal, NamedTuple

from dynastar.config import Field, checked
from dynastar.driver.window_config import DwaConfig
from dynastar.perception import LocalMapConfig, PredictionConfig, TrackerConfig
from dynastar.planning import HeuristicConfig, PlannerConfig

SHARED = (
    "period", "latency", "range_error", "pose_error", "heading_error", "hidden_speed", "reverse",
    "scan_age", "unknown", "goal_tolerance", "heading_tolerance", "stuck_time", "attempts", "planner",
)  # fmt: skip


class NavigatorConfig(NamedTuple):
    """Everything a navigator can be told; the declared bounds are what its promise rests on."""

    period: Annotated[float, Field("time between two commands", "s", 0.01, 1.0)] = 0.1
    latency: Annotated[float, Field("a command acts so much later", "s", 0.0, 1.0)] = 0.0
    range_error: Annotated[float, Field("bound of a range's error", "m", 0.0, 1.0)] = 0.01
    pose_error: Annotated[float, Field("bound of the position's error", "m", 0.0, 1.0)] = 0.01
    heading_error: Annotated[float, Field("bound of the heading's error", "rad", 0.0, 0.5)] = 0.0
    hidden_speed: Annotated[
        float, Field("somebody may come out of unseen space so fast, 0 if nobody", "m/s", 0.0, 20.0)
    ] = 0.5
    reverse: Annotated[bool, Field("drive back where the robot can, if need be")] = True
    scan_age: Annotated[float, Field("older data are no data", "s", 0.05, 5.0)] = 0.3
    unknown: Annotated[Literal["free", "blocked"], Field("plan through unknown space?")] = "blocked"
    goal_tolerance: Annotated[float, Field("so near is there", "m", 0.01, 5.0)] = 0.25
    heading_tolerance: Annotated[float, Field("so well aligned is aligned", "rad", 0.01, 3.2)] = 0.1
    global_path: Annotated[
        Literal["replanned", "once"], Field("planned whenever need be, or for each goal once")
    ] = "replanned"
    planning_resolution: Annotated[float, Field("plan on cells no larger", "m", 0.01, 10.0)] = 0.05
    comfort: Annotated[float, Field("clearance a plan has to spare if it can", "m", 0.0, 5.0)] = 0.1
    stuck_time: Annotated[float, Field("no progress for so long is stuck", "s", 0.5, 120.0)] = 6.0
    attempts: Annotated[int, Field("rounds of recovery before giving up", "", 1, 100)] = 4
    planner: PlannerConfig = PlannerConfig(heuristic=HeuristicConfig(parent=False, q="ratio"))
    dwa: DwaConfig = DwaConfig()
    local_map: LocalMapConfig = LocalMapConfig()
    tracker: TrackerConfig = TrackerConfig()
    prediction: PredictionConfig = PredictionConfig()


def adapted(mission: Any) -> NavigatorConfig:
    """The settings with those that ``mission`` has under the same name (a NavigatorConfig of any kind).

    What only has the same name, a nested table of another type, is left at its default.
    """
    if mission is None or isinstance(mission, NavigatorConfig):
        return mission or NavigatorConfig()
    given = {
        name: getattr(mission, name) for name in SHARED if getattr(mission, name, None) is not None
    }
    return checked(NavigatorConfig, given)

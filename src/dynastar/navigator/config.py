"""The navigator's settings, and the presets."""

from collections.abc import Mapping
from typing import Annotated, Any, Literal, NamedTuple

from dynastar.config import Field, checked, choose, self_checking
from dynastar.dwa.config import ArcsConfig, DwaConfig, Weights
from dynastar.perception import LocalMapConfig, PredictionConfig, TrackerConfig
from dynastar.planning import PlannerConfig

CELLS = 4  # of the maps, at least, to a robot's inscribed radius


@self_checking
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
        Literal["replanned", "strayed", "once"],
        Field("planned whenever need be, or where the robot left it (V, step 4), or once"),
    ] = "replanned"
    stray: Annotated[
        float, Field("further from its path a robot has left it (V, step 4)", "m", 0.01, 100.0)
    ] = 1.0
    planning_resolution: Annotated[float, Field("plan on cells no larger", "m", 0.001, 10.0)] = 0.05
    comfort: Annotated[float, Field("clearance a plan has to spare if it can", "m", 0.0, 5.0)] = 0.1
    stuck_time: Annotated[float, Field("no progress for so long is stuck", "s", 0.5, 120.0)] = 6.0
    attempts: Annotated[int, Field("rounds of recovery before giving up", "", 0, 100)] = 4
    track: Annotated[bool, Field("tell moving obstacles from what stands")] = True
    planner: PlannerConfig = PlannerConfig(exact=True)
    dwa: DwaConfig = DwaConfig()
    local_map: LocalMapConfig = LocalMapConfig()
    tracker: TrackerConfig = TrackerConfig()
    prediction: PredictionConfig = PredictionConfig()


Preset = Literal["default", "paper", "printed"]
PRESETS: dict[str, NavigatorConfig] = {
    "default": NavigatorConfig(),
    "paper": NavigatorConfig(
        reverse=False,
        planner=PlannerConfig(),
        dwa=DwaConfig(weights=Weights(0.5, 0.2, 0.2, 0.1)),
    ),
    "printed": NavigatorConfig(
        reverse=False,
        hidden_speed=0.0,
        track=False,
        comfort=0.0,
        global_path="strayed",
        stuck_time=30.0,
        attempts=0,
        planner=PlannerConfig(),
        dwa=DwaConfig(
            weights=Weights(0.5, 0.2, 0.2, 0.1, risk=0.0),
            search="arcs",
            progress="bearing",
            reach=0.0,
            v_samples=21,
            omega_samples=41,
            comfort=10.0,
            hysteresis=0.0,
            arcs=ArcsConfig(motion="printed", stop="printed", dist="end", normalise="sums"),
        ),
    ),
}


def fitted(config: NavigatorConfig, inscribed: float) -> NavigatorConfig:
    """Cells down to half as large for a robot of a small ``inscribed`` radius (m), in as many.

    Range noise and rounding close gaps by a cell or two, which a small robot needs.
    """
    local = config.local_map
    side = max(inscribed / CELLS, 0.5 * local.resolution)
    share = min(1.0, side / local.resolution)
    return config._replace(
        planning_resolution=min(config.planning_resolution, side),
        local_map=local._replace(resolution=share * local.resolution, size=share * local.size),
    )


def configured(
    preset: str = "default", overrides: Mapping[str, Any] | None = None
) -> NavigatorConfig:
    """A preset with ``overrides``, nested tables by field name; ConfigError names what is wrong."""
    return _merged(choose(preset, PRESETS, "preset"), overrides or {}, "")


def _merged(base: Any, overrides: Mapping[str, Any], where: str) -> Any:
    values = dict(base._asdict())
    for key, value in overrides.items():
        current = values.get(key)
        nested = hasattr(current, "_asdict") and isinstance(value, Mapping)
        values[key] = _merged(current, value, f"{where}{key}.") if nested else value
    return checked(type(base), values, where.rstrip("."))

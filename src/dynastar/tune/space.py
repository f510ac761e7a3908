"""The settings that are searched, with their ranges.

The declared bounds of the no-contact guarantee (errors, latency, period, age of scans, accelerations) are
measurements: none of them is here.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

from dynastar.bench.presets import settings_of
from dynastar.navigator import NavigatorConfig
from dynastar.robot import Limits, Robot
from dynastar.ros.settings import nested

LIMITS = "limits."  # leads the names of limits, which are searched as fractions of the robot's own

Values = Mapping[str, float]  # of the parameters, by name


@dataclass(frozen=True)
class Parameter:
    """A setting by dotted name with the range that is searched; ``log``: by its logarithm."""

    name: str
    low: float
    high: float
    log: bool = False


SPACE: tuple[Parameter, ...] = (
    Parameter("dwa.weights.dist", 0.02, 1.0, log=True),
    Parameter("dwa.weights.vel", 0.02, 1.0, log=True),
    Parameter("dwa.weights.simi", 0.0, 0.5),
    Parameter("dwa.weights.risk", 2.0, 100.0, log=True),
    Parameter("dwa.weights.nearness", 0.1, 10.0, log=True),
    Parameter("dwa.horizon", 2.0, 7.0),
    Parameter("dwa.comfort", 0.05, 0.6),
    Parameter("dwa.hysteresis", 0.0, 0.1),
    Parameter("dwa.arc_time", 0.2, 1.5),
    Parameter("dwa.reach", 0.3, 2.0),
    Parameter("comfort", 0.0, 0.4),
    Parameter("prediction.spread", 0.05, 0.5),
)
OF_ROBOT = (Parameter("limits.v_max", 0.6, 1.0), Parameter("limits.omega_max", 0.5, 1.0))


def of_robot(limits: Limits) -> tuple[Parameter, ...]:
    """The speeds of a robot as fractions of its own, none below the least that its drive follows."""
    least = limits.v_least / limits.v_max, limits.omega_least / limits.omega_max
    lows = [max(one.low, low) for one, low in zip(OF_ROBOT, least, strict=True)]
    return tuple(
        replace(one, low=low) for one, low in zip(OF_ROBOT, lows, strict=True) if low < one.high
    )


def start_values(space: Sequence[Parameter], config: NavigatorConfig) -> dict[str, float]:
    """The values with which the search begins: those of ``config``, and the robot's own limits."""
    own = {name: value for name, _, value in settings_of(config)}
    return {parameter.name: own.get(parameter.name, 1.0) for parameter in space}


def widened(space: Sequence[Parameter], values: Values) -> tuple[Parameter, ...]:
    """The parameters, with ranges that have ``values`` in them."""
    return tuple(
        Parameter(one.name, low, high, one.log and low > 0.0)
        for one in space
        for low, high in [(min(one.low, values[one.name]), max(one.high, values[one.name]))]
    )


def settings_table(values: Values) -> dict[str, Any]:
    """The values as settings of the navigator, in nested tables; limits are left out."""
    return nested({name: value for name, value in values.items() if not name.startswith(LIMITS)})


def limit_fractions(values: Values) -> dict[str, float]:
    """The fractions of the robot's limits in ``values``, by the limits' names."""
    return {
        name.removeprefix(LIMITS): value
        for name, value in values.items()
        if name.startswith(LIMITS)
    }


def limited(robot: Robot, values: Values) -> Robot:
    """The robot with its limits times the fractions in ``values``."""
    own = robot.limits._asdict()
    limits = {name: own[name] * fraction for name, fraction in limit_fractions(values).items()}
    return Robot(robot.name, robot.limits._replace(**limits), robot.footprint, robot.lidar)

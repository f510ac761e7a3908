"""The settings that the page has sliders for, and what changing one means."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from dynastar.config import choose
from dynastar.errors import ConfigError
from dynastar.robot import Robot
from dynastar.simulation import Scenario


class Slider(NamedTuple):
    """Range of a setting on the page, in the setting's unit."""

    low: float
    high: float
    step: float
    doc: str


SLIDERS: Mapping[str, Slider] = {
    "dwa.weights.heading": Slider(0.0, 2.0, 0.05, "alpha, progress"),
    "dwa.weights.dist": Slider(0.0, 2.0, 0.05, "beta, clearance"),
    "dwa.weights.vel": Slider(0.0, 2.0, 0.05, "gamma, speed"),
    "dwa.weights.simi": Slider(0.0, 2.0, 0.05, "sigma, similarity to the path"),
    "dwa.weights.risk": Slider(0.0, 50.0, 1.0, "rho, risk"),
    "dwa.weights.nearness": Slider(0.0, 5.0, 0.1, "nu, nearness"),
    "dwa.horizon": Slider(0.5, 8.0, 0.5, "horizon, s"),
    "dwa.v_samples": Slider(2, 25, 1, "speeds sampled"),
    "dwa.omega_samples": Slider(3, 41, 2, "turning rates sampled"),
}
LIMITS: Mapping[str, str] = {  # as shares of what the robot has
    "v_max": "largest speed, m/s",
    "omega_max": "largest turning rate, rad/s",
    "v_accel": "acceleration, m/s2",
    "v_brake": "deceleration, m/s2",
}
LEAST = 0.2  # share of a limit


def sliders(robot: Robot) -> dict[str, Slider]:
    """All sliders by the name of their setting, for a robot as it was built."""
    found = dict(SLIDERS)
    for name, doc in LIMITS.items():
        high = getattr(robot.limits, name)
        found[f"limits.{name}"] = Slider(LEAST * high, high, 0.01 * high, doc)
    return found


def with_setting(scenario: Scenario, built: Robot, name: str, value: float) -> Scenario:
    """``scenario`` with another value of a setting; ``built`` is its robot as it was built.

    Raises ConfigError for what has no slider, or a value beyond it.
    """
    slider = choose(name, sliders(built), "setting")
    if not slider.low - 1e-9 <= value <= slider.high + 1e-9:
        raise ConfigError(f"'{name}' is {value:g}: legal is {slider.low:g} to {slider.high:g}")
    table, _, field = name.rpartition(".")
    if table == "limits":
        limits = scenario.robot.limits._replace(**{field: value})
        return replace(scenario, robot=replace(scenario.robot, limits=limits))
    return replace(scenario, navigator=_changed(scenario.navigator, name.split("."), value))


def _changed(tables: Mapping[str, Any], path: list[str], value: float) -> dict[str, Any]:
    """Nested tables with another value at a path."""
    first, *rest = path
    return {**tables, first: _changed(tables.get(first, {}), rest, value) if rest else value}


def value_of(robot: Robot, config: Any, name: str) -> float:
    """The present value of a setting that has a slider."""
    table, _, field = name.rpartition(".")
    found: Any = robot.limits if table == "limits" else config
    for part in [field] if table == "limits" else name.split("."):
        found = getattr(found, part)
    return float(found)

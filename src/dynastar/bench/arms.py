"""The arms of the ablation: what is left out or read differently, one thing at a time."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, NamedTuple

from dynastar.bench.controllers.printed import Printed
from dynastar.bench.follower import Follower
from dynastar.bench.missions import row_of
from dynastar.bench.settings import merged
from dynastar.bench.unplanned import Unplanned
from dynastar.metrics import measure
from dynastar.navigator import Preset
from dynastar.planning import HeuristicConfig
from dynastar.simulation import Controller, Scenario
from dynastar.simulation import run as drive

ALL_TERMS = HeuristicConfig()
PLAIN = HeuristicConfig(exponential=False, parent=False, k=0.0, weight=1.0)

PLAIN_ASTAR = "Eq. 2: none of them (octile A*)"

# Eq. 2 with one of its terms left out or read differently: planner and terms, on one kernel.
TERMS: dict[str, tuple[str, HeuristicConfig]] = {
    "Eq. 2: all terms": ("improved", ALL_TERMS),
    "Eq. 2: k = 0": ("improved", ALL_TERMS._replace(k=0.0)),
    "Eq. 2: beta as interior angle": ("improved", ALL_TERMS._replace(beta="interior")),
    "Eq. 2: Q as a line": ("improved", ALL_TERMS._replace(q="line")),
    "Eq. 2: P / Q around n": ("improved", ALL_TERMS._replace(q="ratio")),
    "Eq. 2: no h(p)": ("improved", ALL_TERMS._replace(parent=False)),
    "Eq. 2: no e^(P/Q)": ("improved", ALL_TERMS._replace(exponential=False)),
    PLAIN_ASTAR: ("weighted", PLAIN),
}

BASE_TERMS = "Eq. 2: all terms"  # what the default has
BASE = "default"
NOT_EXACT = "no exact improvement"


class Arm(NamedTuple):
    """An arm: a preset, settings that differ from it, or a controller in the navigator's place.

    ``base`` names the arm that it is compared with.
    """

    preset: Preset = "default"
    navigator: Mapping[str, Any] = {}
    controller: Callable[..., Controller] | None = None
    base: str = BASE


def run_mission(
    scenario: Scenario, arm: Arm, settings: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Drives a world the way of an arm and returns its metrics; "error" if that raises.

    ``settings`` of the navigator are over those of the preset, but below those of the arm.
    """
    navigator = merged(merged(scenario.navigator, settings or {}), arm.navigator)
    driven = replace(scenario, preset=arm.preset, navigator=navigator)
    return row_of(lambda: measure(drive(driven, navigator=arm.controller))._asdict())


def _terms(planner: str, heuristic: HeuristicConfig) -> Arm:
    """Other terms without the exact search, which would replace most of their paths."""
    planning = {"planner": planner, "heuristic": heuristic._asdict(), "exact": False}
    return Arm(navigator={"planner": planning}, base=NOT_EXACT)


def _navigator(**settings: Any) -> Arm:
    return Arm(navigator=settings)


def _window(**settings: Any) -> Arm:
    return _navigator(dwa=settings)


def _weights(**weights: float) -> Arm:
    return _window(weights=weights)


ARMS: dict[str, Arm] = {
    BASE: Arm(),
    "paper": Arm("paper"),
    "printed": Arm(controller=Printed),
    **{name: _terms(*terms) for name, terms in TERMS.items() if terms != TERMS[BASE_TERMS]},
    NOT_EXACT: _navigator(planner={"exact": False}),
    "Eq. 9: alpha = 0": _weights(heading=0.0),
    "Eq. 9: beta = 0": _weights(dist=0.0),
    "Eq. 9: gamma = 0": _weights(vel=0.0),
    "Eq. 9: weights as printed": _weights(heading=0.5, dist=0.2, vel=0.2, simi=0.1),
    "no risk": _weights(risk=0.0),
    "no nearness": _weights(nearness=0.0),
    "no hysteresis": _window(hysteresis=0.0),
    "window of one period": _window(reach=0.0),
    "3 x 6 samples": _window(v_samples=3, omega_samples=6),
    "10 x 22 samples": _window(v_samples=10, omega_samples=22),
    "horizon 2 s": _window(horizon=2.0),
    "horizon 6 s": _window(horizon=6.0),
    "comfort 0.1 m": _window(comfort=0.1),
    "comfort 0.5 m": _window(comfort=0.5),
    "plans without comfort": _navigator(comfort=0.0),
    "deviation that does not grow": _navigator(prediction={"spread": 0.0}),
    "bound without acceleration": _navigator(prediction={"acceleration": 0.0}),
    "no people from unseen space": _navigator(hidden_speed=0.0),
    "no reverse": _navigator(reverse=False),
    "period 0.05 s": _navigator(period=0.05),
    "period 0.2 s": _navigator(period=0.2),
    "path following alone": Arm(controller=Follower),
    "DWA alone": Arm(controller=Unplanned),
}

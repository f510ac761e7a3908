"""The arms of the ablation: what is left out or read differently, one thing at a time."""

from collections.abc import Mapping
from typing import Any, NamedTuple

from dynastar.planning import HeuristicConfig

ALL_TERMS = HeuristicConfig()
PLAIN = HeuristicConfig(exponential=False, parent=False, k=0.0, weight=1.0)

# Eq. 2 with one of its terms left out or read differently: planner and terms, on one kernel.
TERMS: dict[str, tuple[str, HeuristicConfig]] = {
    "Eq. 2: all terms": ("improved", ALL_TERMS),
    "Eq. 2: k = 0": ("improved", ALL_TERMS._replace(k=0.0)),
    "Eq. 2: beta as interior angle": ("improved", ALL_TERMS._replace(beta="interior")),
    "Eq. 2: Q as a line": ("improved", ALL_TERMS._replace(q="line")),
    "Eq. 2: P / Q around n": ("improved", ALL_TERMS._replace(q="ratio")),
    "Eq. 2: no h(p)": ("improved", ALL_TERMS._replace(parent=False)),
    "Eq. 2: no e^(P/Q)": ("improved", ALL_TERMS._replace(exponential=False)),
    "Eq. 2: none of them (octile A*)": ("weighted", PLAIN),
}


class Arm(NamedTuple):
    """How a mission is driven: a preset, what differs from it, or by path following alone."""

    preset: str = "default"
    navigator: Mapping[str, Any] = {}
    follows: bool = False


def _terms(planner: str, heuristic: HeuristicConfig) -> Arm:
    return Arm(navigator={"planner": {"planner": planner, "heuristic": heuristic._asdict()}})


def _window(**settings: Any) -> Arm:
    return Arm(navigator={"dwa": settings})


def _weights(**weights: float) -> Arm:
    return _window(weights=weights)


ARMS: dict[str, Arm] = {
    "default": Arm(),
    "paper": Arm("paper"),
    **{name: _terms(*terms) for name, terms in TERMS.items()},
    "Eq. 9: alpha = 0": _weights(heading=0.0),
    "Eq. 9: beta = 0": _weights(dist=0.0),
    "Eq. 9: gamma = 0": _weights(vel=0.0),
    "Eq. 9: sigma = 0": _weights(simi=0.0),
    "Eq. 9: weights as printed": _weights(heading=0.5, dist=0.2, vel=0.2, simi=0.1),
    "normalised over ranges": _window(normalisation="range"),
    "normalised over sums": _window(normalisation="sum"),
    "dist at the end": _window(dist="end"),
    "target by distance alone": Arm(navigator={"target": "distance"}),
    "no turning in place": _window(turn_in_place=3.15),
    "horizon 1.5 s": _window(horizon=1.5),
    "horizon 6 s": _window(horizon=6.0),
    "period 0.05 s": Arm(navigator={"period": 0.05}),
    "period 0.2 s": Arm(navigator={"period": 0.2}),
    "no replanning": Arm(navigator={"global_path": "once"}),
    # Eq. 8: the goal itself is the target, and there is no path to be like or as clear as.
    "DWA alone": Arm(
        navigator={
            "global_path": "straight",
            "target": "distance",
            "lookahead": 50.0,
            "dwa": {"weights": {"simi": 0.0}, "clearance_of_path": False},
        }
    ),
    "path following alone": Arm(follows=True),
}

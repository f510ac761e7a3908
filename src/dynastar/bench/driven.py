"""Driving one mission of a suite: realism, settings, controller, and the row that comes of it."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from dynastar.bench.bound import time_bound
from dynastar.bench.controllers import controller_named
from dynastar.bench.runner import Mission, Options
from dynastar.bench.settings import merged
from dynastar.episode import Episode
from dynastar.metrics import measure
from dynastar.simulation import Noise, Scenario, run

PERIOD = 0.05  # s between commands, and between scans
RANGE_NOISE = 0.01  # m, bound of a range's error

Score = Callable[[Episode], float | None]
Extra = Callable[[Episode], Mapping[str, Any]]


def realistic(scenario: Scenario, options: Options) -> Scenario:
    """The scenario with 20 Hz, range noise and a period of latency; without noise if ``ideal``."""
    if options.ideal:
        noise, latency = Noise(), 0.0
    else:
        noise, latency = scenario.noise._replace(range_bound=RANGE_NOISE), PERIOD
    return replace(
        scenario,
        noise=noise,
        latency=latency,
        navigator=merged({"period": PERIOD}, scenario.navigator),
    )


def fly(
    scenario: Scenario,
    options: Options,
    mission: Mission,
    repeat: int,
    *,
    score: Score | None = None,
    group: str = "",
    extra: Extra | None = None,
) -> dict[str, Any]:
    """Drives a scenario as the options ask and returns its row.

    ``score`` gives the suite's own score of an episode. ``group`` names the part of the suite whose
    totals are given apart (a difficulty, a recording). ``extra`` gives more keys of the row. The seed
    is the sum of the scenario's, the options' and the repeat.
    """
    scenario = replace(
        scenario,
        preset=options.preset,
        seed=scenario.seed + options.seed + repeat,
        navigator=merged(scenario.navigator, options.settings),
    )
    episode = run(scenario, navigator=controller_named(options.controller))
    row = row_of_episode(episode, scenario, score=score, group=group)
    return row if extra is None else row | dict(extra(episode))


def row_of_episode(
    episode: Episode, scenario: Scenario, *, score: Score | None = None, group: str = ""
) -> dict[str, Any]:
    """The metrics of an episode with its group, score, time bound and ticks."""
    row: dict[str, Any] = measure(episode)._asdict()
    bound = time_bound(scenario)
    arrived = row["outcome"] == "arrived"
    ticks = episode.command_ms[np.isfinite(episode.command_ms)]
    row |= {
        "group": group,
        "score": None if score is None else score(episode),
        "time_bound": bound,
        "time_ratio": row["time"] / bound if arrived and bound else None,
        "tick_ms_median": float(np.median(ticks)) if len(ticks) else None,
        "tick_ms_p99": float(np.percentile(ticks, 99)) if len(ticks) else None,
    }
    return row

"""Driving one mission of a suite: realism, settings, controller, and the row that comes of it."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any, cast

import numpy as np

from dynastar.bench.bound import time_bound
from dynastar.bench.controllers import controller_named
from dynastar.bench.missions import Mission, Options
from dynastar.bench.settings import merged
from dynastar.episode import Episode
from dynastar.metrics import measure
from dynastar.simulation import Noise, Scenario, run

PERIOD = 0.05  # s between commands, and between scans
RANGE_NOISE = 0.01  # m, bound of a range's error
SLOW = 0.95  # of the full speed; a robot that is slower is limited by something
UNHINDERED = ("following", "arrived", "idle")  # states that are no cause by themselves

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


def run_mission(
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
    scenario = asked(scenario, options, repeat)
    controller = controller_named(options.controller)
    episode = run(scenario, navigator=controller, trace=options.observe is not None)
    row = row_of_episode(episode, scenario, score=score, group=group)
    if extra is not None:
        row |= dict(extra(episode))
    if options.observe is not None:
        options.observe(mission, repeat, episode, row)
    return row


def asked(scenario: Scenario, options: Options, repeat: int) -> Scenario:
    """The scenario with the preset, seed, settings, attention and legs that the options ask for."""
    return replace(
        scenario,
        preset=cast(Any, options.preset or scenario.preset),
        seed=scenario.seed + options.seed + repeat,
        navigator=merged(scenario.navigator, options.settings),
        attention=options.attention or scenario.attention,
        legs=options.legs or scenario.legs,
    )


def row_of_episode(
    episode: Episode, scenario: Scenario, *, score: Score | None = None, group: str = ""
) -> dict[str, Any]:
    """The metrics of an episode with its group, score, time bound, ticks and what limited it."""
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
        "limited": limited(episode, scenario.robot.limits.v_max),
    }
    return row


def limited(episode: Episode, v_max: float) -> dict[str, float]:
    """Causes that limited the speed, with their seconds, the longest first.

    A cause is what the controller names (``Episode.limits``); where it names none, its state
    ("state: waiting"), or "other" while it follows the path at less than 95 % of ``v_max``.
    """
    times = episode.trajectory.times
    causes = np.array(episode.limits if len(episode.limits) == len(times) else [""] * len(times))
    seconds: dict[str, float] = {}
    for tick, duration in enumerate(np.diff(times)):
        cause, state = str(causes[tick]), str(episode.states[tick])
        if not cause and state not in UNHINDERED:
            cause = f"state: {state}"
        elif not cause and abs(episode.commands[tick, 0]) < SLOW * v_max:
            cause = "other"
        if cause:
            seconds[cause] = seconds.get(cause, 0.0) + float(duration)
    ordered = sorted(seconds.items(), key=lambda item: (-item[1], item[0]))
    return {cause: round(duration, 3) for cause, duration in ordered}

"""The score of the BARN challenge [BARNChallenge], for its static and its dynamic worlds."""

import math
from typing import Any, NamedTuple

import numpy as np

from dynastar.episode import Episode

ARRIVED_WITHIN = 1.0  # m of the goal, where a run of the challenge ends
STARTED_AFTER = 0.1  # m from the start, where its clock begins
TIME_LIMIT = 100.0  # s
FULL_SPEED = 2.0  # m/s, for which the optimal time is


class ChallengeRun(NamedTuple):
    """Result of the challenge: ``seconds`` on its clock, and whether the run succeeded."""

    success: bool
    seconds: float | None


def challenge_run(episode: Episode) -> ChallengeRun:
    """The run as the challenge times it, from the true positions at the ticks.

    The clock begins at the first tick 0.1 m or more from the start and ends at the first within 1 m
    of the goal. A success is one that also came to rest there without contact, in under 100 s.
    """
    times, places = episode.trajectory.times, episode.trajectory.poses[:, :2]
    away = np.flatnonzero(np.hypot(*(places - places[0]).T) >= STARTED_AFTER)
    near = np.flatnonzero(np.hypot(*(places - episode.goals[-1, :2]).T) <= ARRIVED_WITHIN + 1e-6)
    if len(away) == 0 or len(near) == 0:
        return ChallengeRun(False, None)
    seconds = float(times[near[0]] - times[away[0]])
    return ChallengeRun(episode.outcome == "arrived" and seconds < TIME_LIMIT, seconds)


def challenge_score(episode: Episode, optimal_time: float) -> float:
    """success * OT / clip(time, 2 OT, 8 OT): 0.5 at most."""
    success, seconds = challenge_run(episode)
    if not success or seconds is None or not math.isfinite(seconds):
        return 0.0
    return optimal_time / min(max(seconds, 2.0 * optimal_time), 8.0 * optimal_time)


def challenge_keys(episode: Episode, optimal_time: float) -> dict[str, Any]:
    """Keys of a row: the challenge's clock and its optimal time, s."""
    return {
        "challenge_time": challenge_run(episode).seconds,
        "optimal_time": optimal_time,
    }

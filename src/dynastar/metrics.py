"""Episode -> numbers: what a mission came to, in Table III's terms and some more."""

from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.episode import Episode
from dynastar.path import turning_points

Floats = npt.NDArray[np.float64]


class Metrics(NamedTuple):
    """The numbers of one mission; all finite, None for what does not apply.

    ``time`` (s) runs to the tick that first says "arrived", else to the last one. ``length`` (m),
    ``turning_points`` and ``smoothness`` are of the true driven path until rest. ``min_clearance``
    (m) is the smallest true gap between the footprint and anything. A contact ends a mission, so
    both contact counts are 0 or 1. ``replans`` are the plans after the first, ``recoveries`` the
    events of that kind. ``command_ms_mean`` and ``command_ms_max`` (ms) are wall time over all
    calls of ``command``: sensing, planning and the first calls, which may compile, included.
    ``smoothness`` is the total variation of the turning rate per metre, ``sum |omega_{i+1} - omega_i|
    / length`` in (rad/s)/m: 0 on a line or a single arc, small is smooth. ``mean_speed`` (m/s) is the
    length over the time until rest. ``goals_reached`` counts goals in order. Where walkers notice the
    robot late, ``bumps`` counts their touches of a robot that did not move towards them, and ``stops``
    how often one stopped for it.
    """

    outcome: str
    reason: str
    time: float | None
    length: float
    turning_points: int
    min_clearance: float | None
    contacts_moving: int
    contacts_resting: int
    replans: int
    recoveries: int
    command_ms_mean: float | None
    command_ms_max: float | None
    smoothness: float | None
    mean_speed: float | None
    goals_reached: int
    bumps: int
    stops: int


def measure(episode: Episode) -> Metrics:
    """The numbers of ``episode``; ``_asdict()`` has the fields of ``dynastar run --json``."""
    driven = episode.trajectory
    length = driven.length if len(driven.times) else 0.0
    duration = float(driven.times[-1] - driven.times[0]) if len(driven.times) else 0.0
    turning = float(np.abs(np.diff(driven.twists[:, 1])).sum())
    clearance = episode.clearance[np.isfinite(episode.clearance)]
    command_ms = episode.command_ms[np.isfinite(episode.command_ms)]
    return Metrics(
        outcome=episode.outcome,
        reason=episode.reason,
        time=mission_time(episode),
        length=length,
        turning_points=turning_points(driven.poses[:, :2]),
        min_clearance=float(clearance.min()) if len(clearance) else None,
        contacts_moving=int(episode.contact == "moving"),
        contacts_resting=int(episode.contact == "resting"),
        replans=max(len(episode.plans) - 1, 0),
        recoveries=sum(event.kind == "recovery" for event in episode.events),
        command_ms_mean=float(command_ms.mean()) if len(command_ms) else None,
        command_ms_max=float(command_ms.max()) if len(command_ms) else None,
        smoothness=turning / length if length > 0.0 else None,
        mean_speed=length / duration if duration > 0.0 else None,
        goals_reached=goals_reached(episode),
        bumps=sum(event.kind == "bump" for event in episode.events),
        stops=sum(event.kind == "stop" for event in episode.events),
    )


def mission_time(episode: Episode) -> float | None:
    """Seconds from the first tick to the one that first says "arrived", else to the last one."""
    times = episode.trajectory.times
    if len(times) == 0:
        return None
    said = np.flatnonzero(episode.states == "arrived")
    last = said[0] if episode.outcome == "arrived" and len(said) else len(times) - 1
    return float(times[last] - times[0])


def goals_reached(episode: Episode) -> int:
    """Number of goals, in order, within whose tolerance the robot's true position came."""
    goals = episode.goals[:, :2]
    if episode.outcome == "arrived":
        return len(goals)
    tick = 0
    for count, goal in enumerate(goals):
        gap = np.hypot(*(episode.trajectory.poses[tick:, :2] - goal).T)
        near = np.flatnonzero(gap <= episode.goal_tolerance)
        if len(near) == 0:
            return count
        tick += int(near[0])
    return len(goals)

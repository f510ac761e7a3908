"""Episode -> numbers: what a mission came to, in Table III's terms and some more."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar import smoothness
from dynastar.config import counted, shown, summary
from dynastar.episode import Episode
from dynastar.path import turning_points
from dynastar.table import write_csv

Floats = npt.NDArray[np.float64]

CLOSE, LESS_CLOSE = 0.2, 0.45  # m, gaps that a person may find too small
GAP_STEP = 0.05  # s, the longest time between two gaps to moving obstacles
JUMP_SPEED = 6.0  # m/s; a moving obstacle that is faster between two ticks has jumped
LEAST_JUMP = 0.3  # m


class Metrics(NamedTuple):
    """The numbers of one mission; all finite, None for what does not apply.

    ``time`` (s) runs to the tick that first says "arrived", else to the last one. ``length`` (m),
    ``turning_points`` and ``smoothness`` are of the true driven path until rest. ``min_clearance``
    (m) is the smallest true gap between the footprint and anything. A contact ends a mission, so
    both contact counts are 0 or 1. ``replans`` are the plans after the first, ``recoveries`` the
    events of that kind. ``command_ms_mean`` and ``command_ms_max`` (ms) are wall time over all
    calls of ``command``: sensing, planning and the first calls, which may compile, included.
    ``mean_speed`` (m/s) is the length over the time until rest. ``goals_reached`` counts goals in order.
    Where walkers notice the robot late, ``bumps`` counts their touches of a robot that did not move
    towards them, and ``stops`` how often one stopped for it.
    ``nearest`` (m) is the smallest gap between the footprint and a moving obstacle, 0 at contact, and
    ``within_0_2`` and ``within_0_45`` are the fractions of the time with such a gap under 0.2 m and 0.45
    m. ``smoothness`` ((rad/s)/m), ``jerk`` (m/s3), ``angular_acceleration`` (rad/s2), ``omega_changes``
    (1/m), ``circles`` and ``turning_angle`` (rad) are defined in ``dynastar.smoothness``.
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
    nearest: float | None
    within_0_2: float | None
    within_0_45: float | None
    jerk: float | None
    angular_acceleration: float | None
    omega_changes: float | None
    circles: int
    turning_angle: float

    def to_csv(self, path: str | Path) -> None:
        """Write the numbers to a CSV file: a line of names and one of values."""
        write_csv({name: [value] for name, value in self._asdict().items()}, path)

    def __repr__(self) -> str:
        gap, time = self.min_clearance, self.time
        return summary(
            self,
            f"{self.outcome} ({shown(self.reason)})",
            "" if time is None else f"{time:.1f} s",
            f"{self.length:.2f} m",
            counted(self.turning_points, "turning point"),
            "" if gap is None else f"clearance at least {gap:.2f} m",
            counted(self.contacts_moving + self.contacts_resting, "contact"),
            counted(self.replans, "replan"),
            counted(self.goals_reached, "goal")
            and f"{counted(self.goals_reached, 'goal')} reached",
        )


def measure(episode: Episode) -> Metrics:
    """The numbers of ``episode``; ``_asdict()`` has the fields of ``dynastar run --json``."""
    driven = episode.trajectory
    length = driven.length if len(driven.times) else 0.0
    duration = float(driven.times[-1] - driven.times[0]) if len(driven.times) else 0.0
    gaps = mover_gaps(episode)
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
        smoothness=smoothness.smoothness(driven),
        mean_speed=length / duration if duration > 0.0 else None,
        goals_reached=goals_reached(episode),
        bumps=sum(event.kind == "bump" for event in episode.events),
        stops=sum(event.kind == "stop" for event in episode.events),
        nearest=float(gaps.min()) if np.isfinite(gaps).any() else None,
        within_0_2=fraction_within(gaps, CLOSE),
        within_0_45=fraction_within(gaps, LESS_CLOSE),
        jerk=smoothness.jerk(driven),
        angular_acceleration=smoothness.angular_acceleration(driven),
        omega_changes=smoothness.omega_changes(driven),
        circles=smoothness.circles(driven),
        turning_angle=smoothness.turning_angle(driven),
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


def mover_gaps(episode: Episode) -> Floats:
    """Gap (n,) in m from the footprint to the nearest moving obstacle, at most 0.05 s apart.

    It is inf where there is none, and 0 in contact. Poses and positions are linear between the ticks,
    but for an obstacle that jumps (``jumped``), which is where it was at the nearer tick.
    """
    driven = episode.trajectory
    if len(driven.times) == 0:
        return np.empty(0)
    begin, end = driven.times[0], driven.times[-1]
    times = np.linspace(begin, end, int(np.ceil((end - begin) / GAP_STEP - 1e-9)) + 1)
    x, y = (np.interp(times, driven.times, driven.poses[:, axis]) for axis in (0, 1))
    theta = np.interp(times, driven.times, np.unwrap(driven.poses[:, 2]))
    cos, sin = np.cos(theta), np.sin(theta)
    nearest = np.full(len(times), np.inf)
    for places, radius in zip(episode.movers.swapaxes(0, 1), episode.mover_radii, strict=True):
        dx, dy = _between(driven.times, places, times).T - (x, y)
        ahead, left = cos * dx + sin * dy, cos * dy - sin * dx
        nearest = np.fmin(nearest, _footprint_gaps(episode, ahead, left) - radius)
    return np.maximum(nearest, 0.0)


def jumped(ticks: Floats, places: Floats) -> npt.NDArray[np.bool_]:
    """Whether a moving obstacle (n, 2), m, has jumped between each two ticks (n,), s, and not moved."""
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    return steps > np.maximum(JUMP_SPEED * np.diff(ticks), LEAST_JUMP)


def _between(ticks: Floats, places: Floats, times: Floats) -> Floats:
    """Where a moving obstacle (n, 2) is at ``times`` (k,) between ticks (n,); NaN while it is absent."""
    if len(ticks) < 2:
        return places[np.zeros(len(times), np.intp)]
    leg = np.clip(np.searchsorted(ticks, times, side="right") - 1, 0, len(ticks) - 2)
    span = ticks[leg + 1] - ticks[leg]
    part = np.divide(times - ticks[leg], span, out=np.ones(len(times)), where=span > 0.0)
    part = np.where(jumped(ticks, places)[leg], np.rint(part), part)[:, None]
    between = places[leg] + part * (places[leg + 1] - places[leg])
    return np.where(part == 0.0, places[leg], np.where(part == 1.0, places[leg + 1], between))


def fraction_within(gaps: Floats, distance: float) -> float | None:
    """Fraction of ``gaps`` (n,) under ``distance`` (m); None where no gap is finite."""
    return float(np.mean(gaps < distance)) if np.isfinite(gaps).any() else None


def _footprint_gaps(episode: Episode, ahead: Floats, left: Floats) -> Floats:
    """Metres (n,) from the footprint to points in the robot's frame; 0 inside the polygon."""
    if len(episode.footprint) == 0:
        return np.hypot(ahead, left) - episode.radius
    gaps, inside = np.full(len(ahead), np.inf), np.ones(len(ahead), bool)
    for (ax, ay), (bx, by) in zip(
        np.roll(episode.footprint, 1, axis=0), episode.footprint, strict=True
    ):
        ex, ey, px, py = bx - ax, by - ay, ahead - ax, left - ay
        along = np.clip((px * ex + py * ey) / (ex * ex + ey * ey), 0.0, 1.0)
        gaps = np.fmin(gaps, np.hypot(px - along * ex, py - along * ey))
        inside &= ex * py - ey * px >= 0.0
    return np.where(inside, 0.0, gaps)

"""What a mission's picture says, before any drawing: shapes and tracks in metres, and words."""

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from dynastar.episode import Episode, PlanRecord
from dynastar.grid import GridFrame
from dynastar.metrics import Metrics, jumped
from dynastar.path import Path
from dynastar.terminal import printable

Floats = npt.NDArray[np.float64]

MOST_POINTS = 1000  # that a line is looked at in


def explored_frame(episode: Episode) -> GridFrame:
    """Where the explored cells of the plans lie."""
    return GridFrame(*episode.explored_frame)


def outline(episode: Episode, pose: Floats) -> Floats:
    """The footprint's outline (k, 2) in metres at ``pose`` (x, y, theta); a disc as a 32-gon."""
    corners = episode.footprint
    if len(corners) == 0:
        angles = np.linspace(0.0, 2.0 * np.pi, 32, endpoint=False)
        corners = episode.radius * np.column_stack([np.cos(angles), np.sin(angles)])
    cos, sin = math.cos(pose[2]), math.sin(pose[2])
    turn = np.array([[cos, sin], [-sin, cos]])
    return np.asarray(corners @ turn + pose[:2], dtype=np.float64)


def nose(episode: Episode, pose: Floats) -> Floats:
    """The line (2, 2) from the footprint's centre to its front at ``pose``, metres."""
    reach = episode.footprint[:, 0].max() if len(episode.footprint) else episode.radius
    front = reach * np.array([math.cos(pose[2]), math.sin(pose[2])])
    return np.array([pose[:2], pose[:2] + front])


def setting_out(points: Floats, reach: float) -> Floats:
    """The unit vector (2,) from the start of a line (n, 2) to its point ``reach`` metres on."""
    line = Path(points)
    step = np.array(line.at(reach)) - line.points[0]
    length = float(np.hypot(*step))
    return step / length if length > 1e-6 else np.array([-math.sqrt(0.5), -math.sqrt(0.5)])


def marks(episode: Episode) -> list[tuple[Floats, Floats, str]]:
    """Start and goals: where, the way (2,) to where the letters hide least, and the letters."""
    goals, line = episode.goals[:, :2], episode.trajectory.poses[:, :2]
    aside = np.full(2, math.sqrt(0.5))
    names = ["G"] if len(goals) == 1 else [f"G{number}" for number in range(1, len(goals) + 1)]
    result = [(goal, aside, name) for goal, name in zip(goals, names, strict=True)]
    if len(line) == 0:
        return result
    reach = max(2.0, 4.0 * episode.radius)
    if result and episode.outcome == "arrived":
        result[-1] = (goals[-1], -setting_out(line[::-1], reach), names[-1])
    return [(line[0], -setting_out(line, reach), "S"), *result]


def changes(plans: Sequence[Floats], tolerance: float) -> list[list[Floats]]:
    """Of each plan (n, 2) the stretches farther than ``tolerance`` metres from all plans before.

    A stretch is (k >= 2, 2), with the points beside it that connect it to the line it leaves.
    """
    drawn = np.empty((0, 2))
    result: list[list[Floats]] = []
    for points in plans:
        if len(points) == 0:
            result.append([])
            continue
        line = Path(points)
        samples = line.resampled(0.0, line.length, max(0.5 * tolerance, line.length / MOST_POINTS))
        new = np.array([_is_apart(sample, drawn, tolerance) for sample in samples])
        new[1:-1] |= new[2:] | new[:-2]
        ends = np.flatnonzero(new[1:] != new[:-1]) + 1
        pieces = zip(np.split(samples, ends), np.split(new, ends), strict=True)
        kept = [piece for piece, is_new in pieces if is_new[0] and len(piece) > 4]
        result.append(kept)
        drawn = np.concatenate([drawn, *kept])
    return result


def _is_apart(point: Floats, others: Floats, tolerance: float) -> bool:
    return len(others) == 0 or float(np.hypot(*(others - point).T).min()) > tolerance


def plan_labels(plans: Sequence[PlanRecord], apart: float) -> list[tuple[Floats, Floats, str]]:
    """Where plans begin, which way they set out, and their numbers.

    Those begun within ``apart`` metres share a label.
    """
    groups: list[tuple[Floats, Floats, list[int]]] = []
    for number, plan in enumerate(plans):
        if len(plan.points) == 0:
            continue
        begin = plan.points[0]
        near = (group for group in groups if np.hypot(*(group[0] - begin)) < apart)
        group = next(near, None)
        if group is None:
            groups.append((begin, setting_out(plan.points, 2.0 * apart), [number]))
        else:
            group[2].append(number)
    return [(place, way, number_words(numbers)) for place, way, numbers in groups]


def number_words(numbers: Sequence[int]) -> str:
    """Rising numbers in words: "2", "2, 5", "2, 3", "2-4, 6"."""
    runs: list[list[int]] = []
    for number in numbers:
        if runs and number == runs[-1][-1] + 1:
            runs[-1].append(number)
        else:
            runs.append([number])
    words = [f"{run[0]}–{run[-1]}" if len(run) > 2 else ", ".join(map(str, run)) for run in runs]
    return ", ".join(words)


def track_dots(track: Floats, ticks: Floats, spacing: float) -> Floats:
    """Points (k, 2) about every ``spacing`` metres along a mover's track (n, 2), none twice.

    A walk to and fro leaves one row of dots; gaps (not finite) and jumps are not bridged.
    """
    dots: list[Floats] = []
    for leg in _legs(track, ticks):
        line = Path(leg)
        for point in line.resampled(0.0, line.length, max(spacing, line.length / MOST_POINTS)):
            if not dots or np.hypot(*(np.array(dots) - point).T).min() > 0.75 * spacing:
                dots.append(point)
    return np.array(dots).reshape(-1, 2)


def _legs(track: Floats, ticks: Floats) -> list[Floats]:
    there = np.isfinite(track.sum(axis=1))
    walked = there[:-1] & there[1:] & ~jumped(ticks, track)
    broken = np.flatnonzero(~walked)
    legs = np.split(track, broken + 1)
    return [leg for leg in legs if np.isfinite(leg).all() and len(leg)]


def closest_tick(track: Floats, positions: Floats) -> int | None:
    """The tick at which a mover (n, 2) was nearest to the robot (n, 2); None if never there."""
    gap = np.hypot(*(track - positions).T)
    return int(np.nanargmin(gap)) if np.isfinite(gap).any() else None


def name_of(episode: Episode) -> str:
    """The mission's name, else the robot's."""
    return printable(str(episode.scenario.get("name") or episode.robot))


def outcome_words(metrics: Metrics) -> str:
    """Describe how the mission ended."""
    after = f" after {metrics.time:.1f} s" if metrics.time is not None else ""
    moving = "while moving" if metrics.contacts_moving else "while standing still"
    words = {
        "arrived": f"arrived{after}",
        "blocked": f"blocked{after}",
        "timeout": f"out of time{after}",
        "sensor_lost": f"lost its sensor{after}",
        "contact": f"contact {moving}{after}",
    }
    return words.get(metrics.outcome, f"{metrics.outcome}{after}")


def count_words(count: int, noun: str, plural: str = "") -> str:
    """A number of things: "no replans", "1 replan", "2 replans"."""
    return f"{count or 'no'} {noun if count == 1 else plural or noun + 's'}"

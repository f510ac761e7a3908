"""Checks the prediction of moving people against recorded ones, for docs/prediction.md.

python benchmarks/prediction.py --data DIR [--out docs/media/prediction.png]

Pedestrians with an even number are for fitting, those with an odd one for checking. A sample is a
person who walks at ``LEAST_SPEED`` or faster, every 0.4 s: where they are ``ahead`` seconds later is
compared with the straight line on from there, at the mean velocity of the last 0.5 s.
"""

import argparse
import math
from pathlib import Path
from typing import NamedTuple

import numpy as np
import numpy.typing as npt
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from dynastar.io.pedestrians import load_recording
from dynastar.perception.prediction import WEIGHTS, PredictionConfig, Times, predict
from dynastar.perception.tracking import MovingObstacle
from dynastar.perception.tracking_kernels import REST_SPEED

Floats = npt.NDArray[np.float64]

RECORDINGS = "eth", "zara01", "students003"
AHEAD = 0.5, 1.0, 1.5, 2.0, 3.0, 4.0  # s
SPAN, EVERY = 0.5, 0.4  # s
LEAST_SPEED = 0.4  # m/s
SPEEDS = (0.0, REST_SPEED), (REST_SPEED, LEAST_SPEED), (LEAST_SPEED, math.inf)  # m/s
STOPPED = 0.3  # of the way that a person who goes on covers
NEAR = 0.55  # m between the centres of a robot of 0.3 m and a person of 0.25 m that touch
EDGES = np.array([0.0, 0.01, 0.03, 0.1, 0.2, 0.35, 0.5, 0.65, 0.8, 0.9, 1.0])
PLACES = 20  # of a robot round where a person is expected, for each sample
WITHIN = 2.0  # m of that


class Samples(NamedTuple):
    """Positions, velocities and later positions (n, 2), metres and m/s."""

    place: Floats
    velocity: Floats
    later: Floats


def samples(
    tracks: list[Floats], ahead: float, speeds: tuple[float, float] = (LEAST_SPEED, math.inf)
) -> Samples:
    """The samples of all tracks (k, 3) of t, x, y, of people whose speed is in a range (m/s)."""
    found = []
    for t, x, y in (track.T for track in tracks):
        at = np.arange(t[0] + SPAN, t[-1] - ahead, EVERY)
        now, before, later = (
            np.column_stack([np.interp(at + shift, t, x), np.interp(at + shift, t, y)])
            for shift in (0.0, -SPAN, ahead)
        )
        velocity = (now - before) / SPAN
        speed = np.hypot(*velocity.T)
        wanted = (speeds[0] <= speed) & (speed < speeds[1])
        found.append(np.hstack([now, velocity, later])[wanted])
    return Samples(*np.split(np.vstack(found), 3, axis=1))


def off(seen: Samples, ahead: float) -> tuple[Floats, Floats, Floats]:
    """How far along and across (m) people are off the straight line, and the share of it covered."""
    speed = np.hypot(*seen.velocity.T)
    along, across = (
        seen.velocity / speed[:, None],
        seen.velocity[:, ::-1] * (-1, 1) / speed[:, None],
    )
    moved = seen.later - seen.place
    covered = (moved * along).sum(axis=1)
    return covered - speed * ahead, (moved * across).sum(axis=1), covered / (speed * ahead)


def by_speed(tracks: list[Floats]) -> str:
    """A table: how far people of each range of speeds are off the straight line."""
    lines = [
        "| speed, m/s | s ahead | people | 50 %, m | 68 % | 90 % |",
        "|--:|--:|--:|--:|--:|--:|",
    ]
    for speeds in SPEEDS:
        for ahead in (0.5, 1.0, 2.0):
            seen = samples(tracks, ahead, speeds)
            away = np.hypot(*(seen.later - seen.place - ahead * seen.velocity).T)
            shares = " | ".join(f"{np.quantile(away, q):.2f}" for q in (0.5, 0.68, 0.9))
            words = f"{speeds[0]:g} to {speeds[1]:g}"
            lines.append(f"| {words} | {ahead:g} | {len(away)} | {shares} |")
    return "\n".join(lines)


def model(ahead: float) -> tuple[Floats, float, Floats]:
    """Of the prediction: the hypotheses' travel (s) at a time, the deviation (m), and the weights."""
    walks = MovingObstacle(0.0, 0.0, LEAST_SPEED, 0.0, 0.25)
    one = predict([walks], PredictionConfig(), Times(0.0, ahead, 1))
    return one.travel[:, 0], float(one.deviation[0, 0]), WEIGHTS


def fitted(seen: Samples, ahead: float) -> tuple[Floats, float]:
    """The weights of the hypotheses and the deviation (m) that are most likely."""
    travel, deviation, weights = model(ahead)
    square = np.stack(
        [((seen.place + way * seen.velocity - seen.later) ** 2).sum(axis=1) for way in travel]
    )
    for _ in range(500):
        share = weights[:, None] * np.exp(-0.5 * square / deviation**2) + 1e-300
        share /= share.sum(axis=0)
        weights, deviation = (
            share.mean(axis=1),
            math.sqrt((share * square).sum() / len(share.T) / 2),
        )
    return weights, deviation


def reliability(seen: Samples, ahead: float, random: np.random.Generator) -> Floats:
    """Predicted probability of contact, and 1 where there was contact, of robots round people (n, 2)."""
    travel, deviation, weights = model(ahead)
    n = len(seen.place)
    radius, angle = (
        WITHIN * np.sqrt(random.random((PLACES, n))),
        2 * math.pi * random.random((PLACES, n)),
    )
    robot = (
        seen.place
        + ahead * seen.velocity
        + radius[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    )
    total = np.zeros((PLACES, n))
    for way, weight in zip(travel, weights, strict=True):
        gap = np.hypot(*np.moveaxis(robot - seen.place - way * seen.velocity, -1, 0)) - NEAR
        total += weight / (1.0 + np.exp(1.702 * gap / deviation))
    touched = np.hypot(*np.moveaxis(robot - seen.later, -1, 0)) < NEAR
    return np.column_stack([total.ravel(), touched.ravel()])


def draw(
    axes: list[Axes], table: dict[str, list[list[float]]], curves: dict[float, Floats]
) -> None:
    """Deviations over time, shares that stop or turn back, and the reliability curve."""
    times = np.linspace(0.05, 4.0, 80)
    axes[0].plot(times, [model(t)[1] for t in times], "k", label="used")
    for name, rows in table.items():
        rows_ = np.array(rows)
        axes[0].plot(rows_[:, 0], rows_[:, 1], "--", label=f"{name}, along")
        axes[0].plot(rows_[:, 0], rows_[:, 2], label=f"{name}, across")
        axes[1].plot(rows_[:, 0], 100 * rows_[:, 3], label=f"{name}, stopped")
        axes[1].plot(rows_[:, 0], 100 * rows_[:, 4], "--", label=f"{name}, turned back")
    axes[0].set(xlabel="time ahead, s", ylabel="off the straight line, m (68 %)", ylim=(0, 1))
    axes[1].set(xlabel="time ahead, s", ylabel="share of people, %")
    axes[2].plot([0, 1], [0, 1], "k:", label="perfect")
    for ahead, pairs in curves.items():
        index = np.digitize(pairs[:, 0], EDGES[1:-1])
        points = [
            pairs[index == i].mean(axis=0) for i in range(len(EDGES) - 1) if (index == i).any()
        ]
        axes[2].plot(*np.array(points).T, "o-", ms=3, label=f"{ahead:g} s ahead")
    axes[2].set(xlabel="predicted probability of contact", ylabel="share that touched")
    for one in axes:
        one.legend(fontsize=7)


def main() -> None:
    """Prints the tables and draws the picture."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--data", type=Path, required=True)
    parser.add_argument("--out", type=Path, default=Path("docs/media/prediction.png"))
    given = parser.parse_args()
    random = np.random.default_rng(0)
    table: dict[str, list[list[float]]] = {}
    halves: dict[int, list[Floats]] = {0: [], 1: []}
    for name in RECORDINGS:
        tracks = load_recording(given.data / "pedestrians" / f"{name}.csv").tracks
        for half in (0, 1):
            halves[half] += tracks[half::2]
        for ahead in AHEAD:
            along, across, covered = off(samples(list(tracks), ahead), ahead)
            wide = [float(np.quantile(abs(part), 0.68)) for part in (along, across)]
            shares = float((covered < STOPPED).mean()), float((covered < 0.0).mean())
            table.setdefault(name, []).append([ahead, *wide, *shares])
    print(
        "| s ahead | samples | continues, stops, turns back (fitted) | deviation, m (fitted) | used, m |"
    )
    print("|--:|--:|:--|--:|--:|")
    for ahead in AHEAD:
        for half, word in ((0, "fit"), (1, "check")):
            seen = samples(halves[half], ahead)
            weights, deviation = fitted(seen, ahead)
            shares = ", ".join(f"{weight:.3f}" for weight in weights)
            numbers = f"{len(seen.place)} | {shares} | {deviation:.2f} | {model(ahead)[1]:.2f}"
            print(f"| {ahead:g} ({word}) | {numbers} |")
    print(by_speed(halves[0] + halves[1]))
    curves = {a: reliability(samples(halves[1], a), a, random) for a in (0.5, 1.0, 2.0, 4.0)}
    figure = Figure(figsize=(12, 3.6), layout="constrained")
    draw(list(figure.subplots(1, 3)), table, curves)
    figure.savefig(given.out, dpi=110)


if __name__ == "__main__":
    main()

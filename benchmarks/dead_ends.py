"""Missions of `random` in which the robot never got away: what it could have reached by what it saw.

Reads a result of `dynastar bench random`, and drives again the missions that were reported blocked though
a way leads to the goal, and in which the robot got no farther than a metre. Said for each is how far from
its start a disc of the footprint's inscribed radius, less a cell, could get through cells that the lidar
had seen free (and never seen hit since) when the mission ended; and how far, if unseen cells were free.
No motion leads a robot farther through what it has seen than such a disc.

    dynastar bench random --missions 1000 --seed 10008 --json-out random.json
    python benchmarks/dead_ends.py random.json --picture dead_ends.png
"""

import argparse
import json
import os
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
import numpy.typing as npt
from matplotlib.patches import Polygon
from scipy import ndimage

from dynastar.bench.driven import asked
from dynastar.bench.keeping import mission_numbered
from dynastar.bench.missions import Options
from dynastar.bench.suites import load_suite
from dynastar.bench.workers import completed
from dynastar.geometry import Pose2D
from dynastar.navigator import Navigator
from dynastar.perception.local_map import SEEN_OCCUPIED
from dynastar.perception.local_map_kernels import NEVER
from dynastar.simulation import drive, warm_up
from dynastar.simulation.contact import placed_footprint

Mask = npt.NDArray[np.bool_]
STAYED = 1.0  # m
ROW = 7  # panels


class Found(NamedTuple):
    """What a robot that stayed had seen: cells of the local map, and how far it could have got, m."""

    robot: str
    seen: float
    unseen_too: float
    free: Mask
    occupied: Mask
    extent: tuple[float, float, float, float]
    outline: npt.NDArray[np.float64]


def main() -> None:
    """Prints a line for each mission, and draws them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("result", type=Path)
    parser.add_argument("--picture", type=Path, metavar="FILE")
    asked = parser.parse_args()
    result = json.loads(asked.result.read_text(encoding="utf-8"))
    wrong = [row for row in result["rows"] if row["outcome"] not in ("arrived", "blocked_rightly")]
    stayed = [row["number"] for row in wrong if row["length"] < STAYED and row["reachable"]]
    options = Options(seed=result["seed"])
    warm_up()
    jobs = dict(completed(partial(seen_in, options=options), stayed, os.cpu_count() or 1))
    found = {stayed[at]: jobs[at] for at in sorted(jobs)}
    print(f"{len(result['rows'])} missions, {len(wrong)} not right, {len(stayed)} never got away")
    print(f"{'mission':>8} {'robot':20} {'by what was seen, m':>20} {'unseen as free, m':>18}")
    for number, of in found.items():
        print(f"{number:8} {of.robot:20} {of.seen:20.2f} {of.unseen_too:18.2f}")
    if asked.picture:
        draw(found, asked.picture)


def seen_in(number: int, options: Options) -> Found:
    """What the robot of a mission had seen at its end."""
    suite = load_suite("random")
    made: list[Navigator] = []

    def make(*of: Any) -> Navigator:
        made.append(Navigator(*of))
        return made[-1]

    scenario = suite.scenario(mission_numbered("random", suite, options, number), options, 0)
    episode = drive(asked(scenario, options, 0), navigator=make)
    assert episode.outcome == "blocked", "not the mission of the result"
    local = made[-1].sensing.local_map
    occupied = local.states == SEEN_OCCUPIED
    free = (local.free_at > NEVER) & ~occupied
    (x0, y0), step = local.origin, local.resolution
    start, end = episode.trajectory.poses[0], episode.trajectory.poses[-1]
    cell = int((start[1] - y0) / step), int((start[0] - x0) / step)
    radius = scenario.robot.footprint.inscribed - step
    side = len(free) * step
    return Found(
        scenario.robot.name,
        farthest(free, cell, radius / step) * step,
        farthest(~occupied, cell, radius / step) * step,
        free,
        occupied,
        (x0 - start[0], x0 + side - start[0], y0 - start[1], y0 + side - start[1]),
        np.asarray(placed_footprint(Pose2D(*end), scenario.robot.footprint).exterior.coords)
        - start[:2],
    )


def farthest(free: Mask, start: tuple[int, int], radius: float) -> float:
    """How far from a cell a disc gets that never covers the centre of a cell that is not free; cells."""
    room = ndimage.distance_transform_edt(np.pad(free, 1))[1:-1, 1:-1] > radius
    room[start] = True  # where the robot stands
    labels, _ = ndimage.label(room, np.ones((3, 3)))
    rows, columns = np.nonzero(labels == labels[start])
    return float(np.hypot(rows - start[0], columns - start[1]).max())


def draw(found: dict[int, Found], file: Path) -> None:
    """The cells round each robot: seen free, seen occupied, unseen."""
    rows = -(-len(found) // ROW)
    figure, axes = plt.subplots(rows, ROW, figsize=(1.5 * ROW, 1.7 * rows), squeeze=False)
    for panel in axes.flat:
        panel.set_axis_off()
    for panel, (number, of) in zip(axes.flat, found.items(), strict=False):
        shade = np.full(of.free.shape, 0.75)
        shade[of.free], shade[of.occupied] = 1.0, 0.0
        panel.imshow(shade, cmap="gray", vmin=0, vmax=1, origin="lower", extent=of.extent)
        panel.add_patch(Polygon(of.outline, facecolor="tab:blue", alpha=0.6))
        panel.set(xlim=(-1.2, 1.2), ylim=(-1.2, 1.2))
        panel.set_title(f"{number}", fontsize=8)
    figure.tight_layout()
    figure.savefig(file, dpi=110)


if __name__ == "__main__":
    main()

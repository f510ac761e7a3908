"""Tracks of moving obstacles in worlds in which nothing moves: how many, and for how long.

    python benchmarks/ghosts.py --data DIR --missions 20

A track counts from the first to the last tick at which it is confirmed, that is, the robot avoids it.
"""

import argparse
import os
from functools import partial
from pathlib import Path
from typing import Any

from dynastar.bench.missions import Options
from dynastar.bench.selection import choose_missions
from dynastar.bench.suites import load_suite
from dynastar.bench.workers import completed
from dynastar.geometry import Twist
from dynastar.navigator import Navigator
from dynastar.simulation import drive, warm_up

SUITES = ("random", "bounds", "barn")
LONG = 1.0  # s


class Watched(Navigator):
    """A navigator that notes when it first and last confirmed each track."""

    spans: dict[int, tuple[float, float]]

    def command(self, state: Any, *given: Any, **named: Any) -> Twist:
        """The command, with the tracks noted."""
        command = super().command(state, *given, **named)
        self.spans = getattr(self, "spans", {})
        for track in self.status.tracks:
            if track.state == "confirmed":
                first, _ = self.spans.get(track.id, (state.stamp, state.stamp))
                self.spans[track.id] = first, state.stamp
        return command


def ghosts(job: tuple[str, Any], options: Options) -> tuple[float, list[float]]:
    """How long a mission took (s), and for how long each track was confirmed in it."""
    name, mission = job
    driven: list[Watched] = []

    def make(*of: Any) -> Watched:
        driven.append(Watched(*of))
        return driven[-1]

    episode = drive(load_suite(name).scenario(mission, options, 0), navigator=make)
    spans = [last - first for navigator in driven for first, last in navigator.spans.values()]
    return float(episode.trajectory.times[-1]), spans


def main() -> None:
    """Prints a line for each suite."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--data", type=Path, required=True, metavar="DIR")
    parser.add_argument("--missions", type=int, default=20, metavar="N", help="of each suite")
    parser.add_argument("--seed", type=int, default=0)
    asked = parser.parse_args()
    options = Options(data=asked.data, missions=asked.missions, seed=asked.seed)
    warm_up()
    jobs = [(name, of) for name in SUITES for of in choose_missions(load_suite(name), options)[0]]
    found = dict(completed(partial(ghosts, options=options), jobs, os.cpu_count() or 1))
    print(
        f"{'suite':14}{'missions':>10}{'minutes':>10}{'tracks':>10}{'over 1 s':>10}{'longest, s':>12}"
    )
    for name in SUITES:
        of = [found[at] for at, job in enumerate(jobs) if job[0] == name]
        spans = [span for _, spans in of for span in spans]
        minutes, over = sum(time for time, _ in of) / 60.0, sum(span > LONG for span in spans)
        counts = (
            f"{len(of):10}{minutes:10.1f}{len(spans):10}{over:10}{max(spans, default=0.0):12.1f}"
        )
        print(name.ljust(14) + counts)


if __name__ == "__main__":
    main()

"""What a robot feels: the time of ``Navigator.command``, tick by tick.

A hall of 24 x 12 m with pillars and three boxes nobody mapped, five walkers that go to and fro, a lidar of
720 beams, a local map of 10 x 10 m at 5 cm, the samples of the default preset. The robot drives from
end to end and back. A tick counts if the tracker has all five walkers and the window was searched;
ticks with a new plan are shown apart, and how many candidates a tick has in the median. The medians
are shown over the calibration kernel's time, too, which tells machines apart.
"""

import math
import time
from typing import Any, NamedTuple

import numpy as np
from calibration import calibrate

from dynastar import Goal, Navigator, OccupancyGrid, Robot, Scenario
from dynastar.geometry import Twist
from dynastar.robot import ROBOTS, Lidar
from dynastar.simulation import Mover, run
from dynastar.simulation.warming import warm_up

WALKERS = 5
SQUARE = np.array([(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)])


class Tick(NamedTuple):
    """One command: what it took and what it had to do."""

    ms: float
    movers: int
    replanned: bool
    judged: int


def scenario(robot: str) -> Scenario:
    """The hall, for a robot whose lidar is replaced by one of 720 beams all round, 12 m."""
    a = 0.05
    occupied = np.zeros((round(12 / a), round(24 / a)), bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    for x in range(3, 24, 3):
        for y in (3.0, 9.0):
            row, column = round(y / a), round(x / a)
            occupied[row - 4 : row + 4, column - 4 : column + 4] = True
    boxes = [(7.0, 5.0), (13.0, 6.6), (18.0, 5.2)]
    walkers = []
    for i in range(WALKERS):
        lane = 1.4 if i % 2 else 10.6
        ends = np.array([(2.0 + 2.0 * i, lane), (12.0 + 2.0 * i, lane)])
        walkers.append(Mover(0.25, np.array([0.0, 12.0 + i]), ends))
    there, back = Goal(22.0, 6.0), Goal(2.0, 6.0)
    base = ROBOTS[robot]
    return Scenario(
        f"tick, {robot}",
        OccupancyGrid.from_occupied(occupied, a),
        Robot(base.name, base.limits, base.footprint, Lidar(720, math.tau, 0.05, 12.0)),
        (2.0, 6.0, 0.0),
        (there, back, there, back),
        obstacles=tuple(
            np.array([(x, y), (x + 0.6, y), (x + 0.6, y + 0.6), (x, y + 0.6)]) for x, y in boxes
        ),
        movers=tuple(walkers),
        goal_tolerance=0.3,
        time_limit=400.0,
    )


class Timed(Navigator):
    """The navigator, with a clock at its door."""

    ticks: list[Tick]

    def command(self, state: Any, scan: Any, movers: Any = None) -> Twist:
        """As the navigator's, timed."""
        plan = self.status.plan_id
        began = time.perf_counter()
        twist = super().command(state, scan, movers)
        ms = 1e3 * (time.perf_counter() - began)
        choice = self.status.choice
        judged = 0 if choice is None else len(choice.samples)
        self.ticks.append(Tick(ms, len(self.status.tracks), self.status.plan_id != plan, judged))
        return twist


def measure(robot: str) -> list[Tick]:
    """Drives the mission twice and returns the ticks of the second."""
    warm_up()
    ticks: list[Tick] = []
    for _ in range(2):
        ticks = []

        def timed(*arguments: Any, ticks: list[Tick] = ticks) -> Timed:
            navigator = Timed(*arguments)
            navigator.ticks = ticks
            return navigator

        episode = run(scenario(robot), navigator=timed)
        assert episode.outcome == "arrived", episode.reason
    return ticks


def main() -> None:
    """Prints a table."""
    unit = calibrate()
    print(f"calibration kernel {unit:.2f} ms")
    print(
        f"{'robot':10}{'ticks':>7}{'candidates':>12}{'median':>9}{'/ kernel':>9}{'p99':>8}{'worst':>8}"
        "   replanning: median, worst"
    )
    for robot in ("jackal", "paper"):
        ticks = measure(robot)
        whole = [t for t in ticks if t.movers >= WALKERS and t.judged > 0]
        plain = np.array([t.ms for t in whole if not t.replanned])
        again = np.array([t.ms for t in ticks if t.replanned])
        candidates = np.median([t.judged for t in whole])
        print(
            f"{robot:10}{len(plain):7}{candidates:12.0f}{np.median(plain):9.2f}"
            f"{np.median(plain) / unit:9.2f}{np.quantile(plain, 0.99):8.2f}{plain.max():8.2f}"
            f"   {len(again)}: {np.median(again):.2f}, {again.max():.2f} ms"
        )


if __name__ == "__main__":
    main()

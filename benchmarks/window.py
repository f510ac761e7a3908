"""The dynamic window on a scan, beside other local controllers: ``python benchmarks/window.py``.

One scan of 360 beams in a room of 8 x 6 m with pillars, one robot (Pioneer 3-DX, 0.3 m/s), one straight
path, 20 x 20 speeds (or the nearest that a controller can be told), 3 s ahead, one thread. Timed
is from the ranges to the command, warm and in turns. Samples are counted, and how many are left after
collision checks. What is known and what is judged differs:

- dynastar: all of ``Navigator.command``: local map of 10 x 10 m at 5 cm (hits, what beams passed, what
  was never seen), tracker, distance fields, cost-to-go; a sample needs a certified stop, is rolled out
  to the horizon, and is scored. Its steps are 0.1 s while it is held, then 0.2 s.
- kompass-core: an octree of the scan's ends at 5 cm, collision check of the robot's cylinder with it at
  every step, distances to path, goal and obstacles for what is left; with the path's points as far apart
  as dynastar's, and 1 cm apart, which is its default.
- dynamic-window-approach: every step against every end of a beam, a rectangle and a distance; nothing
  else is known, and there is no path. Its upper turning rate is always the limit's.
- python-motion-planning: takes a grid; the ends are marked in one of 10 x 10 m at 5 cm, its own distance
  field is made of that, and the window is one period's.

Peers that are not installed are left out.
"""

import importlib.util
import math
from contextlib import ExitStack

import cv2
import numpy as np
from calibration import calibrate
from window_peers import (
    COUNT,
    GOAL,
    PERIOD,
    POSE,
    ROBOT,
    SPACING,
    STEPS,
    TWIST,
    Contender,
    brute_force,
    in_python,
    kompass,
    timed,
)

from dynastar import LaserScan, Navigator, NavigatorConfig, OccupancyGrid, RobotState
from dynastar.dwa import DwaConfig
from dynastar.robot import Lidar
from dynastar.simulation.lidar import LidarSimulator
from dynastar.simulation.warming import warm_up

BEAMS, ROUNDS = 360, 40


def room() -> OccupancyGrid:
    """8 x 6 m with walls, and six pillars of 0.4 m beside the robot's way."""
    occupied = np.zeros((120, 160), bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    for x, y in ((1.5, 1.5), (3.2, 1.9), (3.3, 4.1), (4.6, 1.6), (4.9, 4.3), (6.2, 2.0)):
        row, column = round(y / 0.05), round(x / 0.05)
        occupied[row - 4 : row + 4, column - 4 : column + 4] = True
    return OccupancyGrid.from_occupied(occupied, 0.05)


def ours(grid: OccupancyGrid, scan: LaserScan) -> Contender:
    """dynastar: all of the navigator's tick."""
    dwa = DwaConfig(v_samples=COUNT, omega_samples=COUNT, horizon=STEPS * PERIOD)
    navigator = Navigator(grid, ROBOT, NavigatorConfig(period=PERIOD, dwa=dwa, stuck_time=120.0))
    navigator.set_goal(GOAL)
    now = 0.0

    def command() -> None:
        nonlocal now
        now += PERIOD
        rest = (scan.angle_min, scan.angle_increment, scan.range_min, scan.range_max)
        taken = LaserScan(now, scan.ranges, *rest)
        navigator.command(RobotState(now, POSE, TWIST), taken)
        assert navigator.status.state == "following", navigator.status

    command()
    choice = navigator.status.choice
    assert choice is not None
    samples = len(choice.samples), int((choice.refused == 0).sum())
    return Contender(timed(command), *samples, len(navigator.driving.window.rules.schedule.step))


def measure(contenders: dict[str, Contender]) -> dict[str, list[float]]:
    """Milliseconds by contender, in turns; who takes long is asked less often."""
    took: dict[str, list[float]] = {name: [] for name in contenders}
    for turn in range(ROUNDS):
        for name, contender in contenders.items():
            if turn < 5 or sum(took[name]) < 4000.0:
                contender.seconds()  # finds the caches again
                took[name].append(1e3 * contender.seconds())
    return took


def main() -> None:
    """Prints the table."""
    cv2.setNumThreads(1)
    warm_up()
    grid = room()
    scan = LidarSimulator(Lidar(BEAMS, math.tau, 0.05, 10.0), grid).scan(POSE, 0.0)
    contenders = {"dynastar": ours(grid, scan)}
    installed = importlib.util.find_spec
    if installed("kompass_core"):
        contenders["kompass-core, path as ours"] = kompass(scan, SPACING)
        contenders["kompass-core, path by default"] = kompass(scan, None)
    if installed("dwa"):
        contenders["dynamic-window-approach"] = brute_force(scan)
    with ExitStack() as stack:
        if installed("python_motion_planning"):
            contenders["python-motion-planning"] = stack.enter_context(in_python(scan))
        took = measure(contenders)
    unit = calibrate()
    least, middle = min(took["dynastar"]), float(np.median(took["dynastar"]))
    print(f"calibration kernel {unit:.2f} ms")
    print(f"{'':32}{'samples':>8}{'left':>6}{'steps':>6}{'best':>9}{'median':>9}{'/ kernel':>9}"
          "   dynastar over it: best, median, a sample")  # fmt: skip
    for name, (_, samples, left, steps) in contenders.items():
        if name != "dynastar":  # whose window leaves out samples that are the same
            assert samples >= 0.95 * COUNT**2
            assert steps == STEPS
        best, median = min(took[name]), float(np.median(took[name]))
        each = (middle / contenders["dynastar"].samples) / (median / samples)
        print(f"{name:32}{samples:8}{left:6}{steps:6}{best:9.2f}{median:9.2f}"
              f"{median / unit:9.2f}   {least / best:.4f}, {middle / median:.4f}, {each:.4f}")  # fmt: skip


if __name__ == "__main__":
    main()

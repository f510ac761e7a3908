"""Distance fields beside those of others: ``python benchmarks/field.py``.

``dynastar.clearance.distance_field`` (OpenCV's exact transform, one thread), scipy's
``distance_transform_edt`` and the package edt (one thread; left out if it is not installed) on maps of
1000 x 1000 cells, in turns, warm, the best of some times; the fields are asserted to be the same to 0.001
cells. Below, what a robot has to keep up to date: a local
map of 200 x 200 cells (10 m at 5 cm) that a scan changed or that moved on by a metre.
"""

import math
import time
from collections.abc import Callable

import cv2
import numpy as np
from maps import office, random_cells, rooms
from scipy.ndimage import distance_transform_edt

try:
    import edt
except ImportError:
    edt = None

from dynastar import Lidar, OccupancyGrid, Pose2D
from dynastar.clearance import distance_field
from dynastar.perception import LocalMap, LocalMapConfig
from dynastar.perception.placed_scan import placed
from dynastar.simulation.lidar import LidarSimulator

N, SIDE, CELL, REPEATS = 1000, 200, 0.05, 10


def least(*runs: Callable[[], object]) -> list[float]:
    """Milliseconds of each, the best of some times, in turns."""
    best = [math.inf] * len(runs)
    for _ in range(REPEATS):
        for i, run in enumerate(runs):
            run()  # finds the caches again
            began = time.perf_counter()
            run()
            best[i] = min(best[i], 1e3 * (time.perf_counter() - began))
    return best


def local_map_times(occupied: np.ndarray) -> tuple[float, float]:
    """Milliseconds to bring a local map up to date, and to move it on first, after a scan in mid-map."""
    grid = OccupancyGrid.from_occupied(occupied, CELL)
    rows, columns = np.nonzero(~occupied)
    middle = int(np.hypot(rows - N / 2, columns - N / 2).argmin())
    at = Pose2D((columns[middle] + 0.5) * CELL, (rows[middle] + 0.5) * CELL)
    scan = LidarSimulator(Lidar(720, math.tau, 0.05, 12.0), grid).scan(at, 1.0)
    view = placed(scan, at, (0.01, 0.0), 0.1)
    local_map = LocalMap(LocalMapConfig(SIDE * CELL), CELL)
    local_map.follow(at.x, at.y)
    local_map.see(view, np.zeros(len(view.points), bool))
    barred, aside = np.zeros((SIDE, SIDE), bool), 0.0

    def move_on() -> None:
        nonlocal aside
        aside = 1.0 - aside
        before = local_map.column0
        local_map.follow(at.x + aside, at.y)
        assert local_map.column0 != before
        local_map.update(1.0, barred)

    still, moved = least(lambda: local_map.update(1.0, barred), move_on)
    assert local_map.field.shape == (SIDE, SIDE)
    return still, moved


def main() -> None:
    """Prints both tables."""
    cv2.setNumThreads(1)
    maps = {
        "random 20%": random_cells(N, 0.2, 0),
        "rooms 33": rooms(N, 33, 0),
        "rooms 65": rooms(N, 65, 0),
        "office": office(N, 0),
    }
    others = ("scipy",) if edt is None else ("scipy", "edt")
    beside = "".join(f"{other:>10}{'ratio':>8}" for other in others)
    print(f"{f'ms, {N} x {N}':16}{'dynastar':>10}{beside}")
    for name, occupied in maps.items():
        free = ~occupied
        field = distance_field(occupied, 1.0)
        assert np.abs(field - distance_transform_edt(free)).max() < 1e-3
        runs = [lambda o=occupied: distance_field(o, 1.0), lambda f=free: distance_transform_edt(f)]
        if edt is not None:
            assert np.abs(field - edt.edt(free, parallel=1)).max() < 1e-3
            runs.append(lambda f=free: edt.edt(f, parallel=1))
        own, *theirs = least(*runs)
        print(f"{name:16}{own:10.2f}" + "".join(f"{ms:10.2f}{own / ms:8.2f}" for ms in theirs))
    print(f"\n{'ms, 200 x 200':16}{'local map':>10}{'moved on':>10}")
    for name, occupied in maps.items():
        still, moved = local_map_times(occupied)
        print(f"{name:16}{still:10.2f}{moved:10.2f}")


if __name__ == "__main__":
    main()

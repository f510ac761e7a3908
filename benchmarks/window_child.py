"""python-motion-planning's DWA, in a process of its own (it is GPL): ``window.py`` starts it and asks it.

A line of JSON in: the task of ``window.py``. A line out: how many samples it rolls out, how many of
them are clear, and the fewest and most steps. Then for every line in, a command from the same scan is
timed, and a line with the seconds goes out.
"""

import json
import math
import sys
import time
from typing import Any

import numpy as np
from gymnasium import spaces
from python_motion_planning.common import TYPES, DiffDriveRobot, Grid
from python_motion_planning.controller import DWA

CELL, SIDE = 0.05, 10.0  # m, as dynastar's local map


def controller(task: dict[str, Any], grid: Grid) -> DWA:
    """The controller on ``grid``, with a resolution that gives the number of samples along each axis."""
    accelerations = np.array([task["v_accel"], 0.0, task["omega_accel"]])
    dt, count = task["period"], task["count"]
    wide = 2.0 * accelerations * dt / (count - 1)  # the window is one period's
    return DWA(
        observation_space=spaces.Box(-np.inf, np.inf, (6,)),
        action_space=spaces.Box(-accelerations, accelerations, dtype=np.float64),
        dt=dt,
        path=[tuple(point) for point in task["path"]],
        max_lin_speed=task["v_max"] + 1e-6,
        max_ang_speed=task["omega_max"],
        robot_model=DiffDriveRobot(radius=task["radius"]),
        obstacle_grid=grid,
        vel_reso=np.maximum(wide * (1.0 + 1e-9), 1e-3),
        predict_time=(task["steps"] - 0.5) * dt,
        lookahead_distance=task["lookahead"],
    )


def main() -> None:
    """Answers line by line until its input ends."""
    task = json.loads(sys.stdin.readline())
    x, y, theta = task["pose"]
    v, omega = task["twist"]
    x0, y0 = x - SIDE / 2, y - SIDE / 2
    grid = Grid(bounds=[[x0, x0 + SIDE], [y0, y0 + SIDE]], resolution=CELL)
    dwa = controller(task, grid)
    ranges, angles = np.array(task["ranges"]), np.array(task["angles"])
    state = np.array([x, y, theta, v * math.cos(theta), v * math.sin(theta), omega])

    def command() -> Any:
        at = theta + angles
        columns = np.floor((x + ranges * np.cos(at) - x0) / CELL).astype(np.int64)
        rows = np.floor((y + ranges * np.sin(at) - y0) / CELL).astype(np.int64)
        cells = np.full(grid.shape, TYPES.FREE, dtype=np.int8)
        inside = (columns >= 0) & (columns < len(cells)) & (rows >= 0) & (rows < len(cells))
        cells[columns[inside], rows[inside]] = TYPES.OBSTACLE
        grid.type_map[:] = cells
        return dwa.get_action(state)  # makes the distance field when it first asks for it

    steps: list[int] = []
    scores: list[float] = []
    score = dwa._clearance_score

    def counting(trajectory: list[Any]) -> float:
        steps.append(len(trajectory) - 1)
        scores.append(score(trajectory))
        return scores[-1]

    dwa._clearance_score = counting
    command()
    dwa._clearance_score = score
    left = sum(map(math.isfinite, scores))
    print(json.dumps([len(scores), left, min(steps), max(steps)]), flush=True)
    for _ in sys.stdin:
        began = time.perf_counter()
        command()
        print(json.dumps(time.perf_counter() - began), flush=True)


if __name__ == "__main__":
    main()

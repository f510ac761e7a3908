"""The peers of ``window.py``, and what everybody is asked: the robot, where it is and where to.

Each is told as nearly the same as it can be; see ``window.py`` for what they do with it.
"""

import itertools
import json
import math
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from types import SimpleNamespace
from typing import Any, NamedTuple

import numpy as np

from dynastar import ROBOTS, Goal, LaserScan, Pose2D, Twist

COUNT, STEPS, PERIOD = 20, 30, 0.1  # speeds along each axis, steps of a sample, s
POSE, TWIST, GOAL = Pose2D(2.0, 3.0), Twist(0.3, 0.0), Goal(7.0, 3.0)
SPACING, LOOKAHEAD = 0.1, 1.5  # m, of the path's points and along it
ROBOT = ROBOTS["pioneer3dx"]
CHILD = Path(__file__).with_name("window_child.py")


class Contender(NamedTuple):
    """A controller: its command once more, samples in the window, those left, and steps of each."""

    seconds: Callable[[], float]
    samples: int
    left: int
    steps: int


def timed(command: Callable[[], object]) -> Callable[[], float]:
    """``command`` as a function that returns how long it took."""

    def seconds() -> float:
        began = time.perf_counter()
        command()
        return time.perf_counter() - began

    return seconds


def kompass(scan: LaserScan, spacing: float | None) -> Contender:
    """kompass-core's DWA; ``spacing`` (m) of the path's points, None for its default of 1 cm."""
    import kompass_cpp
    from kompass_core import models
    from kompass_core.control import DWA, DWAConfig

    kompass_cpp.set_log_level(kompass_cpp.LogLevel.ERROR)
    limits = ROBOT.limits
    robot = models.Robot(
        robot_type=models.RobotType.DIFFERENTIAL_DRIVE,
        geometry_type=models.RobotGeometry.Type.CYLINDER,
        geometry_params=np.array([ROBOT.footprint.inscribed, 0.5]),
    )
    config = DWAConfig(
        control_time_step=PERIOD,
        prediction_horizon=STEPS + 1,  # points
        max_linear_samples=COUNT,
        max_angular_samples=COUNT,
        octree_resolution=0.05,
        max_num_threads=1,
        allow_reverse=False,
        **({} if spacing is None else {"max_point_interpolation_distance": spacing}),
    )
    linear = models.LinearCtrlLimits(limits.v_max, limits.v_accel, limits.v_brake)
    angular = models.AngularCtrlLimits(
        math.pi, limits.omega_max, limits.omega_accel, limits.omega_brake
    )
    controller = DWA(
        robot=robot,
        ctrl_limits=models.RobotCtrlLimits(vx_limits=linear, omega_limits=angular),
        config=config,
    )
    points = np.arange(POSE.x, GOAL.x + 1e-9, SPACING)
    poses = [SimpleNamespace(position=SimpleNamespace(x=float(x), y=POSE.y)) for x in points]
    controller.set_path(SimpleNamespace(poses=[SimpleNamespace(pose=pose) for pose in poses]))
    state = models.RobotState(x=POSE.x, y=POSE.y, yaw=0.0, speed=TWIST.v, vx=TWIST.v)
    angles = scan.angles.astype(np.float32)

    def command() -> None:
        assert controller.loop_step(current_state=state, ranges=scan.ranges, angles=angles)

    command()
    twist = kompass_cpp.types.Velocity2D(vx=TWIST.v, vy=0.0, omega=TWIST.omega)
    counts = []
    for ranges in (
        np.full_like(scan.ranges, scan.range_max),
        scan.ranges,
    ):  # nothing near; the room
        controller.planner.debug_velocity_search(twist, ranges, angles, True)
        xs, _ = controller.planner.get_debugging_samples()
        counts.append(len(xs))
    return Contender(timed(command), *counts, xs.shape[1] - 1)


def brute_force(scan: LaserScan) -> Contender:
    """dynamic-window-approach, with resolutions that give the number of samples along each axis."""
    import dwa

    limits = ROBOT.limits
    v_step = (limits.v_max - max(0.0, TWIST.v - limits.v_accel * PERIOD)) / (COUNT + 1e-3)
    w_step = (limits.omega_max + limits.omega_accel * PERIOD) / (COUNT + 1e-3)
    r = ROBOT.footprint.inscribed
    config = dwa.Config(
        limits.v_max, 0.0, limits.omega_max, limits.v_accel, limits.omega_accel,
        v_step, w_step, PERIOD, (STEPS - 0.5) * PERIOD, 0.3, 0.2, 0.2, [-r, -r, r, r],
    )  # fmt: skip

    def cloud() -> np.ndarray:
        at = POSE.theta + scan.angles
        ends = (POSE.x + scan.ranges * np.cos(at), POSE.y + scan.ranges * np.sin(at))
        return np.column_stack(ends).astype(np.float32)

    def command() -> None:
        dwa.planning(tuple(POSE), tuple(TWIST), GOAL[:2], cloud(), config)

    window = dwa.DynamicWindow((TWIST.v, TWIST.omega), config)
    samples = itertools.product(window.possible_v.tolist(), window.possible_w.tolist())
    costs = [dwa.calculate_clearance_cost(tuple(POSE), s, cloud(), config) for s in samples]
    left = sum(cost < 1e6 for cost in costs)  # of a contact it is the largest float
    return Contender(timed(command), len(costs), left, STEPS)


@contextmanager
def in_python(scan: LaserScan) -> Iterator[Contender]:
    """python-motion-planning's DWA in its own process; each command is timed there."""
    limits = ROBOT.limits
    task = limits._asdict() | {
        "radius": ROBOT.footprint.inscribed, "pose": POSE, "twist": TWIST, "lookahead": LOOKAHEAD,
        "path": [(float(x), POSE.y) for x in np.arange(POSE.x, GOAL.x + 1e-9, SPACING)],
        "ranges": scan.ranges.tolist(), "angles": scan.angles.tolist(),
        "count": COUNT, "steps": STEPS, "period": PERIOD,
    }  # fmt: skip
    pipe, command = subprocess.PIPE, [sys.executable, "-W", "ignore", CHILD]
    with subprocess.Popen(command, stdin=pipe, stdout=pipe, text=True) as child:
        assert child.stdin is not None
        assert child.stdout is not None

        def ask(line: str) -> Any:
            print(line, file=child.stdin, flush=True)
            return json.loads(child.stdout.readline())

        samples, left, fewest, most = ask(json.dumps(task))
        assert fewest == most
        yield Contender(lambda: float(ask("again")), samples, left, most)
        child.stdin.close()

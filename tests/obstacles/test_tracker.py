import math

import numpy as np
import pytest

from dynastar.geometry import Pose2D
from dynastar.obstacles import ObstacleLayer, Tracker
from dynastar.obstacles.layer import SEEN_OCCUPIED
from dynastar.obstacles.layer_kernels import scan_points
from dynastar.scan import LaserScan

N, FAR = 720, 8.0


def ranges_to(discs, sensor, noise=None):
    """Ranges from a sensor to discs (x, y, radius) in the open, the slow way."""
    ranges = np.full(N, np.inf)
    for i in range(N):
        angle = sensor.theta - math.pi + i * math.tau / N
        ux, uy = math.cos(angle), math.sin(angle)
        for x, y, radius in discs:
            dx, dy = x - sensor.x, y - sensor.y
            along = dx * ux + dy * uy
            miss = radius**2 - (dx * dx + dy * dy - along * along)
            if along > 0 and miss >= 0:
                ranges[i] = min(ranges[i], along - math.sqrt(miss))
    if noise is not None:
        ranges += np.clip(noise.normal(0, 0.01, N), -0.02, 0.02)
    return ranges


def watch(discs_at, seconds, sensor_at=lambda t: Pose2D(0.0, 0.0, 0.0), noise=None):
    layer, tracker = ObstacleLayer(), Tracker()
    for k in range(int(seconds * 10) + 1):
        t = k / 10
        sensor = sensor_at(t)
        scan = LaserScan(
            t, ranges_to(discs_at(t), sensor, noise), -math.pi, math.tau / N, 0.05, FAR
        )
        points, beams = scan_points(
            scan.ranges,
            scan.range_min,
            scan.range_max,
            scan.angle_min,
            scan.angle_increment,
            *sensor,
        )
        layer.follow(sensor.x, sensor.y)
        moving = tracker.see(scan, sensor, points, beams, layer)
        layer.see(scan, sensor, points, moving, 0.02 if noise is not None else 0.0, 0.0)
        layer.update(t)
    return layer, tracker, moving


@pytest.mark.parametrize("speed", [0.3, 0.5, 1.2])
def test_a_walker_is_found_with_its_velocity(speed):
    _, tracker, moving = watch(lambda t: [(3.0, -1.0 + speed * t, 0.3)], 2.0)
    (mover,) = tracker.movers
    assert (mover.vx, mover.vy) == pytest.approx((0.0, speed), abs=0.15)
    assert (mover.x, mover.y) == pytest.approx((3.0, -1.0 + 2 * speed), abs=0.15)
    assert mover.radius == pytest.approx(0.3, abs=0.1)
    assert moving.sum() > 10


def test_a_walker_leaves_no_ghost():
    layer, _, _ = watch(lambda t: [(3.0, -1.5 + 1.0 * t, 0.3)], 3.0)
    assert not (layer.states == SEEN_OCCUPIED).any()


def test_what_stands_is_no_mover_though_the_robot_drives_past():
    still = [(3.0, 1.0, 0.3), (2.0, -1.5, 0.4), (4.0, -0.3, 0.2), (5.0, 2.0, 0.5)]
    layer, tracker, moving = watch(
        lambda t: still,
        4.0,
        lambda t: Pose2D(0.8 * t, 0.0, 0.1 * t),
        noise=np.random.default_rng(1),
    )
    assert tracker.movers == ()
    assert not moving.any()
    assert (layer.states == SEEN_OCCUPIED).any()


def test_a_walker_that_stops_stands_again():
    layer, tracker, _ = watch(lambda t: [(3.0, min(-1.0 + 0.8 * t, 0.5), 0.3)], 6.0)
    assert tracker.movers == ()
    assert (layer.states == SEEN_OCCUPIED).any()


def test_two_walkers_that_pass_each_other_keep_their_velocities():
    _, tracker, _ = watch(lambda t: [(3.0, -1.5 + 0.6 * t, 0.25), (4.2, 1.5 - 0.6 * t, 0.25)], 4.5)
    assert sorted(round(m.vy, 1) for m in tracker.movers) == pytest.approx([-0.6, 0.6], abs=0.15)

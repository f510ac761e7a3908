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


# -- out of sight ----------------------------------------------------------------------------------

PILLAR = (2.0, 0.0, 0.5)  # hides about 2 m at x = 4


def walking(y0, speed):
    return lambda t: [PILLAR, (4.0, y0 + speed * t, 0.25)]


def test_a_walker_that_goes_behind_something_is_still_reckoned_with():
    """Where it was lost it may come back, and where it may have got to it may come out."""
    _, tracker, _ = watch(walking(-3.0, 0.8), 4.0)  # at y = 0.2, in the middle of the shadow
    movers = tracker.movers
    assert {round(m.x) for m in movers} == {4}
    assert any(abs(m.y - 0.2) < 0.4 for m in movers)
    assert any(-1.6 < m.y < -0.5 for m in movers)
    assert all(m.vy == pytest.approx(0.8, abs=0.2) for m in movers)


def test_who_comes_out_again_is_one_walker_at_its_own_speed():
    _, tracker, _ = watch(walking(-3.0, 0.8), 6.5)
    (mover,) = tracker.movers
    assert (mover.vx, mover.vy) == pytest.approx((0.0, 0.8), abs=0.2)
    assert (mover.x, mover.y) == pytest.approx((4.0, 2.2), abs=0.2)


def test_who_hides_stays_hidden_until_it_is_too_long_ago():
    """It stopped behind the pillar: nobody may be where space is seen free."""

    def hiding(t):
        return [PILLAR, (4.0, min(-3.0 + 0.8 * t, 0.0), 0.25)]

    _, tracker, _ = watch(hiding, 8.0)
    assert tracker.movers
    for mover in tracker.movers:
        assert abs(math.atan2(mover.y, mover.x)) < math.asin(0.5 / 2.0) + 0.06
    _, tracker, _ = watch(hiding, 11.0)
    assert tracker.movers == ()


def test_a_hiding_place_that_came_into_view_empty_hides_nobody():
    def gone(t):
        return [PILLAR, (4.0, -3.0 + 0.8 * t, 0.25)] if t < 3.5 else []

    _, tracker, _ = watch(gone, 4.5)
    assert tracker.movers == ()


def test_two_things_taken_for_one_are_not_something_fast():
    """A pole is hidden for a moment as another comes into view far off: nobody ran there."""

    def poles(t):
        return [(3.0, 0.3 * t, 0.2)] if t < 1.5 else [(3.0, 0.8 + 0.1 * t, 0.2)]

    _, tracker, _ = watch(poles, 1.8)
    assert all(math.hypot(m.vx, m.vy) < 3.0 for m in tracker.movers)


def test_a_wall_along_the_cells_is_no_mover_as_it_comes_into_view():
    """Its face lies on the edge of the cells, so beams pass through cells that its points lie in."""

    def box_ranges(sensor):
        ranges = np.full(N, np.inf)
        for i in range(N):
            angle = sensor.theta - math.pi + i * math.tau / N
            ux, uy = math.cos(angle), math.sin(angle)
            t0, t1 = -np.inf, np.inf
            for low, high, at, u in ((2.0, 3.0, sensor.x, ux), (1.0, 2.0, sensor.y, uy)):
                if abs(u) < 1e-9:
                    if not low <= at <= high:
                        t0 = np.inf
                    continue
                a, b = sorted(((low - at) / u, (high - at) / u))
                t0, t1 = max(t0, a), min(t1, b)
            if 0.0 < t0 <= t1:
                ranges[i] = t0
        return ranges

    layer, tracker = ObstacleLayer(), Tracker()
    noise = np.random.default_rng(3)
    for k in range(60):
        t = k / 10
        sensor = Pose2D(-1.0 + 0.5 * t, 0.2, 0.2 * t)
        ranges = box_ranges(sensor) + np.clip(noise.normal(0, 0.01, N), -0.02, 0.02)
        scan = LaserScan(t, ranges, -math.pi, math.tau / N, 0.05, FAR)
        points, beams = scan_points(
            scan.ranges, 0.05, FAR, scan.angle_min, scan.angle_increment, *sensor
        )
        layer.follow(sensor.x, sensor.y)
        moving = tracker.see(scan, sensor, points, beams, layer)
        layer.see(scan, sensor, points, moving, 0.02, 0.0)
        layer.update(t)
        assert tracker.movers == (), t

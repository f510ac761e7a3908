import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.clearance import inflate
from dynastar.geometry import Pose2D
from dynastar.grid import GridFrame
from dynastar.obstacles import Known, ObstacleLayer, Tracker
from dynastar.obstacles import tracker_kernels as kernels
from dynastar.obstacles.layer import SEEN_OCCUPIED
from dynastar.obstacles.layer_kernels import scan_points
from dynastar.obstacles.tracker import NOTHING_KNOWN
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


@given(st.floats(0.05, 1.0), st.floats(0.02, 0.7))
@settings(deadline=None)
def test_a_disc_is_told_from_its_width_and_the_mean_of_its_points(radius, sin):
    distance = radius / sin
    angles = math.asin(sin) * (np.arange(20_000) + 0.5) / 20_000
    ranges = distance * np.cos(angles) - np.sqrt(radius**2 - (distance * np.sin(angles)) ** 2)
    half = radius * math.sqrt(1.0 - sin * sin)
    got = kernels.disc_in_view(float(np.mean(ranges * np.cos(angles))), half)
    assert got == pytest.approx((distance, radius), rel=0.02)


@pytest.mark.parametrize("distance", [0.8, 1.0, 2.0, 4.0])
def test_a_walker_is_where_it_is_though_less_than_half_is_seen_from_near_by(distance):
    def coming(t):
        return [(distance + 1.5 - 0.5 * t, 0.0, 0.3)]

    _, tracker, _ = watch(coming, 3.0, noise=np.random.default_rng(2))
    (mover,) = tracker.movers
    assert (mover.x, mover.y) == pytest.approx((distance, 0.0), abs=0.03)
    assert mover.radius == pytest.approx(0.3, abs=0.03)


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


def track(vx, moving=1.0):
    """One track at (2, 0) with that velocity."""
    row = np.zeros((1, kernels.COLUMNS))
    row[0, [kernels.T_X, kernels.T_VX, kernels.T_MOVING, kernels.T_RADIUS]] = 2.0, vx, moving, 0.3
    row[0, [kernels.T_PP, kernels.T_PV, kernels.T_VV]] = 0.01, 0.01, 0.05
    return row


def test_two_things_taken_for_one_are_not_something_fast():
    tracks = np.vstack([track(2.5), track(3.5)])
    kernels.judge(tracks, 0.0, 3, 0.12, 3.0, 0.4, 1.0)
    assert tracks[:, kernels.T_MOVING].tolist() == [1.0, 0.0]


@pytest.mark.parametrize("radius", [0.2, 0.3, 0.4])
def test_who_comes_out_from_behind_something_is_found_before_half_is_seen(radius):
    """Its speed is that of the end in view, not that of the middle of what has come into view."""
    edge = 4.0 * math.tan(math.asin(0.5 / 2.0))  # of the pillar's shadow
    _, tracker, _ = watch(lambda t: [PILLAR, (4.0, edge - radius + 0.5 * t, radius)], 0.6)
    (mover,) = tracker.movers
    assert mover.vy == pytest.approx(0.5, abs=0.12)
    assert mover.vx == pytest.approx(0.0, abs=0.12)
    assert mover.y + mover.radius == pytest.approx(edge + 0.5 * 0.6, abs=0.08)


@pytest.mark.parametrize("distance", [0.5, 0.7, 2.0])
@pytest.mark.parametrize("hidden", [1, -1])
def test_a_disc_of_which_one_end_is_in_view_is_where_it_is(distance, hidden):
    step = 0.005
    angles = np.arange(-0.1, math.asin(0.3 / distance), step)
    ranges = distance * np.cos(angles) - np.sqrt(0.09 - (distance * np.sin(angles)) ** 2)
    points = np.column_stack([ranges * np.cos(angles), hidden * ranges * np.sin(angles)])
    points = points if hidden > 0 else points[::-1].copy()
    at = kernels.disc_at_end(points, 0, len(points), hidden, 0.3, 0.5 * step, 0.0, 0.0)
    assert at == pytest.approx((distance, 0.0), abs=0.01)


def test_what_stands_and_comes_into_view_is_no_mover():
    still = [PILLAR, (4.0, 1.1, 0.3), (4.5, -1.2, 0.4), (5.0, 0.3, 0.2)]
    _, tracker, moving = watch(lambda t: still, 3.0, lambda t: Pose2D(0.2 * t, 0.5 * t, 0.0))
    assert tracker.movers == ()
    assert not moving.any()


def test_what_comes_into_view_of_a_mover_between_two_things_is_no_motion():
    cluster = np.array([[2.3, 0.0, 0.3, 1.0, 0.0, 1.0, 0.0]])
    for cut, faster in ((0.0, True), (2.0, False)):
        cluster[0, kernels.C_CUT] = cut
        row = track(0.5)
        kernels.correct(row, cluster, 0.04, 0.0)
        assert (row[0, kernels.T_VX] > 0.51) == faster
        assert row[0, kernels.T_X] > 2.0


def look(ranges, here, known, layer, tracker, t):
    scan = LaserScan(t, ranges, -math.pi, math.tau / N, 0.05, FAR)
    points, beams = scan_points(ranges, 0.05, FAR, -math.pi, math.tau / N, *here)
    moving = tracker.see(scan, here, points, beams, layer, known)
    layer.see(scan, here, points, moving, 0.02, 0.0)
    return points, beams


def ranges_to_face(x, low, high):
    """Ranges from the origin to a face at ``x`` from y ``low`` to ``high``."""
    angles = -math.pi + np.arange(N) * math.tau / N
    with np.errstate(divide="ignore", over="ignore"):
        y = x * np.tan(angles)
        hit = (np.cos(angles) > 1e-3) & (low <= y) & (y <= high)
        return np.where(hit, x / np.cos(angles), np.inf)


def test_a_face_along_the_edges_of_the_cells_is_not_in_space_seen_free():
    """Half its points lie in cells that beams pass."""
    layer, tracker, here = ObstacleLayer(), Tracker(), Pose2D(0.0, 0.0, 0.0)
    layer.follow(0.0, 0.0)
    noise = np.random.default_rng(3)
    for k in range(10):
        ranges = ranges_to_face(2.0, 0.0, 1.0) + np.clip(noise.normal(0, 0.01, N), -0.02, 0.02)
        points, beams = look(ranges, here, NOTHING_KNOWN, layer, tracker, k / 10)
    found = kernels.clusters(
        points,
        beams,
        N,
        True,
        math.tau / N,
        0.0,
        0.0,
        0.2,
        1.3,
        layer.free_at,
        *layer.origin,
        layer.config.resolution,
        -2.0,
        NOTHING_KNOWN.mask,
        NOTHING_KNOWN.frame,
    )
    assert found[:, kernels.C_FRESH].tolist() == pytest.approx([0.0], abs=0.1)


def test_a_walker_beside_a_wall_of_the_map_is_found():
    """Its points and the wall's are one row; the map tells them apart."""
    mapped = np.zeros((200, 200), bool)
    mapped[103:115, 140:] = True  # from (4.0, 0.3) to y = 1.5, on a map from (-10, -10)
    known = Known(inflate(mapped, 1.0), GridFrame(0.1, -10.0, -10.0))
    layer, tracker, here = ObstacleLayer(), Tracker(), Pose2D(0.0, 0.0, 0.0)
    layer.follow(0.0, 0.0)
    for k in range(11):
        walker = ranges_to([(4.5 - 0.05 * k, 0.0, 0.28)], here)
        look(np.minimum(ranges_to_face(4.0, 0.3, 1.8), walker), here, known, layer, tracker, k / 10)
    (mover,) = tracker.movers
    assert (mover.vx, mover.vy) == pytest.approx((-0.5, 0.0), abs=0.1)


@pytest.mark.parametrize("walks", [True, False])
def test_a_walker_close_by_something_wide_that_no_map_shows_is_found(walks):
    """Their points are one row, too wide to walk; somebody is where space was seen free before."""
    layer, tracker, here = ObstacleLayer(), Tracker(), Pose2D(0.0, 0.0, 0.0)
    layer.follow(0.0, 0.0)
    for k in range(20):
        ranges = ranges_to_face(2.0, 0.05, 1.7)
        if walks and k > 8:
            walker = ranges_to([(2.3 - 0.05 * (k - 8), -0.28, 0.3)], here)
            ranges = np.minimum(ranges, walker)
        look(ranges, here, NOTHING_KNOWN, layer, tracker, k / 10)
    if walks:
        (mover,) = tracker.movers
        assert (mover.vx, mover.vy) == pytest.approx((-0.5, 0.0), abs=0.15)
    else:
        assert tracker.movers == ()


@pytest.mark.parametrize("setback", [0.12, 0.4])
def test_a_part_of_something_wide_is_nobody_unless_where_space_was_seen_free(setback):
    """A step in a face, between what takes a wide thing apart and what makes it two things."""
    layer, tracker, here = ObstacleLayer(), Tracker(), Pose2D(0.0, 0.0, 0.0)
    layer.follow(0.0, 0.0)
    for k in range(3):
        faces = ranges_to_face(2.0, -0.9, 0.0), ranges_to_face(2.0 + setback, 0.0, 0.9)
        look(np.minimum(*faces), here, NOTHING_KNOWN, layer, tracker, k / 10)
    assert len(tracker.newcomers()) == (0 if setback < 0.2 else 2)


def test_what_comes_into_view_is_new_until_it_is_known_where_it_walks_or_that_it_stands():
    def walker_and_post(t):
        return [(3.0, -1.0 + 0.5 * t, 0.3), (-3.0, 0.0, 0.3)]

    _, tracker, _ = watch(walker_and_post, 0.1)
    assert len(tracker.in_sight()) == 0
    assert tracker.newcomers()[:, 0] == pytest.approx([3.0, -3.0], abs=0.2)
    _, tracker, _ = watch(walker_and_post, 0.6)
    assert len(tracker.in_sight()) == 1  # and yet where to may be wrong
    assert tracker.newcomers()[:, 0] == pytest.approx([3.0, -3.0], abs=0.2)
    _, tracker, _ = watch(walker_and_post, 1.0)
    assert len(tracker.newcomers()) == 0
    ((x, y, radius),) = tracker.in_sight()
    assert (x, y, radius) == pytest.approx((3.0, -0.5, 0.3), abs=0.15)


def test_who_is_out_of_sight_is_not_in_sight():
    _, tracker, _ = watch(walking(-3.0, 0.8), 4.0)
    assert len(tracker.movers)
    assert len(tracker.in_sight()) == len(tracker.newcomers()) == 0

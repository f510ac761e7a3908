import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.geometry import Pose2D
from dynastar.grid import OccupancyGrid
from dynastar.perception import LocalMap, LocalMapConfig
from dynastar.perception.local_map import SEEN_FREE, SEEN_OCCUPIED, UNSEEN
from dynastar.perception.local_map_kernels import NEVER, mark_free, scan_points
from dynastar.scan import LaserScan
from naive import observed_free

N = 360


def scan(ranges, stamp=1.0, fov=math.tau, range_min=0.0, range_max=5.0):
    increment = math.tau / N if fov == math.tau else fov / (N - 1)
    return LaserScan(stamp, np.broadcast_to(ranges, N), -fov / 2, increment, range_min, range_max)


def map_after(
    *scans, pose=Pose2D(0.0, 0.0, 0.0), config=LocalMapConfig(size=12.0), now=None, error=0.0
):
    local_map = LocalMap(config)
    local_map.follow(pose.x, pose.y)
    for s in scans:
        limits, beams = (s.range_min, s.range_max), (s.angle_min, s.angle_increment)
        points, _ = scan_points(s.ranges, limits, beams, tuple(pose))
        local_map.see(s, pose, points, np.zeros(len(points), bool), error, 0.0)
    local_map.update(scans[-1].stamp if now is None else now)
    return local_map


def state(local_map, x, y):
    a = local_map.config.resolution
    return local_map.states[
        math.floor(y / a) - local_map.row0, math.floor(x / a) - local_map.column0
    ]


def test_beams_free_what_they_pass_and_mark_where_they_end():
    local_map = map_after(scan(2.0))
    assert state(local_map, 1.5, 0.02) == SEEN_FREE
    assert (
        state(local_map, 1.98, 0.02) != SEEN_FREE or state(local_map, 2.02, 0.02) == SEEN_OCCUPIED
    )
    assert (local_map.states == SEEN_OCCUPIED).sum() > 150
    assert state(local_map, 3.0, 0.0) == UNSEEN


def test_infinity_frees_up_to_range_max_and_marks_nothing():
    local_map = map_after(scan(np.inf))
    assert state(local_map, 4.8, 0.02) == SEEN_FREE
    assert state(local_map, 5.1, 0.0) == UNSEEN
    assert not (local_map.states == SEEN_OCCUPIED).any()


@pytest.mark.parametrize("reading", [np.nan, 0.0, -np.inf, -1.0, 0.05, 7.0])
def test_what_says_nothing_changes_nothing(reading):
    local_map = map_after(scan(reading, range_min=0.1))
    assert (local_map.states == UNSEEN).all()


def test_nothing_is_free_between_beams_wider_apart_than_the_narrowest_obstacle():
    config = LocalMapConfig(narrowest=0.04)  # 360 beams are 0.04 m apart at 2.3 m
    local_map = map_after(scan(4.0), config=config)
    assert state(local_map, 2.0, 0.02) == SEEN_FREE
    assert state(local_map, 2.6, 0.02) == UNSEEN


def test_free_reaches_as_far_as_the_shorter_neighbour():
    ranges = np.full(N, 4.0)
    ranges[180] = 1.0  # the beam along x
    local_map = map_after(scan(ranges))
    step = math.tau / N
    for side in (-0.4, 0.4):
        assert state(local_map, 2.0 * math.cos(side * step), 2.0 * math.sin(side * step)) == UNSEEN


def test_the_range_error_is_kept_clear_of():
    local_map = map_after(scan(2.0), error=0.3)
    assert state(local_map, 1.6, 0.02) == SEEN_FREE
    assert state(local_map, 1.8, 0.02) == UNSEEN


def test_forgetting_turns_into_unseen_never_into_free():
    local_map = map_after(scan(2.0, stamp=1.0), config=LocalMapConfig(memory=5.0), now=20.0)
    assert (local_map.states == UNSEEN).all()
    assert (local_map.open == 0).all()


def test_a_later_scan_clears_what_has_gone():
    local_map = map_after(scan(2.0, stamp=1.0), scan(3.0, stamp=1.1))
    assert state(local_map, 2.02, 0.02) == SEEN_FREE


def test_a_gap_in_the_field_of_view_stays_unseen():
    local_map = map_after(scan(2.0, fov=math.radians(270)))
    assert state(local_map, 1.0, 0.0) == SEEN_FREE
    assert state(local_map, -1.0, 0.02) == UNSEEN


def test_the_window_moves_along_and_keeps_what_it_knows():
    local_map = map_after(scan(2.0))
    local_map.follow(3.0, -2.0)
    local_map.update(1.0)
    assert state(local_map, 1.5, 0.02) == SEEN_FREE
    assert local_map.origin[0] == pytest.approx(3.0 - 6.0, abs=0.051)


def test_the_disc_at_the_start_is_free_where_neither_map_nor_scan_shows_anything():
    occupied = np.zeros((10, 10), bool)
    occupied[5, 6] = True  # 0.1 m cells, the map's corner at (-0.5, -0.5)
    local_map = LocalMap()
    local_map.set_grid(OccupancyGrid.from_occupied(occupied, 0.1, -0.5, -0.5))
    local_map.follow(0.0, 0.0)
    local_map.assume_free(0.0, 0.0, 0.3, 1.0, fresh=True)
    local_map.update(1.0)
    assert state(local_map, -0.2, 0.0) == SEEN_FREE
    assert state(local_map, 0.15, 0.05) == UNSEEN
    assert state(local_map, 0.4, 0.0) == UNSEEN


def test_keepout_is_closed_though_seen_free():
    keepout = np.zeros((10, 10), bool)
    keepout[:, 8] = True
    grid = OccupancyGrid.from_occupied(np.zeros((10, 10), bool), 0.5, -2.5, -2.5)
    local_map = LocalMap()
    local_map.set_grid(OccupancyGrid(grid.values, grid.frame, keepout))
    local_map.follow(0.0, 0.0)
    s = scan(np.inf)
    local_map.see(s, Pose2D(0.0, 0.0, 0.0), np.empty((0, 2)), np.empty(0, bool), 0.0, 0.0)
    local_map.update(1.0)
    assert state(local_map, 1.7, 0.0) == SEEN_FREE
    a = local_map.config.resolution
    row, column = math.floor(0.0 / a) - local_map.row0, math.floor(1.7 / a) - local_map.column0
    assert local_map.open[row, column] == 0


@given(
    st.integers(0, 10**6),
    st.sampled_from([2, 3, 4, 7, 90, 720]),
    st.sampled_from([90.0, 180.0, 270.0, 360.0]),
    st.booleans(),
    st.booleans(),
    st.sampled_from([0.5, 4.0, 30.0]),
)
@settings(max_examples=150, deadline=None)
def test_what_lies_between_two_beams_is_free_as_far_as_their_gap(
    seed, n, fov, clockwise, squarely, far
):
    rng = np.random.default_rng(seed)
    full = fov == 360.0
    increment = math.radians(fov) / (n if full else n - 1) * (-1 if clockwise else 1)
    if abs(increment) >= math.pi:
        increment = math.copysign(3.0, increment)
        full = False
    gaps = rng.random(n) * far * (rng.random(n) < 0.9)
    gaps[-1] *= full
    sensor = (*rng.uniform(0.5, 4.5, 2), rng.uniform(-4, 4))
    if squarely:  # on a cell's centre, beams along the axes
        sensor = (2.525, 2.525, math.pi / 2 * int(rng.integers(4)))
    free_at = np.full((100, 100), NEVER)
    angle_min = -math.radians(fov) / 2
    mark_free(free_at, (0.05, 0.0, 0.0), gaps, (angle_min, increment), full, sensor, 7.0)
    rows, columns = np.indices(free_at.shape)
    centres = np.column_stack([columns.ravel() * 0.05 + 0.025, rows.ravel() * 0.05 + 0.025])
    free, past, at_end = observed_free(gaps, angle_min, increment, full, sensor, centres)
    found = free_at.ravel() == 7.0
    assert (found == free)[(past > 2e-4) & ~at_end].all()
    assert (found <= free)[(past > 1e-6) & ~at_end].all()  # the smaller of two gaps
    assert (past > 2e-4).mean() > 0.8

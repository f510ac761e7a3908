import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.geometry import Pose2D
from dynastar.perception import LocalMap, LocalMapConfig
from dynastar.perception.local_map import SEEN_FREE, SEEN_OCCUPIED, UNSEEN
from dynastar.perception.local_map_kernels import NEVER, mark_free
from dynastar.perception.placed_scan import Sensor, placed
from dynastar.scan import LaserScan
from naive import observed_free

N = 360


def scan(ranges, stamp=1.0, fov=math.tau, range_min=0.0, range_max=5.0):
    increment = math.tau / N if fov == math.tau else fov / (N - 1)
    return LaserScan(stamp, np.broadcast_to(ranges, N), -fov / 2, increment, range_min, range_max)


def nothing(local_map):
    return np.zeros(local_map.states.shape, bool)


def map_after(
    *scans, pose=Pose2D(0.0, 0.0, 0.0), config=LocalMapConfig(size=12.0), now=None, error=0.0
):
    local_map = LocalMap(config)
    local_map.follow(pose.x, pose.y)
    for s in scans:
        view = placed(s, pose, (error, 0.0), config.narrowest)
        local_map.see(view, np.zeros(len(view.points), bool))
    local_map.update(scans[-1].stamp if now is None else now, nothing(local_map))
    return local_map


def index(local_map, x, y):
    x0, y0 = local_map.origin
    return math.floor((y - y0) / local_map.resolution), math.floor((x - x0) / local_map.resolution)


def state(local_map, x, y):
    return local_map.states[index(local_map, x, y)]


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


def box_at(local_map, x, y):
    """The box of the hits in the cell of a point: low x, high x, low y, high y (m, map frame)."""
    row, column = index(local_map, x, y)
    offsets = [float(local_map.boxes[row, column][name]) for name in local_map.boxes.dtype.names]
    x0, y0 = np.array(local_map.origin) + (np.array([column, row]) + 0.5) * local_map.resolution
    return np.array(offsets) + (x0, x0, y0, y0)


def wall(distance, stamp):
    """A scan of a wall across the x axis, 90 degrees wide."""
    angles = -math.pi / 4 + np.arange(N) * (math.pi / 2) / (N - 1)
    return scan(distance / np.cos(angles), stamp, fov=math.pi / 2)


def test_the_box_of_a_cell_holds_all_hits_in_it():
    x = 2.025
    near, far = wall(x - 0.01, 1.0), wall(x + 0.015, 1.1)
    for scans, low, high in ([near], -0.01, -0.01), ([near, far], -0.01, 0.015):
        local_map = map_after(*scans)
        assert state(local_map, x, 0.02) == SEEN_OCCUPIED
        box = box_at(local_map, x, 0.02)
        assert box[:2] == pytest.approx((x + low, x + high), abs=1e-5)
        assert 0.0 <= box[2] < 0.01 < 0.04 < box[3] <= 0.05


def test_a_box_begins_anew_where_a_cell_was_free_for_long_or_its_hits_are_forgotten():
    x = 2.025
    near, far = wall(x - 0.015, 1.0), wall(x - 0.005, 3.2)
    for between in [wall(4.0, 3.0)], []:
        local_map = map_after(near, *between, far)
        low = -0.005 if between else -0.015
        assert box_at(local_map, x, 0.02)[0] == pytest.approx(x + low, abs=1e-5)
    config = LocalMapConfig(size=12.0, memory=2.0)
    assert box_at(map_after(near, far, config=config), x, 0.02)[0] == pytest.approx(x - 0.005)


def test_boxes_move_with_the_window_and_are_whole_cells_on_another_lattice():
    local_map = map_after(wall(2.015, 1.0))
    local_map.follow(3.0, -2.0)
    assert box_at(local_map, 2.025, 0.02)[:2] == pytest.approx((2.015, 2.015), abs=1e-5)
    other = local_map.moved_onto(0.04, (0.0, 0.0))
    half = 0.04 / math.sqrt(2.0)
    assert box_at(other, 2.025, 0.02)[:2] == pytest.approx((2.02 - half, 2.02 + half), abs=1e-5)


def test_a_gap_in_the_field_of_view_stays_unseen():
    local_map = map_after(scan(2.0, fov=math.radians(270)))
    assert state(local_map, 1.0, 0.0) == SEEN_FREE
    assert state(local_map, -1.0, 0.02) == UNSEEN


def test_the_window_moves_along_and_keeps_what_it_knows():
    local_map = map_after(scan(2.0))
    local_map.follow(3.0, -2.0)
    local_map.update(1.0, nothing(local_map))
    assert state(local_map, 1.5, 0.02) == SEEN_FREE
    assert local_map.origin[0] == pytest.approx(3.0 - 6.0, abs=0.051)


def test_the_disc_at_the_start_is_free_where_neither_map_nor_scan_shows_anything():
    local_map = LocalMap()
    local_map.follow(0.0, 0.0)
    mapped = nothing(local_map)
    row, column = index(local_map, 0.11, 0.01)
    mapped[row : row + 2, column : column + 2] = True
    behind = np.where(np.abs(np.arange(N) - N // 2) < N // 4, np.inf, 0.2)
    view = placed(scan(behind), Pose2D(0.0, 0.0, 0.0), (0.0, 0.0), 0.1)
    local_map.see(view._replace(free=np.zeros(N)), np.zeros(len(view.points), bool))
    local_map.assume_free((0.0, 0.0, 0.3), 1.0, mapped)
    local_map.update(1.0, nothing(local_map))
    assert state(local_map, -0.12, 0.0) == SEEN_FREE
    assert state(local_map, -0.27, 0.0) == SEEN_FREE
    assert state(local_map, -0.19, 0.01) == SEEN_OCCUPIED
    assert state(local_map, 0.14, 0.06) == UNSEEN
    assert state(local_map, 0.4, 0.0) == UNSEEN


def test_keepout_is_closed_though_seen_free():
    local_map = LocalMap()
    local_map.follow(0.0, 0.0)
    view = placed(scan(np.inf), Pose2D(0.0, 0.0, 0.0), (0.0, 0.0), 0.1)
    local_map.see(view, np.empty(0, bool))
    barred, cell = nothing(local_map), index(local_map, 1.71, 0.01)
    barred[cell] = True
    local_map.update(1.0, barred)
    assert local_map.states[cell] == SEEN_FREE
    assert local_map.open[cell] == 0
    assert local_map.open[index(local_map, 1.61, 0.01)] == 1


@pytest.mark.parametrize("corner", [(0.0, 0.0), (0.013, -7.031), (1e5, 2.0)])
def test_the_window_lies_on_the_cells_of_any_lattice(corner):
    local_map = LocalMap(LocalMapConfig(size=4.0), 0.05, corner)
    for x, y in ((0.0, 0.0), (0.3, -0.2), (5.01, 3.0), (4.2, -2.3)):
        local_map.follow(x, y)
        columns, rows = (np.array(local_map.origin) - corner) / 0.05
        assert (columns, rows) == pytest.approx((local_map.column0, local_map.row0), abs=1e-5)
        assert local_map.row0 % 2 == local_map.column0 % 2 == 0
        middle = np.array(local_map.origin) + 2.0
        assert np.abs(middle - (x, y)).max() < 4.0 / 12 + 0.15


@pytest.mark.parametrize(
    ("resolution", "corner", "same"),
    [
        (0.05, (0.35, -12.0), True),
        (0.05, (0.376, -12.0), False),
        (0.05, (0.0, 0.02), False),
        (0.025, (0.0, 0.0), False),
        (float(np.float32(0.05)), (0.0, 0.0), True),
    ],
)
def test_a_lattice_is_the_same_if_its_cells_are(resolution, corner, same):
    assert LocalMap().lies_on(resolution, corner) == same


def overlaps_hit(local, centre, resolution):
    """Whether the box of a hit reaches into a cell of another lattice."""
    a, half = local.resolution, 0.5 * resolution
    for row, column in np.argwhere(local.states == SEEN_OCCUPIED):
        box = local.boxes[row, column]
        x, y = np.array(local.origin) + (np.array([column, row]) + 0.5) * a - centre
        across = x + box["low_x"] < half and x + box["high_x"] >= -half
        if across and y + box["low_y"] < half and y + box["high_y"] >= -half:
            return True
    return False


@pytest.mark.parametrize(
    ("resolution", "corner"), [(0.05, (0.02, -3.01)), (0.03, (1.0, 7.7)), (0.08, (0.01, 0.02))]
)
def test_a_window_on_another_lattice_shows_what_the_old_one_showed(resolution, corner):
    ranges = np.random.default_rng(3).uniform(1.0, 4.0, 12).repeat(N // 12)
    before = map_after(scan(ranges), pose=Pose2D(20.0, 10.0, 0.0))
    after = before.moved_onto(resolution, corner)
    assert after.lies_on(resolution, corner)
    after.update(1.0, nothing(after))
    for x, y in np.random.default_rng(4).uniform((16.0, 6.0), (24.0, 14.0), (200, 2)):
        row, column = index(after, x, y)
        centre = np.array(after.origin) + (np.array([column, row]) + 0.5) * resolution
        hit, state = overlaps_hit(before, centre, resolution), after.states[row, column]
        assert (state == SEEN_OCCUPIED) == hit
        if not hit and before.states[index(before, *centre)] != SEEN_OCCUPIED:
            assert state == before.states[index(before, *centre)]
    assert (after.states == SEEN_OCCUPIED).sum() > 100


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
    beams = angle_min, increment, n, full
    layers = free_at, np.zeros(free_at.shape, np.uint8)
    mark_free(layers, (0.05, 0.0, 0.0), gaps, Sensor(7.0, *sensor, *beams), 1)
    rows, columns = np.indices(free_at.shape)
    centres = np.column_stack([columns.ravel() * 0.05 + 0.025, rows.ravel() * 0.05 + 0.025])
    free, past, at_end = observed_free(gaps, angle_min, increment, full, sensor, centres)
    found = free_at.ravel() == 7.0
    assert (found == free)[(past > 1e-6) & ~at_end].all()
    assert (past > 1e-6).mean() > 0.8


def test_a_cell_that_was_forgotten_is_not_free_because_the_robot_comes_back():
    """Behind a lidar that looks ahead: a cell stays free while the robot stands by it, not afterwards."""
    local, disc = map_after(scan(3.0), pose=Pose2D(20.0, 10.0, 0.0)), (20.0, 10.0, 0.5)
    memory = local.config.memory
    for now in (10.0, 10.0 + 0.9 * memory):
        local.keep_free(disc, now)
        local.update(now, nothing(local))
        assert local.states[index(local, 20.3, 10.0)] == SEEN_FREE
    late = 10.0 + 3.0 * memory
    local.keep_free(disc, late)  # after a long time without data: the robot has not moved
    local.update(late, nothing(local))
    assert local.states[index(local, 20.3, 10.0)] == SEEN_FREE
    away = late + 2.0 * memory
    local.update(away, nothing(local))
    local.keep_free(disc, away + 1.0)
    local.update(away + 1.0, nothing(local))
    assert local.states[index(local, 20.3, 10.0)] == UNSEEN


def test_a_scan_that_comes_late_makes_nothing_older():
    local = map_after(scan(3.0), pose=Pose2D(20.0, 10.0, 0.0))
    stamps = local.free_at.copy(), local.hit_at.copy()
    local.see(
        placed(scan(3.0, stamp=0.5), Pose2D(20.0, 10.0, 0.0), (0.0, 0.0), 0.1), np.zeros(N, bool)
    )
    assert (local.free_at >= stamps[0]).all()
    assert (local.hit_at >= stamps[1]).all()

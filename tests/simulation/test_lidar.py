import math
from time import process_time

import numpy as np
import pytest
import shapely
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from dynastar.geometry import Pose2D
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.robot import Lidar
from dynastar.simulation import lidar_kernels as kernels
from dynastar.simulation.imperfections import LidarDriver, Post
from dynastar.simulation.lidar import LidarSimulator, free_cells

SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def solid(grid, obstacles, discs, grown):
    """Everything solid as one shape, each part grown by ``grown`` metres."""
    corners = [(0, 0), (0, grid.columns), (grid.rows, grid.columns), (grid.rows, 0)]
    inside = shapely.Polygon(grid.frame.points_to_world(corners))
    parts = [inside.buffer(100.0) - inside.buffer(-grown, join_style="mitre")]
    for row, column in np.argwhere(grid.occupied):
        cell = shapely.Polygon(grid.frame.points_to_world(np.array(corners_of(row, column))))
        parts.append(cell.buffer(grown, join_style="mitre"))
    parts += [shapely.Polygon(ring).buffer(grown) for ring in obstacles]
    parts += [shapely.Point(x, y).buffer(radius + grown, quad_segs=500) for x, y, radius in discs]
    return shapely.union_all(parts)


def corners_of(row, column):
    return [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)]


def naive_range(shape, x, y, angle, range_max):
    far = (x + range_max * math.cos(angle), y + range_max * math.sin(angle))
    hit = shapely.LineString([(x, y), far]).intersection(shape)
    return math.inf if hit.is_empty else shapely.Point(x, y).distance(hit)


@settings(max_examples=60)
@given(seed=st.integers(0, 10**6))
def test_beams_end_where_shapely_says(seed):
    random = np.random.default_rng(seed)
    shape = random.integers(2, 16, 2)
    frame = GridFrame(
        random.uniform(0.2, 1.0), *random.uniform(-3.0, 3.0, 2), random.uniform(-4, 4)
    )
    grid = OccupancyGrid(random.random(shape) < random.choice([0.02, 0.1, 0.3]), frame)
    place = lambda: np.array(grid.frame.to_world(*(random.random(2) * shape)))  # noqa: E731
    obstacles = [place() + random.uniform(0.1, 1.0) * SQUARE for _ in range(random.integers(3))]
    discs = np.array([(*place(), random.uniform(0.1, 0.5)) for _ in range(random.integers(3))])
    discs = discs.reshape(-1, 3)
    at = place()
    larger = solid(grid, obstacles, discs, 1e-4)
    smaller = solid(grid, obstacles, discs, -1e-4)
    assume(not larger.contains(shapely.Point(at)))
    pose = Pose2D(*at, random.uniform(-4, 4))
    lidar = Lidar(24, math.tau, 0.0, random.uniform(0.5, 12.0))
    scan = LidarSimulator(lidar, grid, obstacles).scan(pose, 0.0, discs)
    for angle, measured in zip(scan.angles + pose.theta, scan.ranges, strict=True):
        low = naive_range(larger, *at, angle, lidar.range_max + 1e-3)
        high = naive_range(smaller, *at, angle, lidar.range_max - 1e-3)
        assert low - 1e-6 <= measured <= high + 1e-6


def room(resolution=0.5, **frame):
    return OccupancyGrid(np.zeros((20, 20), bool), GridFrame(resolution, **frame))


def ahead(scan):
    return scan.ranges[len(scan.ranges) // 2]


def test_the_border_is_a_wall():
    scan = LidarSimulator(Lidar(4, math.tau, 0.0, 50.0), room()).scan(Pose2D(4.0, 3.0), 1.5)
    np.testing.assert_allclose(scan.ranges, [4.0, 3.0, 6.0, 7.0], rtol=1e-6)
    assert scan.stamp == 1.5
    assert scan.fault() is None


def test_the_mount_counts():
    lidar = Lidar(3, 1.0, 0.0, 50.0, x=0.5, y=0.25, theta=math.pi / 2)
    scan = LidarSimulator(lidar, room()).scan(Pose2D(4.0, 3.0, math.pi / 2), 0.0)
    assert scan.ranges[1] == pytest.approx(4.0 - 0.25)
    assert scan.mount == lidar.mount


def test_a_yawed_map_is_hit_where_it_lies():
    occupied = np.zeros((20, 20), bool)
    occupied[10, 15] = True
    grid = OccupancyGrid(occupied, GridFrame(0.5, 2.0, 1.0, math.pi / 2))
    x, y = grid.frame.to_world(10.5, 5.5)
    scan = LidarSimulator(Lidar(4), grid).scan(Pose2D(x, y, math.pi / 2), 0.0)
    assert ahead(scan) == pytest.approx(9.5 * 0.5)


def test_unknown_cells_are_not_solid_and_beyond_range_is_inf():
    grid = OccupancyGrid(np.full((20, 20), -1), GridFrame(0.5))
    simulator = LidarSimulator(Lidar(8, math.tau, 0.0, 3.0), grid)
    assert np.isinf(simulator.scan(Pose2D(5.0, 5.0), 0.0).ranges).all()


def test_readings_below_range_min_are_given_and_absent_movers_are_not_seen():
    simulator = LidarSimulator(Lidar(8, math.tau, 0.5, 3.0), room())
    discs = np.array([[5.5, 5.0, 0.3], [math.nan, math.nan, 0.3]])
    scan = simulator.scan(Pose2D(5.0, 5.0), 0.0, discs)
    assert ahead(scan) == pytest.approx(0.2)
    assert np.isinf(np.delete(scan.ranges, 4)).all()


def test_a_sensor_inside_something_reads_nothing_useful():
    grid = OccupancyGrid.from_occupied(np.eye(4))
    simulator = LidarSimulator(Lidar(8), grid)
    assert (simulator.scan(Pose2D(0.5, 0.5), 0.0).ranges == 0.0).all()
    assert (simulator.scan(Pose2D(9.0, 0.5), 0.0).ranges == 0.0).all()


def test_beams_span_the_field_of_view():
    lidar = Lidar(5, math.pi, 0.0, 5.0)
    scan = LidarSimulator(lidar, room()).scan(Pose2D(5.0, 5.0), 0.0)
    np.testing.assert_allclose(scan.angles, np.linspace(-math.pi / 2, math.pi / 2, 5))


def test_noise_keeps_its_bound_and_its_seed():
    lidar, pose = Lidar(360, math.tau, 0.0, 6.0), Pose2D(4.0, 3.0)
    exact = LidarSimulator(lidar, room()).scan(pose, 0.0).ranges

    def noisy(seed):
        random = np.random.default_rng(seed)
        return LidarSimulator(lidar, room(), (), 0.05, random).scan(pose, 0.0).ranges

    seen = np.isfinite(exact)
    error = noisy(1)[seen] - exact[seen]
    assert np.isinf(noisy(1)[~seen]).all()
    assert 0.02 < np.abs(error).max() <= 0.05 + 1e-6
    assert 0.015 < error.std() < 0.03
    np.testing.assert_array_equal(noisy(1), noisy(1))
    assert (noisy(1) != noisy(2)).any()


def test_beams_leap_over_free_cells():
    random = np.random.default_rng(0)
    occupied = random.random((500, 800)) < 0.002
    occupied[245:255, 395:405] = False
    grid = OccupancyGrid(occupied, GridFrame(0.05))
    lidar = Lidar(720, math.tau, 0.0, 30.0)
    sensor = (*grid.frame.to_world(250, 400)[:2], 0.0)
    leaping = free_cells(grid)

    def scanned(free):
        ranges = np.empty(lidar.beams)
        edges, discs, frame = np.empty((0, 4)), np.empty((0, 3)), tuple(map(float, grid.frame))
        began = process_time()
        kernels.cast(free, frame, edges, discs, sensor, (lidar.increment, 30.0), ranges)
        return process_time() - began, ranges

    stepping = np.minimum(leaping, 1)
    np.testing.assert_allclose(scanned(leaping)[1], scanned(stepping)[1], atol=1e-9)
    least, stepped = (min(scanned(free)[0] for _ in range(20)) for free in (leaping, stepping))
    assert least < 0.6 * stepped


# -- what the driver makes of a scan --------------------------------------------------------------

HALL = OccupancyGrid.from_occupied(np.zeros((40, 40), bool), 0.5)
MIDDLE = Pose2D(10.0, 10.0, 0.3)


def scanned(lidar=Lidar(360, math.tau, 0.0, 12.0), pose=MIDDLE, range_bound=0.0, **driver):
    made = LidarSimulator(lidar, HALL, (), range_bound, driver=LidarDriver(**driver))
    return made.scan(pose, 0.0)


@pytest.mark.parametrize("nothing", [0.0, 12.0, 65.5, -1.0, math.inf, math.nan])
def test_the_driver_writes_its_own_value_for_nothing(nothing):
    true, scan = scanned(), scanned(nothing=nothing)
    empty = np.isinf(true.ranges)
    assert 0 < empty.sum() < 360
    np.testing.assert_array_equal(scan.ranges[empty], np.float32(nothing))
    np.testing.assert_array_equal(scan.ranges[~empty], true.ranges[~empty])


@pytest.mark.parametrize("fov", [math.tau, math.radians(270.0)])
def test_the_number_of_readings_changes_and_each_points_where_it_says(fov):
    made = LidarSimulator(Lidar(360, fov, 0.0, 12.0), HALL, driver=LidarDriver(readings=(223, 240)))
    counts = set()
    for _ in range(200):
        scan = made.scan(MIDDLE, 0.0)
        counts.add(len(scan.ranges))
        full = Lidar(len(scan.ranges), fov, 0.0, 12.0)
        assert scan.angle_increment == full.increment
        np.testing.assert_array_equal(
            scan.ranges, LidarSimulator(full, HALL).scan(MIDDLE, 0.0).ranges
        )
    assert counts == set(range(223, 241))


def test_posts_hide_what_is_behind_them():
    posts = (Post(math.pi / 2, 0.16, 3), Post(-math.pi, 0.2), Post(0.0, 5.0, 2))
    at_wall = Pose2D(1.0, 10.0, math.pi)
    true, scan = scanned(pose=at_wall), scanned(pose=at_wall, posts=posts)
    changed = np.flatnonzero(scan.ranges != true.ranges)
    np.testing.assert_array_equal(changed, [0, 269, 270, 271])
    np.testing.assert_allclose(scan.ranges[changed], [0.2, 0.16, 0.16, 0.16], atol=1e-6)


def test_posts_out_of_view_are_not_seen():
    narrow = Lidar(91, math.radians(90.0), 0.0, 5.0)
    hidden = scanned(narrow, posts=(Post(math.pi, 0.2, 5), Post(0.9, 0.2)))
    assert np.isinf(hidden.ranges).all()
    seen = np.flatnonzero(np.isfinite(scanned(narrow, posts=(Post(-math.pi / 4, 0.2),)).ranges))
    np.testing.assert_array_equal(seen, [0])


def test_ranges_are_rounded_after_their_error():
    scan = scanned(range_bound=0.02, rounding=0.25)
    finite = scan.ranges[np.isfinite(scan.ranges)]
    np.testing.assert_array_equal(finite % 0.25, 0.0)
    assert np.abs(finite - scanned().ranges[np.isfinite(scan.ranges)]).max() <= 0.125 + 0.02 + 1e-6

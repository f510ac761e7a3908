import itertools
import math
import time

import numpy as np
import pytest
from hypothesis import assume, given, reject, settings
from hypothesis import strategies as st

from dynastar.clearance import inflate
from dynastar.errors import NoPath
from dynastar.planning import SearchGrid, segment_clear, smooth
from dynastar.planning.segments import CellPoint
from dynastar.planning.taut_kernel import edge
from naive import clearance, slips_through


def length(points):
    return np.hypot(*np.diff(points, axis=0).T).sum()


def searched(seed, radius):
    """A map (24, 30) and the improved A*'s way over it for a disc, between cells drawn by chance."""
    rng = np.random.default_rng(seed)
    blocked = rng.random((24, 30)) < (0.25 if radius < 0.5 else 0.03)
    inflated = inflate(blocked, radius)
    free = np.argwhere(~inflated)
    assume(len(free) > 0)
    start, goal = (tuple(map(int, free[i])) for i in rng.integers(0, len(free), 2))
    try:
        return blocked, SearchGrid(inflated).search(start, goal, "improved").cells + 0.5
    except NoPath:
        reject()


@given(st.integers(0, 10**9), st.sampled_from([0.2, 0.5, 1.0, 1.3, 2.5]))
@settings(max_examples=200, deadline=None)
def test_a_disc_is_stopped_by_squares_nearer_than_its_radius(seed, radius):
    rng = np.random.default_rng(seed)
    rows, columns = rng.integers(3, 12, 2)
    blocked = rng.random((rows, columns)) < 0.1
    a, b = rng.uniform(0, [rows, columns], (2, 2))
    if seed % 3 == 0:
        a, b = np.floor(a) + 0.5, np.floor(b) + 0.5
    gap = clearance(blocked, [a, b])
    assert gap < 1e-8 or segment_clear(blocked, a, b, gap)
    assert segment_clear(blocked, a, b, radius) == (gap >= radius - 1e-9)
    assert not segment_clear(blocked, a, b, gap + 1e-6)


@given(st.integers(0, 10**9))
@settings(max_examples=300, deadline=None)
def test_a_point_does_not_slip_through(seed):
    rng = np.random.default_rng(seed)
    rows, columns = rng.integers(2, 8, 2)
    blocked = rng.random((rows, columns)) < 0.25
    half_cells = rng.integers(0, [2 * rows + 1, 2 * columns + 1], (2, 2)) / 2.0
    a, b = half_cells
    if (a == b).all() or slips_on_the_edge(a, b, blocked.shape):
        return
    assert segment_clear(blocked, a, b, 0.0) != slips_through(blocked, a, b)


def slips_on_the_edge(a, b, shape):
    """Whether a segment touches the map's edge, where the oracle's outside and ours differ."""
    return bool((np.minimum(a, b) <= 0).any() or (np.maximum(a, b) >= shape).any())


def test_corners_and_seams():
    single = np.array([[0, 1], [0, 0]], dtype=bool)
    joint = np.array([[0, 1], [1, 0]], dtype=bool)
    seam = np.ones((2, 2), dtype=bool)
    assert segment_clear(single, (0.5, 0.5), (1.5, 1.5), 0.0)
    assert not segment_clear(joint, (0.5, 0.5), (1.5, 1.5), 0.0)
    assert not segment_clear(seam, (0.0, 1.0), (2.0, 1.0), 0.0)
    assert segment_clear(single, (0.0, 1.0), (1.0, 1.0), 0.0)


@given(st.integers(0, 10**9), st.sampled_from([0.0, 0.3, 0.7, 1.5, 2.2]), st.booleans())
@settings(max_examples=150, deadline=None)
def test_a_smoothed_path_is_shorter_and_as_clear(seed, radius, rounded):
    blocked, points = searched(seed, radius)
    smoothed = smooth(blocked, points, radius, 3.0 if rounded else 0.0)
    assert (smoothed[0] == points[0]).all()
    assert (smoothed[-1] == points[-1]).all()
    assert length(smoothed) <= length(points) + 1e-9
    for line in (points, smoothed):
        assert radius == 0.0 or clearance(blocked, line) >= radius - 1e-9
        for a, b in itertools.pairwise(line):
            assert segment_clear(blocked, a, b, radius)


def test_the_string_is_taut_round_a_wall():
    blocked = np.zeros((40, 60), dtype=bool)
    blocked[:30, 30] = True
    points = SearchGrid(blocked).search((15, 5), (15, 55)).cells + 0.5
    best = math.hypot(14.5, 24.5) + 1.0 + math.hypot(14.5, 24.5)
    assert length(points) > 1.03 * best
    assert length(smooth(blocked, points, 0.0)) == pytest.approx(best, abs=1e-5)
    assert length(smooth(blocked, points, 0.0, 3.0)) == pytest.approx(best, abs=1e-5)


@pytest.mark.parametrize("radius", [1.5, 4.0, 7.3])
def test_a_disc_goes_round_a_block_on_tangents_and_hardly_more(radius):
    blocked = np.zeros((40, 60), dtype=bool)
    blocked[:20, 30] = True
    points = SearchGrid(inflate(blocked, radius)).search((10, 10), (10, 50)).cells + 0.5
    away = math.hypot(19.5, 9.5)  # from start and goal to the block's upper corners
    tangent = math.sqrt(away**2 - radius**2)
    turned = math.atan2(9.5, 19.5) + math.asin(radius / away)  # off the level, at each corner
    best = 2.0 * (tangent + radius * turned) + 1.0
    assert best - 1e-9 <= length(smooth(blocked, points, radius)) <= 1.01 * best


@given(st.integers(0, 10**9), st.sampled_from([0.0, 0.7, 2.2]))
@settings(max_examples=80, deadline=None)
def test_no_corner_of_a_taut_string_can_be_cut(seed, radius):
    blocked, points = searched(seed, radius)
    line = smooth(blocked, points, radius)
    for a, b, c in zip(line, line[1:], line[2:], strict=False):
        cosine = np.dot(b - a, c - b) / (math.dist(a, b) * math.dist(b, c))
        half = 0.5 * math.acos(max(min(cosine, 1.0), -1.0))
        round_it = 2.0 * radius * (math.tan(half) - half)  # what an arc would save
        for before, after in itertools.product((0.1, 0.3, 1.0), repeat=2):
            p, q = b + before * (a - b), b + after * (c - b)
            saved = math.dist(p, b) + math.dist(b, q) - math.dist(p, q)
            steps = math.ceil(4.0 * max(math.dist(p, b), math.dist(b, q)))  # nothing lies between
            swept = [
                (b + i / steps * (p - b), b + i / steps * (q - b)) for i in range(1, steps + 1)
            ]
            if saved >= 0.02 + round_it:
                assert not all(segment_clear(blocked, *cut, radius) for cut in swept)


def test_rounding_makes_a_corner_gentler():
    blocked = np.zeros((60, 60), dtype=bool)
    blocked[:40, 28:32] = True
    points = SearchGrid(inflate(blocked, 5.0)).search((10, 10), (10, 50)).cells + 0.5

    def sharpest(line):
        steps = np.diff(line, axis=0)
        return np.abs(np.diff(np.unwrap(np.arctan2(steps[:, 0], steps[:, 1])))).max()

    assert sharpest(smooth(blocked, points, 5.0, 4.0)) < sharpest(smooth(blocked, points, 5.0))


def test_short_paths_stay_as_they_are():
    blocked = np.zeros((3, 3), dtype=bool)
    assert smooth(blocked, [[0.5, 0.5]], 0.0).tolist() == [[0.5, 0.5]]
    assert smooth(blocked, [[0.5, 0.5], [2.5, 1.5]], 0.0).tolist() == [[0.5, 0.5], [2.5, 1.5]]


@pytest.mark.parametrize("radius", [0.0, 0.5, 8.0])
def test_a_few_points_may_become_many_round_something_round(radius):
    y, x = np.mgrid[:200, :200] + 0.5
    blocked = np.hypot(y - 100.0, x - 100.0) < 60.0
    far = 1.2 * (62.0 + radius)
    low, high = 100.0 - far / 1.2, 100.0 + far / 1.2
    points = np.array([(low, 100.0 - far), (low, high), (100.0 + far, high)])
    smoothed = smooth(blocked, points, radius)
    assert length(smoothed) < 0.95 * length(points)
    assert len(smoothed) > 8
    for a, b in itertools.pairwise(smoothed):
        assert segment_clear(blocked, a, b, radius)


def test_a_string_that_goes_there_and_back_round_a_corner_is_let_go():
    blocked = np.zeros((10, 20), dtype=bool)
    blocked[4, 10] = True
    points = [(2.5, 9.5), (2.5, 11.5), (6.5, 11.5), (2.5, 11.8), (2.5, 13.5)]
    assert length(smooth(blocked, points, 0.0)) == pytest.approx(4.0)


@pytest.mark.slow
def test_twice_the_bends_in_the_open_take_hardly_more_than_twice_the_time():
    def seconds(n):
        steps = np.arange(n)
        line = np.column_stack([(steps + 1) // 2, steps // 2]) + 10.5
        blocked = np.zeros((n + 20, n + 20), dtype=bool)
        times = []
        for _ in range(3):
            began = time.process_time()
            assert len(smooth(blocked, line, 3.0)) == 2
            times.append(time.process_time() - began)
        return min(times)

    seconds(100)
    assert seconds(3000) < 8.0 * seconds(1000)


@given(st.integers(0, 10**9), st.sampled_from([0.0, 0.4, 2.0]))
@settings(max_examples=200, deadline=None)
def test_no_corner_near_a_triangle_is_overlooked(seed, radius):
    """A string's bend is sought among rows and columns that hold the triangle and all near to it."""
    rng = np.random.default_rng(seed)
    a, b, c = corners = rng.integers(0, 41, (3, 2)) / rng.choice([1.0, 2.0, 3.0])
    twice_area = (b - a)[1] * (c - a)[0] - (b - a)[0] * (c - a)[1]
    assume(abs(twice_area) > 1e-9)
    side = float(np.sign(twice_area))
    shares = rng.dirichlet(np.ones(3) * rng.choice([0.1, 1.0]), 200)
    turn = rng.uniform(0.0, 2.0 * np.pi, 200)
    ring = rng.choice([0.0, radius], (200, 1)) * np.column_stack([np.sin(turn), np.cos(turn)])
    y, x = (shares @ corners + ring).T
    for (ey, ex), (oy, ox) in ((a, b), (b, c), (c, a)):
        slope, lowest, highest = edge(CellPoint(ey, ex), CellPoint(oy, ox), side, radius + 1e-6)
        on = ex + slope * (y - ey)
        assert ((x >= on + lowest) & (x <= on + highest)).all()
    further = 2.0 * radius + 1.0
    across = (b - a)[::-1] * [1.0, -1.0] / np.hypot(*(b - a))  # at right angles to a - b, and out
    away = 0.5 * (a + b) + further * across * (1.0 if across @ (c - a) < 0.0 else -1.0)
    slope, lowest, highest = edge(CellPoint(*a), CellPoint(*b), side, radius)
    on = a[1] + slope * (away[0] - a[0])
    assert a[0] == b[0] or not on + lowest <= away[1] <= on + highest


@pytest.mark.parametrize("wrong", [math.nan, math.inf])
def test_what_is_not_finite_is_refused(wrong):
    blocked = np.zeros((9, 9), bool)
    way = [[0.5, 0.5], [0.5, wrong], [8.5, 8.5]]
    with pytest.raises(ValueError, match=r"has the point .*(nan|inf).*: expected finite numbers"):
        smooth(blocked, way, 0.0)
    way[1][1] = 8.5
    for numbers in ((wrong, 0.0), (0.0, wrong), (-1.0, 0.0)):
        with pytest.raises(ValueError, match="radius and rounding are"):
            smooth(blocked, way, *numbers)

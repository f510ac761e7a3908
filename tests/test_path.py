import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from dynastar.errors import InputError
from dynastar.path import Path, Trajectory, bends, turning_points

coordinate = st.floats(-50, 50).map(lambda x: round(x, 3))
polylines = st.lists(st.tuples(coordinate, coordinate), min_size=1, max_size=12)


def nearest_gap(path: Path, x: float, y: float) -> float:
    """Distance to a path by trying every half a per cent of every segment."""
    share = np.linspace(0.0, 1.0, 201)[:, None]
    if len(path.points) == 1:
        return float(np.hypot(*(path.points[0] - (x, y))))
    tried = [a + share * (b - a) for a, b in zip(path.points[:-1], path.points[1:], strict=True)]
    return float(np.hypot(*(np.concatenate(tried) - (x, y)).T).min())


@given(polylines)
def test_arc_starts_at_zero_never_falls_and_ends_at_the_length(points):
    path = Path(points)
    assert path.arc[0] == 0.0
    assert (np.diff(path.arc) >= 0.0).all()
    assert path.length == pytest.approx(path.arc[-1])
    assert path.length >= np.hypot(*(path.points[-1] - path.points[0])) - 1e-9


@pytest.mark.parametrize("points", ["ab", [("a", "b")], None, [(0, 0), (1,)], [(10**400, 0)], 3.0])
def test_what_is_not_a_list_of_points_is_refused(points):
    with pytest.raises(InputError, match="a path"):
        Path(points)


def test_length_and_at():
    path = Path([(0, 0), (3, 0), (3, 4)])
    assert path.length == pytest.approx(7.0)
    assert path.at(5.0) == pytest.approx((3.0, 2.0))
    assert path.at(-1.0) == (0.0, 0.0)
    assert path.at(99.0) == (3.0, 4.0)


@given(polylines, st.floats(0, 1))
def test_a_point_on_the_path_projects_onto_itself(points, share):
    path = Path(points)
    x, y = path.at(share * path.length)
    assert path.at(path.project(x, y)) == pytest.approx((x, y), abs=1e-6)


@given(polylines, coordinate, coordinate)
def test_projection_is_the_nearest_point(points, x, y):
    path = Path(points)
    foot = path.at(path.project(x, y))
    gap = np.hypot(foot[0] - x, foot[1] - y)
    assert gap <= nearest_gap(path, x, y) + 1e-6


@given(polylines, coordinate, coordinate, st.floats(0, 1), st.floats(0, 1))
def test_projection_stays_between_its_bounds(points, x, y, a, b):
    path = Path(points)
    low, high = sorted((a * path.length, b * path.length))
    s = path.project(x, y, low, high)
    assert low - 1e-9 <= s <= high + 1e-9
    gap = np.hypot(path.at(s)[0] - x, path.at(s)[1] - y)
    for other in np.linspace(low, high, 50):
        assert gap <= np.hypot(path.at(other)[0] - x, path.at(other)[1] - y) + 1e-6
    assert path.project(x, y, path.length + 1.0, path.length + 2.0) == pytest.approx(path.length)


@given(polylines, st.floats(0.05, 5.0))
def test_resampled_keeps_ends_and_spacing(points, spacing):
    path = Path(points)
    assume(path.length / spacing < 5000)
    sampled = path.resampled(0.0, path.length, spacing)
    assert len(sampled) >= 2
    assert sampled[[0, -1]] == pytest.approx(path.points[[0, -1]])
    assert np.hypot(*np.diff(sampled, axis=0).T).max() <= spacing + 1e-9


def test_turning_points_of_known_lines():
    assert turning_points([(0, 0)]) == 0
    assert turning_points([(0, 0), (5, 0), (10, 0)]) == 0
    assert turning_points([(0, 0), (5, 0), (5, 5), (10, 5)]) == 2
    assert turning_points([(0, 0), (5, 0), (10, 0.8)]) == 0  # 9.1 degrees
    assert turning_points([(0, 0), (5, 0), (10, 1.0)]) == 1  # 11.3 degrees
    assert turning_points([(0, 0), (5, 0), (0, 0.5)]) == 1  # turns back
    assert turning_points([(0, 0), (2, 0.1), (4, -0.1), (6, 0)]) == 0  # within 0.25 m


@given(polylines, st.sampled_from([-8.0, 0.0, 64.0]), st.sampled_from([-8.0, 0.0, 64.0]))
def test_turning_points_do_not_depend_on_where_the_map_begins(points, x, y):
    line = np.round(np.array(points, dtype=float) * 64) / 64  # so that the shift is exact
    assert turning_points(line) == turning_points(line + np.array([x, y]))


def test_a_dense_copy_of_a_line_has_the_same_turning_points():
    corners = Path([(0, 0), (6, 0), (6, 6), (12, 6)])
    assert turning_points(corners.resampled(0.0, corners.length, 0.05)) == corners.turns == 2


@pytest.mark.parametrize("points", [[], [(0.0, np.nan)], [(np.inf, 0.0)]])
def test_a_path_needs_finite_points(points):
    with pytest.raises(InputError, match=r"finite|shape"):
        Path(points)


def test_a_path_is_read_only():
    path = Path([(0, 0), (1, 1)])
    with pytest.raises(ValueError, match="read-only"):
        path.points[0, 0] = 1.0


def test_a_trajectory_knows_its_length():
    poses = np.array([(0, 0, 0), (3, 4, 1)], dtype=float)
    driven = Trajectory(np.array([0.0, 1.0]), poses, np.zeros((2, 2)))
    assert driven.length == pytest.approx(5.0)
    assert driven.path.points == pytest.approx(poses[:, :2])


@given(st.floats(0.0, 5.0), st.floats(0.0, 20.0), st.floats(0.05, 1.0))
def test_paced_points_are_equally_far_apart_along_the_path_up_to_its_end(start, span, spacing):
    path = Path([(0.0, 0.0), (3.0, 0.0), (3.0, 4.0)])
    points = path.paced(start, start + span, spacing)
    stop = min(start + span, path.length)
    for k, point in enumerate(points):
        assert point == pytest.approx(path.at(min(start + k * spacing, stop)), abs=1e-9)
    assert points[-1] == pytest.approx(path.at(stop), abs=1e-6)
    assert len(points) <= max(2.0, span / spacing + 2.0)


@given(polylines)
def test_bends_are_corners_of_the_line_and_as_many_as_its_turning_points(points):
    corners = bends(points)
    assert len(corners) == turning_points(points)
    line = np.asarray(points, dtype=float)
    for corner in corners:
        assert np.hypot(*(line - corner).T).min() < 1e-3


def test_a_staircase_bends_where_it_turns():
    line = [(0.0, 0.0), (2.0, 0.0), (2.0, 3.0), (2.0, 5.0), (5.0, 5.0)]
    assert bends(line) == pytest.approx(np.array([(2.0, 0.0), (2.0, 5.0)]))


@given(polylines, st.floats(0.0, 1.0), st.floats(0.0, 1.0))
def test_a_part_has_the_bends_of_the_path(points, begin, end):
    path = Path(points)
    start, stop = sorted((begin * path.length, end * path.length))
    part = Path(path.part(start, stop))
    assert part.length == pytest.approx(stop - start, abs=1e-6 * (1.0 + path.length))
    assert part.points[0] == pytest.approx(path.at(start))
    assert part.points[-1] == pytest.approx(path.at(stop))

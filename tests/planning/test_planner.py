import math

import numpy as np
import pytest

from dynastar.errors import ConfigError, GoalOccupied, InputError, NoPath, OutOfMap, StartOccupied
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.planning import ALGORITHMS, GridPlanner, PlannerConfig, SearchGrid, plan
from naive import clearance

ROOM = """
....................
....................
....................
....................
..........#.........
..........#.........
..........#.........
..........#.........
..........#.........
..........#.........
"""


def room(resolution=0.1):
    return OccupancyGrid.from_text(ROOM, resolution)


@pytest.mark.parametrize("planner", list(ALGORITHMS))
@pytest.mark.parametrize("radius", [0.0, 0.05, 0.08])
def test_a_plan_goes_from_start_to_goal(planner, radius):
    start, goal = (0.33, 0.21), (1.72, 0.18)
    made = plan(room(), start, goal, planner, radius, explored=True)
    assert made.planner == planner
    assert made.radius == radius
    for path in (made.path, made.grid_path):
        assert tuple(path.points[0]) == start
        assert tuple(path.points[-1]) == goal
        cells = room().frame.points_to_grid(path.points)
        assert clearance(room().blocked(), cells) >= radius / 0.1 - 1e-6
    assert made.path.length < made.grid_path.length
    assert len(made.explored) == made.expanded
    assert made.clear_from == 0.0
    assert made.time_ms > 0.0
    assert made.cost == pytest.approx(made.grid_path.length / 0.1, abs=1.5)


def test_a_turned_map_turns_the_plan():
    frame = GridFrame(0.1, 3.0, -2.0, 0.7)
    turned = OccupancyGrid(room().values, frame)
    start, goal = (0.33, 0.21), (1.72, 0.18)
    ends = [frame.to_world(y / 0.1, x / 0.1) for x, y in (start, goal)]
    expected = plan(room(), start, goal).path
    assert plan(turned, *ends).path.length == pytest.approx(expected.length)


def test_without_smoothing_the_path_is_the_grid_path():
    made = GridPlanner(room(), 0.0, config=PlannerConfig(smoothing="none")).plan((0, 0), (1.9, 0))
    assert (made.path.points == made.grid_path.points).all()


def test_start_is_goal():
    made = plan(room(), (0.33, 0.2), (0.33, 0.2))
    assert made.path.length == 0.0
    assert made.grid_path.length == 0.0
    assert len(made.path.points) <= 2


def test_a_start_inside_the_inflation_finds_its_way_out():
    start = (0.99, 0.3)  # a hand's breadth from the wall
    made = plan(room(), start, (0.3, 0.3), radius=0.25)
    assert tuple(made.path.points[0]) == start
    assert 0.0 < made.clear_from < 0.5
    rest = made.path.resampled(made.clear_from, made.path.length, 0.01)
    cells = room().frame.points_to_grid(rest)
    assert clearance(room().blocked(), cells) >= 2.5 - 1e-6
    assert made.grid_path.length >= made.path.length
    planner = GridPlanner(room(), 0.25)
    assert planner.path_blocked_at(made.path.points) == 0.0
    assert planner.path_blocked_at(rest) is None


def test_a_way_out_into_a_pocket_is_not_taken():
    drawn = OccupancyGrid.from_text(
        """
        .............
        .............
        .............
        .............
        ######..#####
        .....#.######
        .....#..#####
        .....#..#####
        .....########
        """.replace(" ", ""),
        0.1,
    )
    made = plan(drawn, (0.69, 0.31), (0.3, 0.75), radius=0.0501)
    assert made.path.length > 0.4


def test_a_blocked_start_is_left_if_the_robot_has_a_size():
    wall = (1.05, 0.2)
    with pytest.raises(StartOccupied, match="is in an obstacle"):
        plan(room(), wall, (0.3, 0.2), radius=0.0)
    made = plan(room(), wall, (0.3, 0.2), radius=0.1)
    assert tuple(made.path.points[0]) == wall
    assert made.path.length > 0.7
    filled = OccupancyGrid.from_occupied(
        np.pad(np.zeros((9, 9), bool), (0, 40)) | (np.add.outer(np.arange(49), np.arange(49)) > 16),
        0.1,
    )
    with pytest.raises(StartOccupied, match="is in an obstacle; the nearest place"):
        plan(filled, (4.0, 4.0), (0.4, 0.4), radius=0.1)


def test_errors_have_names_and_say_what_is_wrong():
    with pytest.raises(OutOfMap, match=r"the goal \(5, 0.2\) is off the map, which spans x 0 to 2"):
        plan(room(), (0.3, 0.2), (5.0, 0.2))
    with pytest.raises(OutOfMap, match=r"the goal \(2.0004, 0.2\) is off the map"):
        plan(room(), (0.3, 0.2), (2.0004, 0.2))
    with pytest.raises(OutOfMap, match="the start"):
        plan(room(), (-0.01, 0.2), (0.3, 0.2))
    with pytest.raises(OutOfMap):
        plan(room(), (float("nan"), 0.2), (0.3, 0.2))
    with pytest.raises(GoalOccupied, match="is in an obstacle"):
        plan(room(), (0.3, 0.2), (1.05, 0.2), radius=0.1)
    with pytest.raises(
        GoalOccupied, match=r"is 0.05 m from an obstacle, nearer than the radius of 0.1 m"
    ):
        plan(room(), (0.3, 0.2), (0.95, 0.2), radius=0.1)
    with pytest.raises(NoPath):
        plan(room(), (0.3, 0.3), (1.6, 0.3), radius=0.22)
    with pytest.raises(ConfigError, match="did you mean 'improved'"):
        plan(room(), (0.3, 0.2), (0.3, 0.2), "improvd")
    with pytest.raises(ConfigError, match="radius"):
        plan(room(), (0.3, 0.2), (0.3, 0.2), radius=-1.0)


def test_unknown_cells_are_a_policy():
    drawn = OccupancyGrid.from_text("..?..")
    with pytest.raises(NoPath):
        plan(drawn, (0.5, 0.5), (4.5, 0.5))
    assert plan(drawn, (0.5, 0.5), (4.5, 0.5), unknown="free").path.length == 4.0


def test_marking_a_window_is_as_if_made_anew():
    rng = np.random.default_rng(3)
    for radius in (0.0, 0.12, 0.33):
        blocked = rng.random((30, 40)) < 0.03
        planner = GridPlanner(OccupancyGrid.from_occupied(blocked, 0.1), radius)
        for mark in range(15):
            row, column = rng.integers(0, 25), rng.integers(0, 30)
            patch = rng.random((rng.integers(1, 6), rng.integers(1, 11))) < 0.1
            blocked[row : row + patch.shape[0], column : column + patch.shape[1]] = patch
            planner.mark(row, column, patch)
            assert (planner.blocked == blocked).all()
            if mark % 3:  # some marks are worked out together
                continue
            anew = GridPlanner(OccupancyGrid.from_occupied(blocked, 0.1), radius)
            assert (planner.inflated == anew.inflated).all()
    with pytest.raises(OutOfMap):
        planner.mark(28, 0, np.ones((3, 1), dtype=bool))


def test_where_a_path_is_blocked():
    planner = GridPlanner(room(), 0.05)
    line = [(0.2, 0.2), (0.5, 0.2), (1.8, 0.2)]
    assert planner.path_blocked_at(line) == pytest.approx(0.75, abs=1e-3)
    assert planner.path_blocked_at(line, radius=0.1) == pytest.approx(0.7, abs=1e-3)
    assert planner.path_blocked_at(line[:2]) is None
    assert planner.path_blocked_at(line[:1]) is None
    made = planner.plan((0.2, 0.2), (1.8, 0.2))
    assert planner.path_blocked_at(made.path.points) is None
    planner.mark(6, 9, np.ones((2, 1), dtype=bool))
    assert 0.0 < planner.path_blocked_at(made.path.points) < made.path.length
    for points in ([(0.2, 0.2), (math.nan, 0.2)], [(0.2, math.inf)], [(0.2, 0.2, 0.0)] * 2):
        with pytest.raises(InputError, match="a path"):
            planner.path_blocked_at(points)
    for radius in (math.nan, -1.0, "0.1"):
        with pytest.raises(ConfigError, match="expected 0 to 100 m"):
            planner.path_blocked_at(line, radius=radius)


def test_at_any_angle_the_path_is_no_longer_than_the_taut_one():
    start, goal = (0.33, 0.21), (1.72, 0.18)
    taut, lines = (
        GridPlanner(room(), 0.08, config=PlannerConfig(smoothing=smoothing, rounding=0.0)).plan(
            start, goal
        )
        for smoothing in ("taut", "any-angle")
    )
    assert lines.path.length <= taut.path.length + 1e-9
    assert tuple(lines.path.points[-1]) == goal
    cells = room().frame.points_to_grid(lines.path.points)
    assert clearance(room().blocked(), cells) >= 0.8 - 1e-6


def walled(radius, **more):
    """A planner for a room of 6 x 4 m in cells of 5 cm with walls all round."""
    values = np.zeros((80, 120), np.int8)
    values[[0, -1]] = values[:, [0, -1]] = 100
    return GridPlanner(OccupancyGrid(values, 0.05), radius, **more)


@pytest.mark.parametrize("y", [1.0, 1.013, 1.04])
@pytest.mark.parametrize("gap", [0.0, 0.11, 0.2, 0.24])
def test_within_the_tolerance_a_path_ends_as_near_to_the_goal_as_the_disc_fits(gap, y):
    planner, goal = walled(0.25), (5.95 - gap, y)
    with pytest.raises(GoalOccupied):
        planner.plan((1.0, 1.0), goal, tolerance=0.9 * (0.25 - gap))
    made = planner.plan((1.0, 1.0), goal, tolerance=0.27)
    end = made.path.points[-1]
    assert end[0] <= 5.7 + 1e-6
    assert math.dist(end, goal) == pytest.approx(0.25 - gap, abs=0.02)
    assert planner.path_blocked_at(made.path.points) is None
    assert made.grid_path.points[-1].tolist() == end.tolist()


def test_a_goal_that_fits_is_the_end_whatever_the_tolerance():
    assert walled(0.25).plan((1.0, 1.0), (5.0, 3.013), tolerance=1.0).path.points[-1].tolist() == [
        5.0,
        3.013,
    ]


def test_within_the_tolerance_a_place_that_can_be_reached_is_taken():
    """The goal is free, and a wall cuts it off; or only the places nearest to it are cut off."""
    planner = walled(0.2)
    planner.mark(1, 80, np.ones((78, 2), bool))
    for goal in (4.35, 2.0), (4.2, 2.0):
        with pytest.raises((NoPath, GoalOccupied)):
            planner.plan((1.0, 2.0), goal, tolerance=0.3)
        end = planner.plan((1.0, 2.0), goal, tolerance=0.6).path.points[-1]
        assert end == pytest.approx((3.8, 2.0), abs=0.03)


@pytest.mark.parametrize("marked", [False, True])
def test_no_search_is_made_where_a_way_is_known_to_be_shut(monkeypatch, marked):
    planner, shut = walled(0.2), np.ones((78, 2), bool)
    if marked:
        planner.mark(1, 80, shut)
    else:
        values = planner.grid.values.copy()
        values[1:79, 80:82] = 100
        planner = GridPlanner(OccupancyGrid(values, 0.05), 0.2)
    searches = []
    monkeypatch.setattr(
        SearchGrid,
        "search",
        lambda *given, search=SearchGrid.search: searches.append(given) or search(*given),
    )
    for _ in range(3):
        with pytest.raises(NoPath):
            planner.plan((1.0, 2.0), (5.0, 2.0))
    assert len(searches) == 1 - marked  # a map as given is searched once
    planner.mark(30, 80, np.zeros((20, 2), bool))
    assert planner.plan((1.0, 2.0), (5.0, 2.0)).path.length == pytest.approx(4.0, abs=0.01)
    assert len(searches) == 2 - marked


@pytest.mark.parametrize("tolerance", [math.nan, -0.1])
def test_a_tolerance_that_is_none_is_refused(tolerance):
    with pytest.raises(ConfigError, match="tolerance"):
        plan(OccupancyGrid(np.zeros((5, 8), np.int8), 0.5), (1, 1), (3, 2), tolerance=tolerance)


def test_any_tolerance_is_within_the_map():
    grid = OccupancyGrid(np.zeros((5, 8), np.int8), 0.5)
    near = plan(grid, (1, 1), (3.9, 2.4), radius=0.6, tolerance=math.inf)
    assert near.path.points[-1] == pytest.approx((3.4, 1.9), abs=0.05)


def test_from_a_doorway_both_rooms_are_reached():
    blocked = np.zeros((7, 15), bool)
    blocked[:, 7] = True
    blocked[3, 7] = False
    planner = GridPlanner(OccupancyGrid(blocked), 1.0)
    reached = planner.reached_from((7.3, 3.5))
    assert reached[3, 12]
    assert reached[3, 2]
    assert not reached[3, 7]

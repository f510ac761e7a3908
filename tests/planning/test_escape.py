"""The way out of the inflation for a robot that starts too close to something."""

import cv2
import numpy as np
import pytest
from hypothesis import event, given, settings
from hypothesis import strategies as st

import naive
from dynastar.errors import NoPath, StartOccupied
from dynastar.grid import OccupancyGrid
from dynastar.planning import ALGORITHMS, GridPlanner, PlannerConfig, SearchGrid

RADIUS = 1.4  # cells


def planner_on(blocked, radius, planner="dijkstra"):
    config = PlannerConfig(planner, smoothing="none")
    return GridPlanner(OccupancyGrid.from_occupied(blocked, 1.0), radius, config=config)


def centre(cell):
    """(x, y) of a cell's centre, in metres, on a map with cells of 1 m."""
    return cell[1] + 0.5, cell[0] + 0.5


def rooms(cells, way_on):
    """Two rooms side by side and one above them, with a way to it that is narrow for ``RADIUS``.

    The start is in that way, nearer to the rooms below than to the one above, where the goal is.
    """
    blocked = np.zeros((cells, 2 * cells + 1), bool)
    blocked[:-4, cells] = True  # a wall between the rooms
    blocked[-10:-4] = True  # and one above them
    blocked[-13:-10, cells] = False
    blocked[-10 : -4 if way_on else -5, cells] = False
    return blocked, (cells - 8, cells), (cells - 2, 5)


@given(st.integers(0, 10**9), st.sampled_from([0.0, 0.6, 1.0, 1.6, 2.3]))
@settings(max_examples=250, deadline=None)
def test_the_shortest_way_out_that_leads_on_is_taken(seed, radius):
    rng = np.random.default_rng(seed)
    blocked = rng.random(rng.integers(4, 26, 2)) < rng.choice([0.05, 0.1, 0.2, 0.4])
    (row, column), (rows, columns) = rng.integers(0, 12, 2), rng.integers(0, 11, 2)
    blocked[row : row + rows, column : column + columns] = True
    planner = planner_on(blocked, radius)
    inflated = planner.inflated
    far_inside = cv2.erode(inflated.astype(np.uint8), np.ones((3, 3), np.uint8), borderValue=1)
    starts, goals = np.argwhere(far_inside), np.argwhere(~inflated)
    if len(starts) == 0 or len(goals) == 0:
        return
    start, goal = (tuple(map(int, rng.choice(cells))) for cells in (starts, goals))
    expected = naive.way_out(blocked, inflated, start, goal, radius)
    event(str(expected) if isinstance(expected, type) else "a way out")
    if isinstance(expected, type):
        with pytest.raises(expected):
            planner.plan(centre(start), centre(goal))
        return
    plan = planner.plan(centre(start), centre(goal))
    assert plan.clear_from == pytest.approx(expected[0], rel=1e-6)
    assert plan.cost == pytest.approx(sum(expected), rel=1e-6)
    assert plan.grid_path.length == pytest.approx(plan.cost)


@pytest.mark.parametrize("algorithm", list(ALGORITHMS))
@pytest.mark.parametrize("way_on", [True, False])
def test_one_search_is_enough_however_many_ways_out_lead_nowhere(algorithm, way_on, monkeypatch):
    blocked, start, goal = rooms(30, way_on)
    planner = planner_on(blocked, RADIUS, algorithm)
    searches = []
    monkeypatch.setattr(
        SearchGrid,
        "search",
        lambda *given, search=SearchGrid.search: searches.append(given) or search(*given),
    )
    if way_on:
        plan = planner.plan(centre(start), centre(goal))
        assert plan.clear_from > 4.0
        assert plan.grid_path.points[-1].tolist() == list(centre(goal))
    else:
        with pytest.raises(NoPath, match=r"no way leads from \(30.5, 22.5\) to \(5.5, 28.5\)"):
            planner.plan(centre(start), centre(goal))
    assert len(searches) <= 1


def test_a_way_out_is_searched_within_10_cells_for_this_radius():
    """A corridor that is too narrow for the robot leads to a room that is not."""
    blocked = np.ones((9, 40), bool)
    blocked[1] = blocked[2:7, 30:] = False
    planner = planner_on(blocked, RADIUS)
    assert planner.plan(centre((1, 22)), centre((4, 35))).clear_from > 9.0
    with pytest.raises(StartOccupied, match="no way out was found within 10 m"):
        planner.plan(centre((1, 20)), centre((4, 35)))


def two_rooms(door):
    """Two rooms of 60 x 40 cells with a thin wall between them, and a door as wide as given."""
    blocked = np.zeros((40, 122), bool)
    blocked[:, 60:62] = True
    blocked[20 - door // 2 : 20 + door // 2, 60:62] = False
    return blocked


@pytest.mark.parametrize(
    ("row", "column"), [(20, 2), (2, 20), (37, 58), (13, 59), (14, 58), (20, 55)]
)
def test_no_way_out_leads_through_a_door_that_is_too_narrow(row, column):
    """Not from the edge of the room either, nor from the edge of the door."""
    planner = planner_on(two_rooms(door=12), 8.0)
    assert planner.inflated[row, column]
    assert planner.plan(centre((row, column)), centre((20, 30))).clear_from > 0.0
    with pytest.raises(NoPath):
        planner.plan(centre((row, column)), centre((20, 90)))


def test_a_robot_in_a_narrow_door_may_leave_to_either_side():
    planner = planner_on(two_rooms(door=12), 8.0)
    for goal in (20, 30), (20, 90):
        assert planner.plan(centre((20, 60)), centre(goal)).clear_from > 3.0


@pytest.mark.parametrize("smoothing", ["none", "taut", "any-angle"])
def test_a_way_out_keeps_the_clearance_of_the_start_less_a_cell(smoothing):
    rng, seen = np.random.default_rng(3), 0
    for _ in range(60):
        blocked = rng.random((24, 24)) < 0.05
        config = PlannerConfig("auto", smoothing=smoothing)
        planner = GridPlanner(OccupancyGrid.from_occupied(blocked, 1.0), 2.6, config=config)
        start = tuple(map(int, rng.choice(np.argwhere(~blocked))))
        goals = np.argwhere(~planner.inflated)
        if len(goals) == 0:
            continue
        try:
            plan = planner.plan(centre(start), centre(rng.choice(goals)))
        except (NoPath, StartOccupied):
            continue
        lead = plan.path.part(0.0, plan.clear_from)
        if plan.clear_from > 0.0:
            seen += 1
            gap = naive.clearance(blocked, [(y, x) for x, y in lead])
            assert gap >= naive.gap_at(blocked, start) - 1.0 - 1e-6
    assert seen > 10


def zoned(keepout, blocked=None):
    """A map with cells of 1 m and a keep-out zone, and a planner on it."""
    values = np.zeros(keepout.shape, np.int8) if blocked is None else 100 * blocked.astype(np.int8)
    return GridPlanner(OccupancyGrid(values, 1.0, keepout), RADIUS, config=PlannerConfig("auto"))


def inside(plan, keepout):
    """Whether the path is in the zone, every tenth of a metre."""
    points = plan.path.resampled(0.0, plan.path.length, 0.1)[:, ::-1].astype(int)
    return keepout[points[:, 0], points[:, 1]]


def test_a_zone_is_left_by_the_shortest_way_and_never_entered_again():
    keepout = np.zeros((60, 60), bool)
    keepout[15:45, 15:45] = True
    plan = zoned(keepout).plan(centre((36, 28)), centre((5, 30)))
    within = inside(plan, keepout)
    assert within[0]
    assert 8.0 <= 0.1 * within.sum() <= 9.5  # the nearest edge is away from the goal
    assert (np.diff(within.astype(int)) != 0).sum() == 1
    assert plan.clear_from == pytest.approx(8.5 + RADIUS, abs=1.0)


def test_a_zone_across_a_corridor_is_left_to_the_side_that_leads_on():
    keepout = np.zeros((20, 80), bool)
    keepout[:, 20:60] = True
    plan = zoned(keepout).plan(centre((10, 25)), centre((10, 75)))
    assert plan.path.length == pytest.approx(50.0, abs=0.1)


def test_a_space_that_a_zone_encloses_is_no_way_out():
    keepout = np.zeros((60, 60), bool)
    keepout[10:50, 10:50] = True
    keepout[25:35, 25:35] = False  # enclosed
    plan = zoned(keepout).plan(centre((30, 21)), centre((30, 55)))
    within = inside(plan, keepout)
    assert (np.diff(within.astype(int)) != 0).sum() == 1
    assert plan.path.points[:, 0].min() < 10.0


def test_obstacles_in_a_zone_are_passed_by_at_the_radius():
    keepout, blocked = np.zeros((60, 60), bool), np.zeros((60, 60), bool)
    keepout[10:50, 10:50] = True
    blocked[44, 20:40] = True  # between the start and the nearest edge
    plan = zoned(keepout, blocked).plan(centre((40, 30)), centre((55, 30)))
    line = [(y, x) for x, y in plan.path.points]
    assert naive.clearance(blocked, line) >= RADIUS - 1e-6


def test_a_robot_outside_does_not_enter_a_zone():
    keepout = np.zeros((60, 60), bool)
    keepout[15:45, 15:45] = True
    plan = zoned(keepout).plan(centre((14, 30)), centre((46, 30)))
    assert not inside(plan, keepout).any()

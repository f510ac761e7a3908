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
    """Two rooms and what lies above them, joined by a gap that is narrow for ``RADIUS``; start, goal.

    The start is in the gap, much nearer to both rooms than to what lies above, where the goal is.
    """
    blocked = np.zeros((cells, 2 * cells + 1), bool)
    blocked[:-4, cells] = True  # a wall between the rooms
    blocked[-8:-4] = True  # and one above them
    blocked[-11:-8, cells] = False
    if way_on:
        blocked[-8:-4, cells] = False
    return blocked, (cells - 9, cells), (cells - 2, 5)


@given(st.integers(0, 10**9), st.sampled_from([0.0, 0.6, 1.0, 1.6, 2.3]))
@settings(max_examples=400, deadline=None)
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
        assert plan.clear_from > 5.0
        assert plan.grid_path.points[-1].tolist() == list(centre(goal))
    else:
        with pytest.raises(NoPath, match=r"no way leads from \(30.5, 21.5\) to \(5.5, 28.5\)"):
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

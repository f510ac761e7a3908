import math

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.errors import ScenarioError
from dynastar.footprint import Footprint, box
from dynastar.geometry import Pose2D
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.simulation.contact import Solids, occupied_runs

TRIANGLE = np.array([[0.0, 0.0], [1.0, 0.2], [0.3, 0.9]])


def naive_gap(grid, obstacles, pose, footprint):
    """The smallest of all distances, cell by cell and side by side."""
    corners = [(0, 0), (0, grid.columns), (grid.rows, grid.columns), (grid.rows, 0), (0, 0)]
    things = [shapely.LineString(grid.frame.points_to_world(corners))]
    for row, column in np.argwhere(grid.occupied):
        cell = [(row, column), (row, column + 1), (row + 1, column + 1), (row + 1, column)]
        things.append(shapely.Polygon(grid.frame.points_to_world(cell)))
    things += map(shapely.Polygon, obstacles)
    if footprint.is_disc:
        shape = shapely.Point(pose.x, pose.y)
        return min(map(shape.distance, things)) - footprint.circumscribed
    points = [
        (
            pose.x + x * math.cos(pose.theta) - y * math.sin(pose.theta),
            pose.y + x * math.sin(pose.theta) + y * math.cos(pose.theta),
        )
        for x, y in footprint.vertices
    ]
    return min(map(shapely.Polygon(points).distance, things))


@settings(max_examples=60)
@given(seed=st.integers(0, 10**6))
def test_the_gap_is_the_brute_force_one(seed):
    random = np.random.default_rng(seed)
    shape = random.integers(1, 14, 2)
    frame = GridFrame(random.uniform(0.2, 1.0), *random.uniform(-3, 3, 2), random.uniform(-4, 4))
    grid = OccupancyGrid(random.random(shape) < random.choice([0.0, 0.1, 0.4]), frame)
    obstacles = [TRIANGLE + random.uniform(-3, 3, 2) for _ in range(random.integers(3))]
    solids = Solids(grid, obstacles)
    for footprint in (Footprint.disc(0.3), box(0.6, 0.4), Footprint.disc(0.0)):
        pose = Pose2D(*grid.frame.to_world(*(random.random(2) * shape)), random.uniform(-4, 4))
        expected = naive_gap(grid, obstacles, pose, footprint)
        assert solids.gap(pose, footprint) == pytest.approx(expected, abs=1e-9)


def test_off_the_map_is_contact():
    solids = Solids(OccupancyGrid.from_text("....\n...."))
    assert solids.gap(Pose2D(2.0, 1.0), Footprint.disc(0.3)) == pytest.approx(0.7)
    assert solids.gap(Pose2D(9.0, 9.0), Footprint.disc(0.3)) <= 0.0


def test_unknown_and_keepout_are_not_solid():
    values = np.full((3, 3), -1)
    grid = OccupancyGrid(values, keepout=np.ones((3, 3), bool))
    assert len(occupied_runs(grid)) == 0


def test_runs_cover_exactly_the_occupied_cells():
    grid = OccupancyGrid.from_text("##.#\n....\n####")
    covered = np.zeros((3, 4), bool)
    for row, begin, row_end, end in occupied_runs(grid):
        assert not covered[row:row_end, begin:end].any()
        covered[row:row_end, begin:end] = True
    np.testing.assert_array_equal(covered, grid.occupied)
    assert len(occupied_runs(grid)) == 3


@pytest.mark.parametrize(
    ("ring", "message"),
    [
        (np.array([[0.0, 0.0], [1.0, 1.0]]), r"obstacle 0 has shape \(2, 2\)"),
        (np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), "not a simple polygon"),
        (np.full((3, 2), math.inf), "not finite"),
    ],
)
def test_a_malformed_obstacle_is_refused(ring, message):
    with pytest.raises(ScenarioError, match=message):
        Solids(OccupancyGrid.from_text("...."), [ring])

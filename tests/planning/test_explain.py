"""What is said of points where a robot does not fit, and of points that nothing connects."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.clearance import distance_to_squares
from dynastar.errors import GoalOccupied, NoPath, OutOfMap, StartOccupied
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.planning import GridPlanner, plan

ROOM = OccupancyGrid.from_text(
    """\
##########
#........#
#........#
#....#####
#........#
#......??#
##########""",
    0.5,
)


def said(error, *arguments, grid=ROOM, **settings):
    with pytest.raises(error) as raised:
        plan(grid, *arguments, **settings)
    return str(raised.value)


def test_what_is_in_the_way_is_told_apart():
    start = (0.75, 1.25)
    assert "(2.75, 1.75) is in an obstacle; the nearest place where it fits is" in said(
        GoalOccupied, start, (2.75, 1.75)
    )
    words = said(GoalOccupied, start, (3.75, 0.75))
    assert (
        "is in unknown space; the nearest place where it fits is (3.25, 0.75), 0.5 m away" in words
    )
    assert words.endswith("unknown = 'free' (--unknown free) plans through unknown space")
    assert said(GoalOccupied, start, (0.75, 0.6), radius=0.2) == (
        "the goal (0.75, 0.6) is 0.1 m from an obstacle, nearer than the radius of 0.2 m; "
        "the nearest place where it fits is (0.75, 0.75), 0.15 m away"
    )
    assert "the start (2.75, 1.75) is in an obstacle" in said(StartOccupied, (2.75, 1.75), start)
    assert "the start (9, 9) is off the map" in said(OutOfMap, (9, 9), start)
    assert "it fits nowhere on this map; the widest that does has 0.75 m" in said(
        GoalOccupied, start, start, radius=3.0
    )


def test_keep_out_zones_are_named():
    keepout = np.zeros(ROOM.values.shape, bool)
    keepout[:, 4] = True
    grid = OccupancyGrid(ROOM.values, ROOM.frame, keepout)
    assert "is in a keep-out zone" in said(GoalOccupied, (0.75, 1.25), (2.25, 1.25), grid=grid)
    words = said(NoPath, (0.75, 1.25), (3.25, 1.25), grid=grid)
    assert "nor for any other; keep-out zones are in the way" in words


def test_the_widest_that_passes_is_said_and_where():
    doors = OccupancyGrid.from_text("......\n......\n......\n##.###\n......\n......\n......", 1.0)
    words = said(NoPath, (2.5, 1.5), (2.5, 5.5), grid=doors, radius=0.8)
    assert words == (
        "no way leads from (2.5, 1.5) to (2.5, 5.5) for a radius of 0.8 m; the widest that would pass "
        "has 0.5 m, and (2.5, 3.5) is where it is narrowest"
    )


def test_walls_and_unknown_space_that_part():
    parted = OccupancyGrid.from_text("..#..\n..#..")
    assert said(NoPath, (0.5, 0.5), (4.5, 0.5), grid=parted).endswith("nor for any other")
    veiled = OccupancyGrid.from_text("..?..\n..#..")
    assert "unknown = 'free'" in said(NoPath, (0.5, 0.5), (4.5, 0.5), grid=veiled)


@settings(max_examples=300)
@given(st.integers(0, 10**6), st.floats(0.3, 3.0))
def test_the_widest_radius_is_right(seed, radius):
    rng = np.random.default_rng(seed)
    grid = OccupancyGrid((rng.random((12, 16)) < 0.12).astype(np.int8) * 100, 1.0)
    free = np.argwhere(grid.values == 0)
    a, b = (grid.cell_to_world(*free[rng.integers(len(free))]) for _ in range(2))
    try:
        plan(grid, a, b, radius=radius)
    except NoPath as error:
        words = str(error)
        if "widest" in words:
            widest = float(words.split("would pass has ")[1].split(" m")[0])
            assert widest < radius
            if widest > 0.0:
                GridPlanner(grid, widest).plan(a, b)
            room = distance_to_squares(grid.occupied)[grid.world_to_cell(*a)]
            if room > widest + 2e-3:  # a start with less room is led out of it
                with pytest.raises((NoPath, GoalOccupied, StartOccupied)):
                    GridPlanner(grid, widest + 2e-3).plan(a, b)
    except (GoalOccupied, StartOccupied) as error:
        words = str(error)
        if "nearest place" in words:
            x, y = eval(words.split("fits is ")[1].split("), ")[0] + ")")
            GridPlanner(grid, radius).plan((x, y), (x, y))


def test_the_place_that_fits_is_named_exactly_however_far_from_the_origin():
    values = np.full((1, 10), 100, np.int8)
    values[0, 7:] = 0
    grid = OccupancyGrid(values, GridFrame(0.05, 1200.0, 0.0))
    with pytest.raises(GoalOccupied, match=r"it fits is \(1200\.375, 0\.025\)"):
        plan(grid, (1200.48, 0.025), (1200.3, 0.025))
    assert plan(grid, (1200.48, 0.025), (1200.375, 0.025)).path.length > 0.0

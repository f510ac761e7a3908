"""The suite maps: every rule of a drawn mission holds, on maps made up here."""

import math
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
import shapely

from dynastar.bench.missions import Options
from dynastar.bench.robots import MAPS_ROBOT
from dynastar.bench.selection import choose_missions
from dynastar.bench.suites import maps
from dynastar.bench.suites.map_worlds import MapWorld, draw_world
from dynastar.errors import DataError, DynastarWarning
from dynastar.grid import FREE, OCCUPIED, UNKNOWN, GridFrame, OccupancyGrid
from dynastar.io.maps import save_map
from dynastar.simulation import Scenario
from dynastar.simulation.contact import Solids
from dynastar.simulation.movers import Movers

RADIUS = MAPS_ROBOT.footprint.circumscribed


def hall(yaw: float = 0.0) -> OccupancyGrid:
    """Two rooms of 12 x 8 m with a wide door; in one a block, round both unknown space."""
    values = np.full((100, 260), UNKNOWN, np.int8)
    values[8:92, 8:252] = OCCUPIED
    values[10:90, 10:128] = FREE
    values[10:90, 132:250] = FREE
    values[40:60, 128:132] = FREE
    values[30:50, 60:80] = OCCUPIED
    return OccupancyGrid(values, GridFrame(0.1, 3.0, -2.0, yaw))


def check(made: MapWorld, grid: OccupancyGrid) -> None:
    """What the module promises, tested without its code."""
    assert 5.0 <= math.dist(made.start, made.goal) <= 30.0
    assert made.length >= math.dist(made.start, made.goal) - 1e-6
    ends = shapely.points([made.start, made.goal])
    assert 2 <= len(made.boxes) <= 4
    for box in made.boxes:
        assert shapely.distance(shapely.Polygon(box), ends).min() >= 0.5
    solids = Solids(OccupancyGrid(grid.blocked(), grid.frame), made.boxes)
    assert way_remains(made, grid)
    assert len(made.walkers) == 2
    movers = Movers(made.walkers)
    begin = movers.at(0.0)
    assert (np.hypot(*(begin - made.start).T) >= 2.25).all()
    for walker in made.walkers:
        speed = math.dist(*walker.points) / float(walker.times[-1] - walker.times[0])
        assert 0.3 <= speed <= 0.8
        lane = shapely.LineString(walker.points)
        assert 2.0 <= lane.length <= 8.0 + 1e-6
        assert shapely.distance(lane, ends).min() >= 1.25
        room = shapely.distance(lane, solids._tree.geometries).min()
        assert room >= 0.25 + 2.0 * RADIUS


def way_remains(made: MapWorld, grid: OccupancyGrid) -> bool:
    """Whether free cells, thinned by the robot's radius, join start and goal past the boxes."""
    rows, columns = np.nonzero(~grid.blocked())
    points = grid.frame.points_to_world(np.column_stack([rows, columns]) + 0.5)
    shapes = shapely.union_all([shapely.Polygon(box) for box in made.boxes])
    clear = shapely.distance(shapely.points(points), shapes) > RADIUS
    solids = np.argwhere(grid.blocked())
    open_cells = {(int(r), int(c)) for r, c, fits in zip(rows, columns, clear, strict=True) if fits}
    near = {(int(r) + i, int(c) + j) for r, c in solids for i in (-1, 0, 1) for j in (-1, 0, 1)}
    open_cells -= near
    first, last = grid.world_to_cell(*made.start), grid.world_to_cell(*made.goal)
    seen, queue = {first}, [first]
    while queue:
        r, c = queue.pop()
        for cell in ((r + 1, c), (r - 1, c), (r, c + 1), (r, c - 1)):
            if cell in open_cells and cell not in seen:
                seen.add(cell)
                queue.append(cell)
    return last in seen


@pytest.mark.parametrize("yaw", [0.0, 0.6])
def test_every_rule_holds(yaw: float) -> None:
    grid = hall(yaw)
    worlds = [draw_world(grid, RADIUS, [0, number]) for number in range(12)]
    made = [world for world in worlds if isinstance(world, MapWorld)]
    assert len(made) >= 9
    for world in made:
        check(world, grid)
    assert len({world.start for world in made}) == len(made)


def test_a_seed_draws_the_same_again() -> None:
    one, two, other = (draw_world(hall(), RADIUS, [seed, 3]) for seed in (0, 0, 1))
    assert isinstance(one, MapWorld)
    assert isinstance(two, MapWorld)
    assert isinstance(other, MapWorld)
    assert (one.start, one.goal, one.length) == (two.start, two.goal, two.length)
    assert np.array_equal(np.vstack(one.boxes), np.vstack(two.boxes))
    assert one.start != other.start


def test_a_map_too_small_is_left_out_with_a_reason() -> None:
    small = OccupancyGrid(np.zeros((40, 40), np.int8), GridFrame(0.1))
    assert "5 m apart" in str(draw_world(small, RADIUS, [0, 0]))
    narrow = OccupancyGrid(np.zeros((8, 120), np.int8), GridFrame(0.1))
    assert "room" in str(draw_world(narrow, RADIUS, [0, 0]))


def test_missions_take_the_maps_in_turn(tmp_path: Path) -> None:
    folder = tmp_path / "ros_maps"
    folder.mkdir()
    save_map(hall(), folder / "hall.yaml")
    save_map(OccupancyGrid(np.zeros((40, 40), np.int8), GridFrame(0.1)), folder / "small.yaml")
    (folder / "goals.yaml").write_text("dock: [1.0, 2.0]\n")
    options = Options(data=tmp_path, missions=2)
    with pytest.warns(DynastarWarning, match=r"goals\.yaml: the key 'image' is missing"):
        assert [m.spec for m in islice(maps.missions(options), 3)] == [
            "hall.yaml", "small.yaml", "hall.yaml",
        ]  # fmt: skip
    (folder / "goals.yaml").unlink()
    chosen, skipped = choose_missions(maps, options)
    assert {mission.spec for mission in chosen} == {"hall.yaml"}
    assert skipped.total() >= 1
    made = maps.scenario(chosen[0], options, 0)
    assert isinstance(made, Scenario)
    assert made.robot.limits.v_max == 0.5
    assert made.robot.footprint.circumscribed == 0.105
    assert made.time_limit > 60.0 + 3.0 * 5.0 / 0.5
    assert made.world is None
    with pytest.raises(DataError, match="5 m apart"):
        maps.scenario(next(islice(maps.missions(options), 1, 2)), options, 0)


@pytest.mark.data
@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*free_thresh:dynastar.errors.DynastarWarning")
def test_missions_on_real_maps_keep_the_rules(data_dir: Path) -> None:
    options = Options(data=data_dir, missions=6)
    for mission in choose_missions(maps, options)[0]:
        path = maps._folder(options) / mission.spec
        world = maps._world(path, options.seed, mission.number)
        assert isinstance(world, MapWorld)
        if "100by100" not in mission.spec:  # four million cells are too many for this check
            check(world, maps._map(path))

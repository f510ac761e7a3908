"""Over clutter and walkers' speeds: the worlds, the rows and the tables."""

import numpy as np
import pytest

from dynastar.bench import arms, clutter, paper
from dynastar.bench.controllers.printed import Printed, PrintedReplanning
from dynastar.bench.statistics import wilson
from dynastar.simulation import Scenario


def row(occupied, driver, number, outcome="blocked", speed=paper.MOVER_SPEED, **more):
    kind = {"occupied": occupied, "speed": speed, "driver": driver}
    return kind | {"number": number, "outcome": outcome, "grid_turning_points": 3 + number} | more


def paper_world(made):
    return isinstance(made, Scenario)


def test_a_world_has_so_much_of_its_map_occupied_and_the_suites_are_unchanged():
    for occupied in clutter.OCCUPIED:
        made = next(filter(paper_world, (paper.world(0, n, occupied) for n in range(20))))
        assert np.count_nonzero(made.grid.occupied) == round(400 * occupied)
        assert (len(made.obstacles), len(made.movers)) == (2, 1)
    assert np.array_equal(paper.world(0, 0).grid.occupied, paper.world(0, 0, 0.2).grid.occupied)


def test_without_map_obstacles_all_worlds_are_one():
    first, other = paper.world(0, 0, 0.0), paper.world(0, 7, 0.0)
    assert not first.grid.occupied.any()
    assert np.array_equal(first.obstacles, other.obstacles)
    assert np.array_equal(first.movers[0].points, other.movers[0].points)


def test_all_drive_the_same_worlds_once_and_the_default_beside_walkers_of_other_speeds(
    tmp_path, monkeypatch
):
    driven = []

    def drive(scenario, navigator):
        cells, (mover,) = np.count_nonzero(scenario.grid.occupied), scenario.movers
        speed = float(np.hypot(*np.diff(mover.points, axis=0)[0]) / np.diff(mover.times)[0])
        driven.append((cells, round(speed, 6), scenario.name, navigator))
        raise RuntimeError("no")

    monkeypatch.setattr(arms, "drive", drive)
    rows = clutter.run(2, 0, tmp_path / "out")
    worlds = ((0, [0]), (20, [0, 1]), (40, [0, 1]), (80, [0, 2]), (120, None))
    by_density = [one for one in driven if one[1] == 0.5]
    assert by_density[: 3 * 7] == [
        (cells, 0.5, f"paper {number}", controller)
        for cells, numbers in worlds[:-1]
        for controller in (Printed, PrintedReplanning, None)
        for number in numbers
    ]
    assert len(by_density) == 3 * 9
    assert [one[:3] for one in driven if one[1] != 0.5] == [
        (80, speed, f"paper {number}") for speed in (0.25, 1.0, 1.5) for number in (0, 2)
    ]
    monkeypatch.setattr(arms, "drive", None)
    assert clutter.run(2, 0, tmp_path / "out") == rows


def test_the_tables_count_each_density_driver_and_speed():
    rows = [
        row(0.05, "printed", 0),
        row(0.05, "default", 0, "arrived", length=30.0, time=60.0),
        row(0.05, "printed", 1, "contact", contacts_moving=1),
        row(0.05, "default", 1, "contact", contacts_resting=1),
        row(paper.OCCUPIED, "default", 3, "arrived", 1.5, length=30.0, time=70.0),
    ]
    assert clutter.summary(rows)[1]["arrived_interval"] == wilson(1, 2)
    half, none = "9 to 91", "0 to 66"
    densities, speeds = clutter.tables(rows)
    assert "were 0 of 2 with 5 % occupied, 3 of 4 with 20 % occupied." in densities.notes
    assert densities.cells[1:] == [
        ["5 % occupied", "printed", "2", "4", "0", none, "1", half, "0", none, "1", ""],
        ["5 % occupied", "default", "2", "4", "1", half, "0", none, "1", half, "0", "60.0"],
    ]
    [line] = speeds.cells[1:]
    assert (line[:5], line[-1]) == (["1.5 m/s", "default", "1", "6", "1"], "70.0")


def test_a_faster_walker_takes_the_same_way_in_less_time():
    made = paper.world(0, 0)
    faster = clutter.with_speed(made, 1.0).movers[0]
    assert faster.times == pytest.approx(0.5 * made.movers[0].times)
    assert np.array_equal(faster.points, made.movers[0].points)

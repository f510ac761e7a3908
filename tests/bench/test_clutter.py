"""The controller printed over clutter: its worlds, its rows and its table."""

import numpy as np

from dynastar.bench import arms, clutter, paper
from dynastar.bench.controllers.printed import Printed, PrintedReplanning
from dynastar.bench.statistics import wilson


def row(occupied, reading, number, outcome="blocked", **more):
    return {"occupied": occupied, "reading": reading, "number": number, "outcome": outcome} | more


def test_a_world_has_so_much_of_its_map_occupied_and_the_suites_are_unchanged():
    for occupied in clutter.OCCUPIED:
        made = paper.world(0, 0, occupied)
        assert np.count_nonzero(made.grid.occupied) == round(400 * occupied)
        assert (len(made.obstacles), len(made.movers)) == (2, 1)
    assert np.array_equal(paper.world(0, 0).grid.occupied, paper.world(0, 0, 0.2).grid.occupied)


def test_without_map_obstacles_all_worlds_are_one():
    first, other = paper.world(0, 0, 0.0), paper.world(0, 7, 0.0)
    assert not first.grid.occupied.any()
    assert np.array_equal(first.obstacles, other.obstacles)
    assert np.array_equal(first.movers[0].points, other.movers[0].points)


def test_both_readings_drive_the_same_worlds_once(tmp_path, monkeypatch):
    driven = []

    def drive(scenario, navigator):
        driven.append((np.count_nonzero(scenario.grid.occupied), scenario.name, navigator))
        raise RuntimeError("no")

    monkeypatch.setattr(arms, "drive", drive)
    rows = clutter.run(2, 0, tmp_path / "out")
    assert driven == [
        (cells, f"paper {number}", controller)
        for cells, numbers in ((0, [0]), (20, [0, 1]), (40, [0, 1]), (80, [0, 2]))
        for number in numbers
        for controller in (Printed, PrintedReplanning)
    ]
    monkeypatch.setattr(arms, "drive", None)
    assert clutter.run(2, 0, tmp_path / "out") == rows


def test_the_table_counts_each_density_and_reading():
    rows = [
        row(0.05, "as printed", 0),
        row(0.05, "second", 0, "arrived", length=30.0, time=60.0),
        row(0.05, "as printed", 1, "contact", contacts_moving=1),
        row(0.05, "second", 1, "contact", contacts_resting=1),
    ]
    assert clutter.summary(rows)[1]["arrived_interval"] == wilson(1, 2)
    half, none = "9 to 91", "0 to 66"
    assert clutter.table(rows).cells[1:] == [
        ["5 % occupied", "as printed", "2", "0", none, "1", half, "0", none, "1"],
        ["5 % occupied", "second", "2", "1", half, "0", none, "1", half, "0"],
    ]

"""Table III: the improved A*'s way on the known map, and what the rows add up to."""

import math
from dataclasses import replace

import numpy as np
import pytest

from dynastar.bench import arms, paper, table3, table3_tables
from dynastar.bench.controllers.printed import Printed
from dynastar.bench.tables import as_markdown, as_text
from dynastar.bench.unplanned import Unplanned
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.planning import plan

FIVE = ("median", "lower quartile", "upper", "p95", "worst")


def row(number, length, turns, grid_length=30.0, grid_turns=8, **more):
    end = {"outcome": "arrived", "reason": "", "contacts_moving": 0, "contacts_resting": 0}
    driven = {"length": length, "turning_points": turns, "time": 2.0 * length}
    way = {"grid_length": grid_length, "grid_turning_points": grid_turns}
    way |= {"smoothed_length": grid_length - 2.0, "smoothed_turning_points": grid_turns - 3}
    free = {"grid_free": False, "grid_free_disc": False}
    even = {"turning_angle": 7.0, "smoothness": 0.5, "jerk": 0.3}
    even |= {"min_clearance": 0.2, "mean_speed": 0.4}
    return {"number": number, **end, **driven, **way, **free, **even, **more}


ROWS = [
    row(0, 27.0, 4),
    row(2, 33.0, 2, grid_turns=0, grid_free=True),
    row(3, 10.0, 1, outcome="contact", contacts_moving=1, grid_free=True, grid_free_disc=True),
    row(5, 12.0, 1, outcome="timeout"),
    {"number": 6, "outcome": "error", "reason": "E: x", "grid_length": 30.0}
    | {"grid_turning_points": 9, "grid_free": False, "grid_free_disc": False}
    | {"smoothed_length": 28.0, "smoothed_turning_points": 6},
]


def empty(*blocks, size=20):
    grid = OccupancyGrid.from_occupied(np.zeros((size, size), bool), 1.0, 1.0, 1.0)
    squares = tuple(paper._square(1.0 + column, 1.0 + row) for row, column in blocks)
    return replace(paper.own_world(), grid=grid, obstacles=squares, movers=())


def test_the_diagonal_turns_nowhere_and_hits_what_stands_on_it():
    length = 19 * math.sqrt(2)
    way = table3.grid_way(empty())
    assert way["grid_length"] == pytest.approx(length)
    assert (way["grid_turning_points"], way["grid_free"], way["grid_free_disc"]) == (0, True, True)
    hit = table3.grid_way(empty((7, 7)))
    assert (hit["grid_length"], hit["grid_free"]) == (way["grid_length"], False)
    brushed = table3.grid_way(empty((7, 8)))  # a corner that a point may touch, and a disc may not
    assert (brushed["grid_free"], brushed["grid_free_disc"]) == (True, False)
    assert table3.grid_way(empty((3, 15)))["grid_free_disc"]


def test_every_bend_of_a_way_over_cells_counts():
    for number in range(12):
        made = paper.world(3, number)
        if isinstance(made, str):
            continue
        line = plan(made.grid, paper.START, paper.GOAL, "improved").grid_path.points
        steps = np.sign(np.diff(line, axis=0).round(6))
        bends = int((steps[1:] != steps[:-1]).any(axis=1).sum())
        assert table3.grid_way(made)["grid_turning_points"] == bends > 0


def test_ratios_are_over_all_worlds_and_what_did_not_arrive_is_longer_than_any():
    found = table3.summary(ROWS)
    assert (found["missions"], found["arrived"]) == (5, 2)
    assert (found["contacts_moving"], found["contacts_resting"]) == (1, 0)
    assert (found["timeouts"], found["blocked"], found["errors"]) == (1, 0, 1)
    nothing = {"median": None, "p95": None, "worst": None}
    assert found["length_ratio"] == found["turning_ratio"] == found["time"] == nothing
    most = table3.summary(ROWS[:3])
    assert most["length_ratio"] == pytest.approx({**nothing, "median": 1.1})
    assert most["turning_ratio"]["median"] == 2.0  # over one, where the way has none
    assert most["time"]["median"] == 66.0
    all_arrived = table3.summary(ROWS[:2])
    assert all_arrived["length_ratio"] == pytest.approx({"median": 0.9, "p95": 1.1, "worst": 1.1})
    assert (found["grid_hits"], found["grid_hits_disc"]) == (3, 4)


def test_nothing_arrived_is_no_figure_and_no_error():
    found = table3.summary(ROWS[2:])
    assert found["length_ratio"]["median"] is found["time"]["median"] is None
    for table in table3_tables.tables({"default": ROWS[2:], "printed": ROWS[2:]}, ROWS[-1]):
        assert table.title in as_text(table)


def test_who_drives_is_compared_with_the_default_in_the_same_worlds():
    moved = [row(number, 30.0, 3) for number in range(9)]
    touched = [{**of, "outcome": "contact", "contacts_resting": 1} for of in moved]
    by_driver = {"default": moved, "printed": touched[:7], "plain": touched[:1] + moved[1:3]}
    by_driver["alone"] = moved[:4] + touched[4:5]
    table = table3_tables.tables(by_driver, ROWS[0])[2]
    assert [line[7:10] for line in table.cells[1:-1]] == [
        ["", "", ""],
        ["7", "0", "0.047"],  # Holm: three times 2 / 2^7
        ["1", "0", "1.000"],
        ["1", "0", "1.000"],
    ]


def test_the_tables_have_the_printed_figures_beside():
    by_preset = {"default": ROWS[:3], "printed": ROWS[2:]}
    own, many, presets, driving = table3_tables.tables(by_preset, row(None, 28.0, 6, 32.0, 12))
    assert [cells[0] for cells in presets.cells] == ["", "default", "printed", "in print"]
    assert presets.cells[1][1:3] == ["3", "2"]
    assert presets.cells[1][7:] == ["", "", "", "1.100", "2.000", "66.0"]
    assert presets.cells[2][7:] == ["0", "0", "1.000", "", "", ""]
    assert presets.cells[3][10:12] == ["0.879", "0.571"]
    assert own.cells[1:] == [
        ["improved A*, grid path", "32.0", "12", "33", "7"],
        ["hybrid", "28.0", "6", "29", "4"],
        ["hybrid / improved A*", "0.88", "0.50", "0.88", "0.57"],
    ]
    assert tuple(many.cells[0][1:-1]) == FIVE
    assert driving.cells[1:] == [
        ["default", "2", "7.00", "0.50", "0.30", "0.20", "0.40"],
        ["printed", "0", "", "", "", "", ""],
    ]
    assert many.cells[2] == ["smoothed, length m", *3 * ["28.00"], *2 * ["28.00"], ""]
    assert many.cells[3] == [
        "hybrid, length m",
        "33.00",
        "27.00",
        "",
        "",
        "",
        "29.00",
    ]
    assert many.cells[8][0] == "turns, hybrid / improved A*"
    assert "2 of 3 arrived, 1 touched" in many.notes
    assert "1 worlds as a point" in many.notes
    assert "| hybrid | 28.0 | 6 | 29 | 4 |" in as_markdown(own)


def test_rows_are_made_once_and_an_error_is_one(tmp_path, monkeypatch):
    flown = []

    def drive(scenario, navigator):
        flown.append((scenario.name, scenario.preset, scenario.seed, navigator))
        raise RuntimeError("no")

    monkeypatch.setattr(arms, "drive", drive)
    rows = table3.run(3, 0, tmp_path / "out")
    assert [row["number"] for row in rows] == [0, 2, 4]  # 1 and 3 are left out by the rule
    assert [row["outcome"] for row in rows] == ["error"] * 3
    assert all(row["grid_length"] > 26.0 for row in rows)
    assert table3.run(4, 0, tmp_path / "out")[:3] == rows
    assert [name for name, *_ in flown] == ["paper 0", "paper 2", "paper 4", "paper 5"]
    table3.run(1, 0, tmp_path / "out", driver="paper")
    assert flown[-1] == ("paper 0", "paper", 0, None)
    table3.run(1, 0, tmp_path / "out", driver="printed")
    assert flown[-1] == ("paper 0", "default", 0, Printed)
    table3.run(1, 0, tmp_path / "out", driver="alone")
    assert flown[-1] == ("paper 0", "default", 0, Unplanned)


def test_the_window_alone_follows_the_straight_line_and_avoids_what_is_on_it():
    block = empty((3, 3), size=8)
    made = replace(block, goals=(Goal(7.5, 7.5),), time_limit=60.0)
    driven = arms.run_mission(made, arms.ARMS["DWA alone"])
    assert driven["outcome"] == "arrived"
    assert 8.5 < driven["length"] < 11.0
    assert driven["replans"] == 0


def test_the_hybrid_is_driven_as_the_suite_drives_it():
    own = table3.own_row()
    assert (own["number"], own["outcome"]) == (None, "arrived")
    assert 27.0 < own["length"] < 40.0
    assert own["grid_length"] == pytest.approx(32.142, abs=1e-3)

import json

import numpy as np
import pytest
from cv2 import integral

from dynastar.bench import table1
from dynastar.bench.families import KINDS, Map, draw
from dynastar.cli import main
from dynastar.planning import search
from naive import shortest

PINNED = {
    "expanded_ratio",
    "expanded_ratio_octile",
    "search_time_ratio",
    "total_time_ratio",
    "length_ratio",
    "length_ratio_same_smoothing",
    "any_angle_ratio",
}


def test_on_an_empty_map_the_diagonal_is_all():
    row = table1.measure(Map("random", 0, np.zeros((9, 9), bool), (0, 0), (8, 8)))
    for arm in (*table1.SEARCHES, "improved, fast", "improved, any angle", "optimum"):
        assert row[arm]["length"] == pytest.approx(8 * np.sqrt(2))
    assert row["improved"]["expanded"] == 9
    assert table1.RATIOS["expanded_ratio"](row) == 1.0


@pytest.mark.parametrize("kind", KINDS)
def test_a_row_is_in_the_order_that_theory_wants(kind):
    drawn = next(made for n in range(20) if (made := draw(kind, n)) is not None)
    row = table1.measure(drawn)
    exact = shortest(drawn.occupied, drawn.start)[drawn.goal]
    for arm in ("traditional", "traditional, octile"):
        assert row[arm]["length"] == pytest.approx(exact, rel=1e-6)
    assert row["improved"]["length"] >= exact - 1e-3
    assert row["improved, fast"]["length"] <= row["improved"]["length"] + 1e-9
    bound = row["optimum, any point"]["length"]
    assert bound <= row["optimum"]["length"] + 1e-5
    assert bound <= row["improved, any angle"]["length"] + 1e-5
    assert bound <= row["traditional, smoothed"]["length"] + 1e-5
    assert row["improved, any angle"]["length"] <= row["improved, fast"]["length"] + 1e-9
    both = row["improved"]["seconds"] + row["improved, fast"]["seconds"]
    assert table1.RATIOS["total_time_ratio"](row) == both / row["traditional"]["seconds"]


@pytest.mark.slow
def test_the_command_makes_the_table_and_goes_on_where_it_was(tmp_path, capsys):
    out = tmp_path / "out"
    again = ["--out", str(out), "--workers", "1", "--json-out"]
    assert main(["paper", "table1", "--maps", "4", *again, "-"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert set(found["table1"]) == {"all", *KINDS}
    for kind in found["table1"].values():
        assert set(kind) >= PINNED
        for spread in kind.values():
            assert set(spread) == {"median", "mean", "p95", "worst"}
            assert spread["median"] <= spread["worst"]
    assert found["table1_512"]["all"]["total_time_ratio"]["median"] < 1.0
    assert "length_ratio" not in found["table1_512"]["all"]
    assert len((out / "table1.csv").read_text().splitlines()) == 5
    assert (out / "table1.md").read_text().count(r"| traditional A\* (octile) |") == 4
    for suffix in (".png", ".svg"):
        assert (out / f"table1{suffix}").stat().st_size > 10_000
    lines = (out / "table1.jsonl").read_text().splitlines()
    assert main(["paper", "table1", "--maps", "8", *again, str(tmp_path / "sum.json")]) == 0
    assert "cells expanded" in capsys.readouterr().out
    assert json.loads((tmp_path / "sum.json").read_text())["maps"] == 8
    assert set(lines) < set((out / "table1.jsonl").read_text().splitlines())
    assert main(["paper", "table1", "--json-out", str(tmp_path / "no" / "x")]) == 2


def test_what_only_one_arm_needs_is_prepared_in_its_time(monkeypatch):
    counted = []
    monkeypatch.setattr(
        search.cv2, "integral", lambda *a, **b: counted.append(1) or integral(*a, **b)
    )
    drawn = next(made for n in range(20) if (made := draw("random", n)) is not None)
    grid, (algorithm, terms) = search.SearchGrid(drawn.occupied), table1.SEARCHES["improved"]
    for _ in range(3):
        table1.searched(grid, drawn, algorithm, terms)
    assert len(counted) == 3

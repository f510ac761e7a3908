import csv
import json

import pytest

from dynastar.bench.report import REPORTS, Report, write, write_csv
from dynastar.bench.selection import REPORT_SEEDS
from dynastar.bench.tables import Table
from dynastar.cli import build_parser, main


def test_nested_rows_become_columns_and_a_row_may_lack_some(tmp_path):
    rows = [{"number": 1, "improved": {"length": 2.5}}, {"number": 2, "reason": "none"}]
    write_csv(tmp_path / "rows.csv", rows)
    with open(tmp_path / "rows.csv", newline="", encoding="utf-8") as file:
        first, second = csv.DictReader(file)
    assert first == {"number": "1", "improved: length": "2.5", "reason": ""}
    assert second == {"number": "2", "improved: length": "", "reason": "none"}


def test_a_report_is_written_as_its_tables_and_rows(tmp_path):
    table = Table("one", "One", (("", ""), ("x", ".1f")), [("a", 1.0)])
    write(Report("one", {}, [table], {"rows": [{"x": 1.0}]}), tmp_path)
    assert "| a | 1.0 |" in (tmp_path / "one.md").read_text()
    assert (tmp_path / "rows.csv").read_text().split() == ["x", "1.0"]
    assert sorted(file.name for file in tmp_path.iterdir()) == ["one.md", "rows.csv"]


def test_the_command_knows_every_report():
    choices = build_parser().parse_args(["paper"])
    assert choices.what == "all"
    for name in REPORTS:
        assert build_parser().parse_args(["paper", name]).what == name


def test_the_paper_is_remade_on_worlds_that_are_for_report():
    assert build_parser().parse_args(["paper"]).seed == REPORT_SEEDS


@pytest.mark.slow
def test_the_json_of_table3_has_its_tables_in_markdown(tmp_path, capsys):
    asked = ["paper", "table3", "--maps", "1", "--workers", "1", "--out", str(tmp_path / "out")]
    assert main([*asked, "--json-out", "-"]) == 0
    result = json.loads(capsys.readouterr().out)
    found = result["table3"]
    assert found["missions"] == 1
    assert {"arrived", "contacts_moving"} <= set(found)
    for ratio in ("length_ratio", "turning_ratio"):
        assert set(found[ratio]) == {"median", "p95", "worst"}
    assert set(result["tables"]) == {"table3-own", "table3", "table3-presets", "table3-driving"}
    assert {name: len(rows) for name, rows in result["rows"].items()} == {
        "table3-default": 1,
        "table3-paper": 1,
        "table3-printed": 1,
        "table3-plain": 1,
        "table3-alone": 1,
    }
    assert result["tables"]["table3"].startswith("**Table III over 1 worlds**")
    assert "| hybrid, length m |" in result["tables"]["table3"]


def test_a_folder_is_no_file_for_json(tmp_path, capsys):
    assert main(["paper", "table3", "--json-out", str(tmp_path)]) == 2
    assert "that is a folder" in capsys.readouterr().err

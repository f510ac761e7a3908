import csv
import json

import pytest

from dynastar.bench.report import REPORTS, Report, write, write_csv
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


@pytest.mark.slow
def test_the_command_fills_a_page_with_table3(tmp_path, capsys):
    page = tmp_path / "page.md"
    page.write_text("a\n<!-- table3 -->\n<!-- end table3 -->\nb\n")
    asked = ["paper", "table3", "--maps", "2", "--workers", "1", "--out", str(tmp_path / "out")]
    assert main([*asked, "--docs", str(page), "--json-out", "-"]) == 0
    found = json.loads(capsys.readouterr().out)["table3"]
    assert found["missions"] == 2
    assert {"arrived", "contacts_moving"} <= set(found)
    for ratio in ("length_ratio", "turning_ratio"):
        assert set(found[ratio]) == {"median", "p95", "worst"}
    assert "| hybrid, length m |" in page.read_text()
    assert page.read_text().startswith("a\n<!-- table3 -->\n**Table III over 2 worlds**")


@pytest.mark.parametrize(
    ("page", "said"),
    [
        (None, "there is no such file"),
        ("<!-- table1 -->\n", "has no part between <!-- table1 --> and <!-- end table1 -->"),
        (b"\xff\xfe\xff", "UTF-8"),
    ],
)
def test_a_page_that_cannot_be_filled_is_said_before_the_work(tmp_path, capsys, page, said):
    file = tmp_path / "page.md"
    if page is not None:
        file.write_bytes(page if isinstance(page, bytes) else page.encode())
    assert main(["paper", "table3", "--docs", str(file), "--out", str(tmp_path / "out")]) == 2
    assert said in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_a_folder_is_no_file_for_json(tmp_path, capsys):
    assert main(["paper", "table3", "--json-out", str(tmp_path)]) == 2
    assert "that is a folder" in capsys.readouterr().err

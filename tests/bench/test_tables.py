from pathlib import Path

import pytest

from dynastar.bench.tables import Table, as_markdown, as_text, fill
from dynastar.errors import InputError

TABLE = Table(
    "two", "Two rows", (("arm", ""), ("length", ".2f"), ("n", "d")),
    [("short", 1.0, 12), ("much longer", None, 3)], "m",
)  # fmt: skip


def test_columns_stand_under_each_other():
    lines = as_text(TABLE).split("\n")
    assert lines[0] == "Two rows"
    assert lines[4] == "short          1.00  12"
    assert lines[5] == "much longer           3"
    assert lines[-1] == "m"


def test_markdown_has_as_many_cells_in_every_row():
    lines = [line for line in as_markdown(TABLE).split("\n") if line.startswith("|")]
    assert [line.count("|") for line in lines] == [4] * 4
    assert lines[2] == "| short | 1.00 | 12 |"


def test_a_part_of_a_document_is_filled_again_and_again():
    document = "a\n<!-- two -->\nold\n<!-- end two -->\nb\n"
    once = fill(document, "two", "new", Path("x.md"))
    assert once == "a\n<!-- two -->\nnew\n<!-- end two -->\nb\n"
    assert fill(once, "two", "new", Path("x.md")) == once
    with pytest.raises(InputError, match=r"x\.md has no part between <!-- three -->"):
        fill(document, "three", "new", Path("x.md"))


def test_a_star_is_a_star_in_markdown():
    text = as_markdown(TABLE._replace(title="Over A*", rows=[("A*, octile", 1.0, 2)]))
    assert text.startswith("**Over A\\***\n")
    assert "| A\\*, octile | 1.00 | 2 |" in text

"""JSON and CSV of data sets: read within limits, refused with file and line."""

from pathlib import Path

import numpy as np
import pytest

from dynastar.errors import DataError
from dynastar.io.data_files import item, items, numbers, read_columns, read_json, read_text


def test_columns_come_in_the_order_asked(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("\ufeffb,other,a\n1,x,2\n3,y,4.5\n", encoding="utf-8")
    assert np.array_equal(read_columns(path, ("a", "b")), [[2.0, 1.0], [4.5, 3.0]])
    path.write_bytes(b"a,b\r1,2\r3,4\r")
    assert np.array_equal(read_columns(path, ("a", "b")), [[1.0, 2.0], [3.0, 4.0]])


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a\n1\n", "'b' is missing"),
        ("a,b\n1,2\n1\n", "line 3"),
        ("a,b\n1,inf\n", "line 2"),
        ("a,b\n1,word\n", "line 2"),
        (f"a,b\n1,{'2' * 200_000}\n", "line 2: this is not CSV"),
    ],
)
def test_damaged_columns_name_the_line(tmp_path: Path, text: str, says: str) -> None:
    path = tmp_path / "a.csv"
    path.write_text(text)
    with pytest.raises(DataError, match=says):
        read_columns(path, ("a", "b"))


def test_files_are_text_of_bounded_size(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(b"[1, 2]")
    assert read_json(path) == [1, 2]
    with pytest.raises(DataError, match="at most 5"):
        read_text(path, 5)
    path.write_bytes(b"\xff\xfe\x00")
    with pytest.raises(DataError, match="UTF-8"):
        read_json(path)
    path.write_text("[" * 100_000)
    with pytest.raises(DataError, match="not valid JSON"):
        read_json(path)
    with pytest.raises(DataError, match="no such file"):
        read_json(tmp_path / "b.json")


def test_values_have_the_shape_asked() -> None:
    assert numbers([[1, 2, 3]], (-1, 3), "x").shape == (1, 3)
    for value in ([1, 2], [[1, 2]], [[1, 2, None]], [[1, 2, float("nan")]], [[1, 2], [3]], "word"):
        with pytest.raises(DataError, match=r"x: expected .*\(n, 3\)"):
            numbers(value, (-1, 3), "x")
    with pytest.raises(DataError, match="'k' is missing"):
        item({}, "k", "x")
    with pytest.raises(DataError, match="expected an object"):
        item([], "k", "x")
    with pytest.raises(DataError, match="expected a list"):
        items({"k": 1}, "k", "x")

"""The suite movingai: a benchmark made by others judges the search."""

from pathlib import Path

import pytest

from dynastar.bench.missions import Options
from dynastar.bench.movingai import missions
from dynastar.bench.runner import run_suite
from dynastar.bench.suites import load_suite
from dynastar.errors import DataError

INDEX = "set,map,width,height,sx,sy,gx,gy,file_length,recomputed_length,match\n"
MAP = "type octile\nheight 3\nwidth 4\nmap\n....\n.@@.\n....\n"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A data set of one map: a right optimum, a wrong one, one unconfirmed, one without its map."""
    (tmp_path / "own").mkdir()
    (tmp_path / "own" / "a.map").write_text(MAP)
    rows = ["own,a.map,4,3,0,0,3,2,5,5.0,1", "own,a.map,4,3,0,0,0,2,2,2.5,1"]
    rows += ["own,a.map,4,3,0,0,0,2,2,2.0,0", "own,b.map,4,3,0,0,0,2,2,2.0,1"]
    (tmp_path / "verified_scenarios.csv").write_text(INDEX + "\n".join(rows) + "\n")
    return tmp_path


def test_rows_are_compared_and_left_out_by_rule(folder: Path) -> None:
    result = run_suite("movingai", load_suite("movingai"), Options(data=folder))
    assert (result["missions"], result["skipped"], result["arrived"]) == (2, 2, 1)
    right, wrong = result["rows"]
    assert right["outcome"] == "arrived"
    assert (right["map"], right["start"], right["goal"]) == ("own/a.map", (0, 0), (3, 2))
    assert right["found"] == pytest.approx(5.0)
    assert wrong["outcome"] == "wrong"
    assert wrong["error"] == pytest.approx(0.5)


def test_a_damaged_index_names_its_line(folder: Path) -> None:
    index = folder / "verified_scenarios.csv"
    index.write_text(index.read_text().replace("own,a.map,4,3,0,0,0,2,2,2.5", "own,a.map,4,x"))
    with pytest.raises(DataError, match="line 3"):
        run_suite("movingai", load_suite("movingai"), Options(data=folder))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("\u00e9,a.map\n".encode("latin-1"), "save it as UTF-8"),
        (b"own," + b"x" * 200_000 + b"\n", "line 2: this is not CSV"),
    ],
)
def test_an_index_that_is_no_csv_says_so(folder: Path, text: bytes, says: str) -> None:
    (folder / "verified_scenarios.csv").write_bytes(INDEX.encode() + text)
    with pytest.raises(DataError, match=says):
        list(missions(Options(data=folder)))


def test_an_index_may_have_a_byte_order_mark_and_lacks_no_column(folder: Path) -> None:
    index = folder / "verified_scenarios.csv"
    index.write_bytes(b"\xef\xbb\xbf" + index.read_bytes())
    assert len(list(missions(Options(data=folder)))) == 4
    index.write_text(index.read_text("utf-8-sig").replace("match", "fits"))
    with pytest.raises(DataError, match="column 'match' is missing"):
        list(missions(Options(data=folder)))


@pytest.mark.data
@pytest.mark.slow
def test_two_processes_give_the_same_rows(data_dir: Path) -> None:
    movingai = load_suite("movingai")
    one, two = (
        run_suite("movingai", movingai, Options(data=data_dir, select="0:60:6", workers=workers))
        for workers in (1, 2)
    )
    keep = ("number", "outcome", "found", "expanded")
    assert [[row[key] for key in keep] for row in one["rows"]] == [
        [row[key] for key in keep] for row in two["rows"]
    ]
    assert one["arrived"] == one["missions"]

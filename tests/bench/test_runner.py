"""The frame of the suites, on a suite made up here."""

import importlib
import inspect
import json
from pathlib import Path
from typing import Any

import pytest

from dynastar.bench.missions import Mission, Options
from dynastar.bench.runner import run_suite
from dynastar.bench.suites import SUITES, WITHOUT_DATA
from dynastar.errors import InputError
from made_up_suite import suite


def test_a_run_goes_on_where_it_was_cut_off(tmp_path: Path) -> None:
    keep, flown = tmp_path / "rows.jsonl", []
    made = suite(lambda: range(11, 16))
    whole = run_suite("made up", made, Options(repeat=2))
    run_mission = made.run_mission

    def cut_off(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
        if len(flown) == 3:
            raise KeyboardInterrupt
        flown.append((mission.number, repeat))
        return run_mission(mission, options, repeat)

    made.run_mission = cut_off
    with pytest.raises(KeyboardInterrupt):
        run_suite("made up", made, Options(repeat=2), keep=keep)
    made.run_mission = lambda *asked: (
        flown.append((asked[0].number, asked[2])) or run_mission(*asked)
    )
    assert run_suite("made up", made, Options(repeat=2), keep=keep)["rows"] == whole["rows"]
    assert len(flown) == len(set(flown)) == 10
    # More missions go on, too; another seed or setting begins anew.
    run_suite("made up", made, Options(repeat=3), keep=keep)
    assert len(flown) == 15
    changed = {"settings": {"period": 0.2}}, {"ideal": True}, {"attention": "late"}, {"legs": True}
    for other in (Options(seed=1), *(Options(**one) for one in changed)):
        before = len(flown)
        run_suite("made up", made, other, keep=keep)
        assert len(flown) == before + 5


def test_kept_rows_that_are_damaged_are_run_again_in_any_folder(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DYNASTAR_DATA", raising=False)
    keep, made, flown = tmp_path / "rows.jsonl", suite(lambda: range(3)), []
    whole = run_suite("made up", made, Options(), keep=keep)["rows"]
    settings, *rows = map(json.loads, keep.read_text().splitlines())
    del rows[0]["row"]["cpu_s"], rows[1]["row"]["outcome"]
    keep.write_text("".join(json.dumps(line) + "\n" for line in (settings, *rows)))
    run_mission = made.run_mission
    made.run_mission = lambda *asked: flown.append(asked[0].number) or run_mission(*asked)
    monkeypatch.chdir(tmp_path)
    assert run_suite("made up", made, Options(), keep=keep)["rows"] == whole
    assert flown == [0, 1]


@pytest.mark.parametrize(
    ("made", "options", "said"),
    [
        (suite(lambda: [1]), Options(select="5:3"), "--select 5:3 names no mission of the suite x"),
        (suite(list), Options(data=Path("here")), "the suite x: here holds no mission"),
        (suite(lambda: [1], left_out={1}), Options(), "leaves out every mission .*: by rule"),
    ],
)
def test_a_run_without_a_mission_is_refused(
    made: Any, options: Options, said: str, tmp_path: Path
) -> None:
    with pytest.raises(InputError, match=said):
        run_suite("x", made, options, keep=tmp_path / "rows.jsonl")
    assert list(tmp_path.iterdir()) == []


def test_a_result_names_the_attention_of_its_walkers() -> None:
    made = suite(lambda: range(11, 12))
    assert run_suite("made up", made, Options())["attention"] == "none"
    made.ATTENTION = "late"
    assert run_suite("made up", made, Options())["attention"] == "late"
    assert run_suite("made up", made, Options(attention="none"))["attention"] == "none"


def test_failures_are_rows_and_order_is_kept() -> None:
    result = run_suite("made up", suite(lambda: range(11, 16)), Options(repeat=2, seed=5))
    assert [row["number"] for row in result["rows"]] == [11, 11, 12, 12, 13, 13, 14, 14, 15, 15]
    assert [row["seed"] for row in result["rows"]] == [5, 6] * 5
    assert (result["missions"], result["arrived"], result["skipped"]) == (10, 8, 0)
    failed = result["rows"][4]
    assert failed["outcome"] == "error"
    assert failed["reason"] == "RuntimeError: unlucky"
    assert result["mean_length"] == pytest.approx(26.0)
    assert result["mean_time"] == pytest.approx(1.5)


@pytest.mark.parametrize("name", SUITES)
def test_a_suite_refuses_data_that_it_does_not_read(name):
    source = inspect.getsource(importlib.import_module(SUITES[name]))
    assert (name in WITHOUT_DATA) == ("data_folder" not in source and "options.data" not in source)

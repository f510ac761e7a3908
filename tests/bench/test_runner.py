"""The frame of the suites, on a suite made up here."""

import subprocess
import sys
from collections.abc import Iterator
from itertools import count
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.bench import SUITES, Mission, Options, load_suite, run_suite
from dynastar.bench.runner import choose_missions, data_folder, parse_select, totals
from dynastar.errors import ConfigError, DataError, InputError


def suite(numbers: Any, default: int | None = None, left_out: Any = ()) -> Any:
    def missions(options: Options) -> Iterator[Mission]:
        return (Mission(number, 2 * number) for number in numbers())

    def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
        if mission.number == 13:
            raise RuntimeError("unlucky")
        return {"outcome": "arrived", "length": float(mission.spec), "time": 1.0 + repeat}

    return SimpleNamespace(
        DEFAULT_MISSIONS=default,
        missions=missions,
        leave_out=lambda mission, options: "by rule" if mission.number in left_out else "",
        run_mission=run_mission,
    )


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("5", [5]),
        ("2:6", [2, 3, 4, 5]),
        ("1:9:3", [1, 4, 7]),
        (":3", [0, 1, 2]),
        ("7:", [7, 8, 9]),
        ("::4", [0, 4, 8]),
        ("4:4", []),
    ],
)
def test_select_is_a_slice(text: str, expected: list[int]) -> None:
    assert list(parse_select(text).until(10)) == expected


@pytest.mark.parametrize(
    "text", ["", "a", "1:2:0", "1:2:-1", "-3", "-3:2", "1:2:3:4", "1.5", ":-2"]
)
def test_select_that_is_none(text: str) -> None:
    with pytest.raises(InputError, match="--select"):
        parse_select(text)


@given(
    st.sets(st.integers(0, 40)),
    st.sets(st.integers(0, 40)),
    st.tuples(st.integers(0, 45), st.integers(0, 45), st.integers(1, 7)),
)
def test_every_number_asked_for_is_run_or_counted(
    there: set[int], left_out: set[int], cut: tuple[int, int, int]
) -> None:
    made = suite(lambda: sorted(there), left_out=left_out)
    options = Options(select=":".join(map(str, cut)))
    chosen, skipped = choose_missions(made, options)
    asked = range(*cut)
    assert [mission.number for mission in chosen] == [
        number for number in asked if number in there - left_out
    ]
    assert len(chosen) + skipped == len(asked)


def test_missions_counts_after_leaving_out() -> None:
    made = suite(count, default=4, left_out={0, 2})
    numbers = lambda options: [m.number for m in choose_missions(made, options)[0]]  # noqa: E731
    assert numbers(Options(missions=3)) == [1, 3, 4]
    assert numbers(Options()) == [1, 3, 4, 5]
    assert numbers(Options(select="2:6")) == [3, 4, 5]
    assert numbers(Options(select="10::5")) == [10, 15, 20, 25]
    assert choose_missions(made, Options(missions=3))[1] == 2


def test_quick_spreads_over_the_suite_and_gives_way() -> None:
    made = suite(lambda: range(10, 30), left_out={15, 16})
    made.QUICK_MISSIONS = 4
    quick = Options(quick=True)
    chosen, skipped = choose_missions(made, quick)
    assert [mission.number for mission in chosen] == [10, 17, 20, 25]
    assert skipped == 2
    made.QUICK_MISSIONS = 99
    assert len(choose_missions(made, quick)[0]) == 18
    endless = suite(count, default=4, left_out={1})
    endless.QUICK_MISSIONS = 3
    assert [m.number for m in choose_missions(endless, quick)[0]] == [0, 2, 3]
    with pytest.raises(InputError, match="--quick"):
        choose_missions(made, Options(quick=True, missions=3))


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
    for other in (Options(seed=1), Options(seed=1, settings={"period": 0.2}), Options(ideal=True)):
        before = len(flown)
        run_suite("made up", made, other, keep=keep)
        assert len(flown) == before + 5


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


def test_totals_of_nothing() -> None:
    result = totals([], 3)
    assert result["mean_length"] is None
    assert result["skipped"] == 3


def test_totals_count_missions() -> None:
    rows = [
        {"outcome": "contact", "contacts_moving": 2, "contacts_resting": 0},
        {"outcome": "contact", "contacts_moving": 0, "contacts_resting": 1},
        {"outcome": "timeout", "length": 4.0, "time": 400.0},
        {"outcome": "arrived", "length": 2.0, "time": None},
    ]
    result = totals(rows, 0)
    assert (result["contacts_moving"], result["contacts_resting"], result["timeouts"]) == (1, 1, 1)
    assert (result["mean_length"], result["mean_time"]) == (2.0, None)


def test_suites_are_found_by_name() -> None:
    assert set(SUITES) >= {"movingai", "paper"}
    with pytest.raises(ConfigError, match="'movingai'"):
        load_suite("movingia")


def test_the_data_are_in_the_folder_or_one_below(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("DYNASTAR_DATA", raising=False)
    (tmp_path / "set").mkdir()
    (tmp_path / "set" / "index.csv").touch()
    for named in (tmp_path, tmp_path / "set"):
        assert data_folder(Options(data=named), "set", "index.csv") == tmp_path / "set"
    with pytest.raises(DataError, match="--data"):
        data_folder(Options(), "set", "index.csv")
    with pytest.raises(DataError, match=r"index\.csv"):
        data_folder(Options(data=tmp_path / "nowhere"), "set", "index.csv")
    monkeypatch.setenv("DYNASTAR_DATA", str(tmp_path))
    assert data_folder(Options(), "set", "index.csv") == tmp_path / "set"


POOL = """\
import multiprocessing, os, time
from concurrent.futures import ProcessPoolExecutor
from dynastar.bench.workers import settle

if __name__ == "__main__":
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(1, context, initializer=settle)
    print(pool.submit(os.getpid).result(), flush=True)
    pool.submit(time.sleep, 60.0).result()
"""


def test_workers_end_with_a_parent_that_is_killed(tmp_path):
    script = tmp_path / "pool.py"
    script.write_text(POOL)
    with subprocess.Popen([sys.executable, script], stdout=subprocess.PIPE, text=True) as parent:
        assert parent.stdout is not None
        assert int(parent.stdout.readline()) != parent.pid
        parent.kill()
        parent.communicate(timeout=20.0)  # ends when the last who holds the pipe, the worker, has

import sys
from types import ModuleType

import pytest

from dynastar.bench import scoreboard
from dynastar.bench.compare import compare
from dynastar.bench.missions import Mission, Options
from dynastar.bench.scoreboard_tables import quality_table, table
from dynastar.bench.suites import SUITES
from dynastar.bench.tables import as_text
from dynastar.errors import DataError, InputError
from dynastar.viewer.sheet import save


def module(name, outcomes, quick=2, **more):
    made = ModuleType(name)

    def run_mission(mission, options, repeat):
        return {
            "outcome": mission.spec,
            "group": f"{name} {mission.number % 2}",
            "time": 4.0,
            "time_ratio": 2.0 if mission.spec == "arrived" else None,
            "contacts_moving": int(mission.spec == "contact"),
            "smoothness": 0.5,
            "within_0_2": 0.25,
        }

    made.DEFAULT_MISSIONS = None
    made.QUICK_MISSIONS = quick
    made.missions = lambda options: [Mission(n, o) for n, o in enumerate(outcomes)]
    made.leave_out = lambda mission, options: ""
    made.run_mission = run_mission
    vars(made).update(more)
    return made


@pytest.fixture
def suites(monkeypatch):
    def no_data(options):
        raise DataError("give --data DIR")

    made = {
        "first": module("first", ["arrived"] * 5 + ["contact"]),
        "second": module("second", ["timeout", "arrived"], PUBLISHED=(("a", "b", "c"),)),
        "absent": module("absent", [], missions=no_data),
    }
    for name, suite in made.items():
        monkeypatch.setitem(sys.modules, f"test_suite_{name}", suite)
    names = {name: f"test_suite_{name}" for name in made}
    only(monkeypatch, names | {"missing": "test_suite_of_a_package_that_is_not_there"})
    return made


def only(monkeypatch, names):
    """Leave no suites but these."""
    for name in list(SUITES):
        monkeypatch.delitem(SUITES, name)
    for name, module_name in names.items():
        monkeypatch.setitem(SUITES, name, module_name)


def test_every_suite_is_run_or_said_to_be_left_out(suites, tmp_path):
    result = scoreboard.run_all(Options())
    assert {name: of["missions"] for name, of in result["suites"].items()} == {
        "first": 6,
        "second": 2,
    }
    assert result["left_out"]["absent"] == "give --data DIR"
    assert "is not installed" in result["left_out"]["missing"]
    assert [row["number"] for row in result["suites"]["first"]["rows"]] == list(range(6))
    assert result["suites"]["first"]["contacts_moving"] == 1
    text = as_text(table(result))
    assert "second was left out" not in text
    assert "absent was left out: give --data DIR" in text
    first = next(line for line in text.splitlines() if line.startswith("first "))
    assert first.split()[1:6] == ["6", "5", "44-97", "1", "0"]
    assert sum(line.startswith("  first ") for line in text.splitlines()) == 2
    file = save(scoreboard.picture(result), tmp_path / "all.png")
    assert file.read_bytes().startswith(b"\x89PNG")


def test_other_controllers_drive_in_the_same_missions(suites, monkeypatch, tmp_path):
    driven = suites["first"].run_mission

    def by_others_worse(mission, options, repeat):
        row = driven(mission, options, repeat)
        if options.controller == "printed":
            raise ValueError("no such world")
        return row if options.controller == "navigator" else row | {"outcome": "timeout"}

    suites["first"].run_mission = by_others_worse
    suites["first"].scenario = lambda mission, options, repeat: None
    result = scoreboard.run_all(Options(), others=("pure_pursuit", "nobody", "printed"))
    assert result["suites"]["first"]["arrived"] == 5
    assert list(result["others"]) == ["pure_pursuit"]
    assert list(result["others"]["pure_pursuit"]) == ["first"]  # the second drives nothing
    other = result["others"]["pure_pursuit"]["first"]
    assert (other["controller"], other["timeouts"], other["arrived"]) == ("pure_pursuit", 6, 0)
    assert "unknown controller 'nobody'" in result["left_out"]["nobody"]
    assert result["left_out"]["printed in first"] == "ValueError: no such world"
    lines = as_text(table(result)).splitlines()
    line = next(line for line in lines if "by pure_pursuit" in line)
    assert line.split()[2:8] == ["6", "0", "0-39", "1", "0", "6"]
    fewer = scoreboard.run_all(Options(), others=("pure_pursuit",), every=2)
    assert fewer["others"]["pure_pursuit"]["first"]["missions"] == 3
    assert fewer["suites"] == result["suites"]
    numbers = [row["number"] for row in fewer["others"]["pure_pursuit"]["first"]["rows"]]
    assert numbers == sorted(set(numbers))
    assert numbers not in ([0, 2, 4], [1, 3, 5])
    save(scoreboard.picture(result), tmp_path / "all.png")


def test_quality_is_over_arrivals(suites):
    lines = as_text(quality_table(scoreboard.run_all(Options()))).splitlines()
    line = next(line for line in lines if line.startswith("first "))
    assert line.split() == ["first", "0.50", "25.0"]


def test_quick_spreads_a_few_missions(suites):
    result = scoreboard.run_all(Options(quick=True))
    assert [row["number"] for row in result["suites"]["first"]["rows"]] == [0, 3]
    assert result["quick"]


def test_two_of_them_can_be_compared(suites):
    first, second = (scoreboard.run_all(Options())["suites"] for _ in range(2))
    assert set(compare(first, second)["suites"]) == {"first", "second"}


def test_a_run_goes_on_where_it_was_cut_off(suites, tmp_path):
    keep, flown = tmp_path / "all.rows.jsonl", []
    whole = scoreboard.run_all(Options())

    def cut_off(mission, options, repeat):
        if len(flown) == 3:
            raise KeyboardInterrupt
        flown.append(mission.number)
        return run_mission(mission, options, repeat)

    run_mission, suites["first"].run_mission = suites["first"].run_mission, cut_off
    with pytest.raises(KeyboardInterrupt):
        scoreboard.run_all(Options(), keep=keep)
    suites["first"].run_mission = lambda *asked: (
        flown.append(asked[0].number) or run_mission(*asked)
    )
    again = scoreboard.run_all(Options(), keep=keep)
    assert sorted(flown) == list(range(6))
    for name in ("first", "second"):
        assert again["suites"][name]["rows"] == whole["suites"][name]["rows"]
    # Other settings begin anew.
    scoreboard.run_all(Options(seed=1), keep=keep)
    assert len(flown) == 12


def test_nothing_to_run_is_an_error(suites, monkeypatch):
    only(monkeypatch, {"absent": "test_suite_absent"})
    with pytest.raises(InputError, match="no suite can be run: give --data"):
        scoreboard.run_all(Options())

import json

import pytest

from dynastar.bench.compare import as_lines, compare, load_result, verdict
from dynastar.bench.statistics import totals
from dynastar.errors import InputError


def result(outcomes, times=(), name="small", **more):
    rows = [
        {"number": 2 * n, "repeat": 0, "seed": 0, "outcome": outcome}
        | ({"time": times[n], "length": 5.0 + 0.1 * times[n]} if times else {})
        for n, outcome in enumerate(outcomes)
    ]
    return {name: {"suite": name, "preset": "default", **more, **totals(rows, 0)}}


def only(first, second):
    return compare(first, second)["suites"]["small"]


def test_outcomes_that_changed_and_paired_differences():
    first = result(["arrived", "arrived", "timeout", "contact"], (10.0, 20.0, 99.0, 5.0))
    second = result(["arrived", "contact", "arrived", "contact"], (12.0, 3.0, 50.0, 5.0))
    found = only(first, second)
    assert [(c["number"], c["from"], c["to"]) for c in found["changed"]] == [
        (2, "arrived", "contact"),
        (4, "timeout", "arrived"),
    ]
    assert (found["lost"], found["gained"], found["p_success"]) == ([2], [4], 1.0)
    assert found["time"] == {"mean": 2.0, "interval": None, "pairs": 1}
    assert found["length"]["mean"] == pytest.approx(0.2)
    assert found["verdict"].startswith("no difference: 1 missions gained, 1 lost")


def test_a_result_is_no_different_from_itself():
    first = result(["arrived"] * 8 + ["timeout"], [float(n) for n in range(9)])
    found = only(first, first)
    assert found["changed"] == []
    assert found["time"] == {"mean": 0.0, "interval": (0.0, 0.0), "pairs": 8}
    assert found["verdict"].startswith("no difference")


@pytest.mark.parametrize(
    ("lost", "gained", "word"),
    [(0, 6, "better"), (6, 0, "worse"), (0, 5, "may be chance"), (3, 12, "better")],
)
def test_success_decides_first(lost, gained, word):
    alike = 4
    outcomes = [["arrived", "timeout"]] * lost + [["timeout", "arrived"]] * gained
    outcomes += [["arrived", "arrived"]] * alike
    first, second = zip(*outcomes, strict=True)
    # Times say the contrary, and there are too few to be heard.
    assert only(result(first, [1.0] * 40), result(second, [9.0] * 40))["verdict"].startswith(word)


@pytest.mark.parametrize(
    ("by", "word"), [(-1.0, "better: 1.00 s faster"), (1.0, "worse: 1.00 s slower")]
)
def test_then_time_decides(by, word):
    times = [10.0, 30.0, 20.0, 15.0, 40.0, 25.0]
    first = result(["arrived"] * 6, times)
    second = result(["arrived"] * 6, [t + by + 0.1 * (-1) ** n for n, t in enumerate(times)])
    assert only(first, second)["verdict"].startswith(word)
    fewer = {"mean": by, "interval": (by, by), "pairs": 5}
    assert verdict((0, 0, 5), 1.0, fewer).startswith("no difference")


@pytest.mark.parametrize(
    ("lost", "gained", "by", "word"),
    [
        (5, 1, -1.0, "undecided"),
        (1, 5, -1.0, "better"),
        (1, 5, 1.0, "undecided"),
        (5, 1, 1.0, "worse"),
    ],
)
def test_time_does_not_outweigh_success_that_points_the_other_way(lost, gained, by, word):
    said = verdict((lost, gained, 40), 0.22, {"mean": by, "interval": (by, by), "pairs": 34})
    assert said.startswith(word)
    if word == "undecided":
        assert f"{gained} missions gained, {lost} lost" in said


def test_a_contact_is_no_success_and_a_right_word_is_one():
    first = result(["arrived", "blocked_rightly"])
    second = result(["arrived", "blocked"])
    second["small"]["rows"][0]["contacts_resting"] = 1
    assert only(first, second)["lost"] == [0, 2]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"number": 7}, r"only the first file has 2 \(repeat 0, seed 0\)"),
        ({"seed": 1}, "do not match"),
        ({"repeat": 1}, "do not match"),
        ({"group": "hard"}, "is of"),
        ({"file": "b.toml"}, "is of"),
    ],
)
def test_missions_that_do_not_match_are_refused(change, said):
    first, second = result(["arrived"] * 3), result(["arrived"] * 3)
    second["small"]["rows"][1].update(change)
    with pytest.raises(InputError, match=f"of small do not match.*{said}|{said}"):
        compare(first, second)
    with pytest.raises(InputError, match="only the second file has 4"):
        compare(result(["arrived"] * 2), result(["arrived"] * 3))


def test_another_attention_is_named_and_a_result_without_one_had_none():
    earlier, late = result(["arrived"]), result(["arrived"], attention="late")
    assert only(earlier, late)["conditions"] == {"attention": ["none", "late"]}
    assert "  attention: none -> late" in as_lines(compare(earlier, late))
    assert only(earlier, result(["arrived"], attention="none"))["conditions"] == {}


def test_suites_of_one_file_are_named():
    both = result(["arrived"]) | result(["arrived"], name="other")
    assert compare(both, result(["arrived"]))["not_compared"] == ["other"]
    with pytest.raises(InputError, match="no suite is in both"):
        compare(result(["arrived"]), result(["arrived"], name="other"))


def test_chance_is_named_with_the_missions_that_a_difference_takes():
    outcomes = [["arrived", "timeout"]] * 6 + [["timeout", "arrived"]] * 3 + [["arrived"] * 2] * 11
    first, second = zip(*outcomes, strict=True)
    found = only(result(first), result(second))
    assert found["verdict"] == (
        "may be chance: 3 missions gained, 6 lost (p = 0.51); about 155 missions would show a "
        "difference of that size"
    )


def test_all_suites_together_are_judged():
    first, second = result(["arrived"] * 4), result(["timeout"] * 4)
    other, changed = result(["arrived"] * 3, name="x"), result(["timeout"] * 3, name="x")
    found = compare(first | other, second | changed)
    assert [found["suites"][name]["p_success"] < 0.05 for name in ("small", "x")] == [False, False]
    assert found["together"]["verdict"] == "worse: 0 missions gained, 7 lost (p = 0.016)"
    assert "all suites, 7 missions: worse" in "\n".join(as_lines(found))
    assert "all suites" not in "\n".join(as_lines(compare(first, second)))


def test_lines_say_it_all():
    first = result(["arrived", "timeout"], (10.0, 99.0), controller="navigator")
    second = result(["arrived", "contact"], (12.0, 4.0), controller="pure_pursuit")
    lines = "\n".join(as_lines(compare(first | result([], name="x"), second)))
    for part in (
        "small: no difference",
        "controller: navigator -> pure_pursuit",
        "time, where both arrived (1): +2.000 s",
        "timeout -> contact: 2",
        "not compared: x",
    ):
        assert part in lines


def test_files_of_one_suite_and_of_all_are_read(tmp_path):
    one = result(["arrived"])["small"]
    (tmp_path / "one.json").write_text(json.dumps(one))
    (tmp_path / "all.json").write_text(json.dumps({"suites": {"small": one}}))
    found = compare(*(load_result(tmp_path / f"{name}.json") for name in ("one", "all")))
    assert set(found["suites"]) == {"small"}


@pytest.mark.parametrize(
    "text", ["{", "[]", "{}", '{"suites": {}}', '{"suite": "a", "rows": [1]}', '{"rows": [{}]}', '"x"',
     '{"suite": "a", "rows": [{"number": 1, "outcome": "arrived", "time": "3"}]}',
     '{"suite": "a", "rows": [{"number": 1, "outcome": "arrived", "time": 1' + 400 * "0" + "}]}",
     '{"suite": "a", "rows": [], "settings": ' + 2000 * "[" + 2000 * "]" + "}", 100_000 * "["]
)  # fmt: skip
def test_files_that_are_none(tmp_path, text):
    file = tmp_path / "file.json"
    file.write_text(text)
    with pytest.raises(InputError, match=r"file\.json"):
        load_result(file)

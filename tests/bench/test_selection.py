"""Which missions of a suite are run, and which are counted as skipped."""

from itertools import count

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.bench.missions import Options
from dynastar.bench.selection import ABSENT, choose_missions, parse_select
from dynastar.errors import InputError
from made_up_suite import suite


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
        ("3,7,20", [3, 7]),
        ("7, 3,3", [3, 7]),
        ("0::4,1::4,7", [0, 1, 4, 5, 7, 8, 9]),
        ("1,2:5", [1, 2, 3, 4]),
    ],
)
def test_select_is_a_slice(text: str, expected: list[int]) -> None:
    assert sorted(parse_select(text).until(10)) == expected


@pytest.mark.parametrize(
    "text",
    [
        "",
        "a",
        "1:2:0",
        "1:2:-1",
        "-3",
        "-3:2",
        "1:2:3:4",
        "1.5",
        ":-2",
        "3,",
        "3,-1",
        "0:99999999999999999999",
        "1000000",
        "2000000:",
    ],
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
    assert len(chosen) + skipped.total() == len(asked)


def test_listed_numbers_are_run_or_counted_also_of_endless_missions() -> None:
    made = suite(count, default=2, left_out={7})
    chosen, skipped = choose_missions(made, Options(select="20,3,7"))
    assert [mission.number for mission in chosen] == [3, 20]
    assert skipped == {"by rule": 1}
    chosen, skipped = choose_missions(suite(lambda: [3, 9]), Options(select="3,7,20"))
    assert [mission.number for mission in chosen] == [3]
    assert skipped == {ABSENT: 2}


def test_missions_counts_after_leaving_out() -> None:
    made = suite(count, default=4, left_out={0, 2})
    numbers = lambda options: [m.number for m in choose_missions(made, options)[0]]  # noqa: E731
    assert numbers(Options(missions=3)) == [1, 3, 4]
    assert numbers(Options()) == [1, 3, 4, 5]
    assert numbers(Options(select="2:6")) == [3, 4, 5]
    assert numbers(Options(select="10::5")) == [10, 15, 20, 25]
    assert choose_missions(made, Options(missions=3))[1].total() == 2


def test_quick_spreads_over_the_suite_and_gives_way() -> None:
    made = suite(lambda: range(10, 30), left_out={15, 16})
    made.QUICK_MISSIONS = 4
    quick = Options(quick=True)
    chosen, skipped = choose_missions(made, quick)
    assert [mission.number for mission in chosen] == [10, 17, 20, 25]
    assert skipped.total() == 2
    made.QUICK_MISSIONS = 99
    assert len(choose_missions(made, quick)[0]) == 18
    endless = suite(count, default=4, left_out={1})
    endless.QUICK_MISSIONS = 3
    assert [m.number for m in choose_missions(endless, quick)[0]] == [0, 2, 3]
    with pytest.raises(InputError, match="--quick"):
        choose_missions(made, Options(quick=True, missions=3))

"""Settings: cast, in range, and the nearest right name for a wrong one."""

import math
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.config import Field, checked, choose, nearest, shown
from dynastar.errors import ConfigError


class Inner(NamedTuple):
    gain: Annotated[float, Field("a gain", "", 0.0, 1.0)] = 0.5


class Sample(NamedTuple):
    speed: Annotated[float, Field("a speed", "m/s", -1.0, 2.0)]
    count: Annotated[int, Field("a count", "", 0, 10)] = 1
    mode: Literal["a", "b"] = "a"
    on: bool = False
    name: str = ""
    limit: Annotated[float | None, Field("a limit", "m", 0.0, 5.0)] = None
    point: Annotated[tuple[float, float], Field("a point", "m", -9.0, 9.0)] = (0.0, 0.0)
    corners: tuple[tuple[float, float], ...] = ()
    inner: Inner = Inner()
    free: Any = None
    unbounded: int = 0


def test_values_are_cast_over_the_defaults():
    sample = checked(
        Sample,
        {"speed": 1, "count": 3.0, "point": [1, 2], "corners": [[0, 1]], "inner": {"gain": 1}},
    )
    assert sample == Sample(1.0, 3, "a", False, "", None, (1.0, 2.0), ((0.0, 1.0),), Inner(1.0))
    assert isinstance(sample.speed, float)
    assert isinstance(sample.count, int)
    assert isinstance(sample.point[0], float)


def test_numpy_numbers_are_numbers():
    sample = checked(Sample, {"speed": np.float32(0.5), "count": np.int64(4)})
    assert (sample.speed, sample.count) == (0.5, 4)
    assert type(sample.count) is int


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({}, "missing key 'top.speed'"),
        ({"sped": 1}, r"unknown key 'top.sped' \(did you mean 'speed'\?\)"),
        ({"speed": 3}, "'top.speed' is 3 m/s: legal is from -1 to 2 m/s"),
        ({"speed": math.nan}, "'top.speed' is nan"),
        ({"speed": True}, "'top.speed' is True: expected a number"),
        ({"speed": "1"}, "'top.speed' is '1'"),
        ({"speed": 10**400}, r"'top.speed' is 1000\d*\.\.\."),
        ({"speed": 1, "count": 1.5}, "'top.count' is 1.5: expected a whole number from 0 to 10"),
        ({"speed": 1, "count": math.nan}, "'top.count' is nan"),
        ({"speed": 1, "unbounded": math.inf}, "'top.unbounded' is inf"),
        ({"speed": 1, "unbounded": math.nan}, "'top.unbounded' is nan"),
        ({"speed": 1, "mode": "c"}, "'top.mode' is 'c': expected one of 'a', 'b'"),
        ({"speed": 1, "mode": []}, r"'top.mode' is \[\]"),
        ({"speed": 1, "on": 1}, "'top.on' is 1: expected true or false"),
        ({"speed": 1, "name": 1}, "'top.name' is 1: expected a string"),
        ({"speed": 1, "limit": 6}, "'top.limit' is 6 m: legal is from 0 to 5 m"),
        ({"speed": 1, "point": 3}, "'top.point' is 3: expected a list"),
        ({"speed": 1, "point": {"x": 1, "y": 2}}, "'top.point' is .*: expected a list"),
        ({"speed": 1, "point": [1]}, "'top.point' has 1 values: expected 2"),
        ({"speed": 1, "point": [1, 10]}, r"'top.point\[1\]' is 10 m: legal is from -9 to 9 m"),
        ({"speed": 1, "corners": [[1, 2], [3]]}, r"'top.corners\[1\]' has 1"),
        ({"speed": 1, "inner": {"gian": 1}}, r"'top.inner.gian' \(did you mean 'gain'\?\)"),
        ({"speed": 1, "inner": {"gain": 2}}, "'top.inner.gain' is 2"),
        ({"speed": 1, "inner": 2}, "top.inner: expected a table, got 2"),
    ],
)
def test_what_is_wrong_is_named_by_its_dotted_path(values, message):
    with pytest.raises(ConfigError, match=message):
        checked(Sample, values, "top")


anything = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats() | st.text() | st.binary(),
    lambda inner: st.lists(inner) | st.dictionaries(st.text(), inner),
)


@given(st.dictionaries(st.sampled_from(Sample._fields) | st.text(), anything))
def test_whatever_is_given_the_answer_is_a_config_or_one_short_line(values):
    try:
        assert isinstance(checked(Sample, values), Sample)
    except ConfigError as error:
        message = str(error)
    else:
        return
    assert len(message) < 500


@given(st.floats(-1, 2), st.integers(0, 10))
def test_what_is_legal_is_kept(speed, count):
    assert checked(Sample, {"speed": speed, "count": count})[:2] == (speed, count)


def test_nan_is_legal_where_the_field_says_so():
    class Codes(NamedTuple):
        codes: Annotated[tuple[float, ...], Field("any", nan_is_legal=True)] = ()
        some: Annotated[tuple[float, ...], Field("none")] = ()

    assert math.isnan(checked(Codes, {"codes": [0, math.nan]}).codes[1])
    with pytest.raises(ConfigError, match=r"some\[0\]' is nan"):
        checked(Codes, {"some": [math.nan]})


def test_long_and_deep_values_are_cut_in_messages():
    deep: list[Any] = []
    for _ in range(50):
        deep = [deep] * 10
    for value in (deep, "x" * 10**6, 10**5000, [1] * 10**6):
        assert len(shown(value)) <= 80


def test_names_have_a_nearest_one():
    assert nearest("dijkstar", ["dijkstra", "astar"]) == " (did you mean 'dijkstra'?)"
    assert nearest("q", ["b", "a"]) == " (legal: a, b)"
    assert nearest("q", []) == ""
    assert choose("a", {"a": 1}, "thing") == 1
    with pytest.raises(ConfigError, match="unknown thing 'aa'"):
        choose("aa", {"a": 1}, "thing")

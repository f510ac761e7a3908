import pytest

from dynastar.bench.settings import merged, parsed, read_settings
from dynastar.errors import ConfigError


@pytest.mark.parametrize(
    ("pairs", "expected"),
    [
        (["dwa.horizon=2"], {"dwa": {"horizon": 2}}),
        (
            ["a.b.c=1.5", "a.b.d = true", "a.e=word"],
            {"a": {"b": {"c": 1.5, "d": True}, "e": "word"}},
        ),
        (["a=1", "a=2"], {"a": 2}),
        (["a=[1, 2.5]"], {"a": [1, 2.5]}),
        (["a='x=y'"], {"a": "x=y"}),
        (["a=any-angle"], {"a": "any-angle"}),
        (["a=1\nb=2"], {"a": "1\nb=2"}),
        ([], {}),
    ],
)
def test_pairs_are_tables(pairs, expected):
    assert parsed(pairs) == expected


@pytest.mark.parametrize("pair", ["horizon", "=3", "a..b=3", ".a=3", ""])
def test_pairs_that_are_none(pair):
    with pytest.raises(ConfigError, match=r"--set .*KEY=VALUE"):
        parsed([pair])


@pytest.mark.parametrize(
    ("pair", "said"),
    [
        ("dwa.horzion=2", "'dwa.horzion'.*'horizon'"),
        ("goal_tolerance=-1", "goal_tolerance.*legal is"),
        ("goal_tolerance=near", "goal_tolerance.*a number"),
        ("dwa=3", "dwa"),
        ("reverse=True", "true or false"),
    ],
)
def test_settings_are_checked_as_in_a_scenario_file(pair, said):
    with pytest.raises(ConfigError, match=f"^--set: .*{said}"):
        read_settings([pair], "default")


def test_settings_are_read():
    assert read_settings(["goal_tolerance=1"], "paper", {"dwa": {"horizon": 2.0}}) == {
        "goal_tolerance": 1
    }
    assert merged({"a": {"b": 1, "c": 2}, "d": 3}, {"a": {"b": 9}, "d": {"e": 4}}) == {
        "a": {"b": 9, "c": 2},
        "d": {"e": 4},
    }

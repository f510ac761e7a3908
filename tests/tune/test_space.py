"""The searched settings are the navigator's, and the promise's bounds are none of them."""

import re
from dataclasses import replace
from pathlib import Path

import pytest

from dynastar.bench.presets import settings_of
from dynastar.navigator import NavigatorConfig, configured
from dynastar.robot import ROBOTS
from dynastar.tune.space import (
    OF_ROBOT,
    SPACE,
    limited,
    of_robot,
    settings_table,
    start_values,
    widened,
)

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "tune.md"


def test_no_bound_of_the_promise_is_searched():
    declared = PAGE.read_text("utf-8").partition("## Declare what is true")[2]
    declared = declared.partition("## Trade")[0]
    bounds = set(re.findall(r"`([\w.]+)`", " ".join(re.findall(r"^\|[^|]+\|", declared, re.M))))
    assert {"latency", "range_error", "prediction.acceleration", "hidden_speed"} <= bounds
    names = {parameter.name for parameter in SPACE + OF_ROBOT}
    assert not names & (bounds | {name.replace("Limits", "limits") for name in bounds})


def test_every_range_is_legal_and_holds_the_default():
    own = {name: value for name, _, value in settings_of(NavigatorConfig())}
    for parameter in SPACE:
        assert parameter.low <= own[parameter.name] <= parameter.high, parameter
    for end in ("low", "high"):
        configured("default", settings_table({p.name: getattr(p, end) for p in SPACE}))


def test_the_search_begins_with_the_settings_it_is_given():
    config = configured("default", {"dwa": {"horizon": 3.0, "comfort": 2.0}})
    values = start_values(SPACE + OF_ROBOT, config)
    assert values["dwa.horizon"] == 3.0
    assert values["dwa.comfort"] == 2.0
    (comfort,) = (p for p in widened(SPACE, values) if p.name == "dwa.comfort")
    assert (comfort.low, comfort.high) == (0.05, 2.0)
    assert values["limits.v_max"] == 1.0
    table = settings_table(values)
    assert table["dwa"]["weights"]["risk"] == 14.0
    assert "limits" not in table


def test_limits_are_fractions_of_the_robots_own():
    robot = ROBOTS["pioneer3dx"]
    slow = limited(robot, {"limits.v_max": 0.8, "comfort": 0.1})
    assert slow.limits == robot.limits._replace(v_max=0.8 * robot.limits.v_max)
    assert all(parameter.high == 1.0 for parameter in OF_ROBOT)


@pytest.mark.parametrize(("least", "names"), [(0.0, {"v_max", "omega_max"}), (0.9, {"omega_max"})])
def test_no_speed_is_searched_below_the_least_that_the_drive_follows(least, names):
    limits = ROBOTS["pioneer3dx"].limits
    limits = limits._replace(v_least=limits.v_max if least else 0.0, omega_least=least)
    robot, found = replace(ROBOTS["pioneer3dx"], limits=limits), of_robot(limits)
    assert {one.name for one in found} == {f"limits.{name}" for name in names}
    for end in ("low", "high"):
        limited(robot, {one.name: getattr(one, end) for one in found})

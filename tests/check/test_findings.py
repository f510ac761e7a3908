"""Findings appear where numbers do not fit, and vanish where they do."""

import math
import re
from dataclasses import replace
from typing import Annotated, get_args, get_origin, get_type_hints

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.check import check_robot
from dynastar.check.doors import ways_of
from dynastar.check.finding import LEVELS, at_least, at_most, worst
from dynastar.check.loop import loop
from dynastar.errors import InputError
from dynastar.footprint import Footprint, box
from dynastar.grid import OccupancyGrid
from dynastar.navigator import NavigatorConfig, configured
from dynastar.robot import ROBOTS, Lidar, Limits, Robot

GOOD = replace(ROBOTS["pioneer3dx"], lidar=Lidar(720, math.tau, 0.1, 10.0))
DECLARED = {"latency": 0.1, "range_error": 0.03, "pose_error": 0.02, "heading_error": 0.01}


def finding(name: str, robot: Robot = GOOD, grid: OccupancyGrid | None = None, **changes):
    check = check_robot(robot, configured("default", {**DECLARED, **changes}), grid, timed=False)
    [one] = [one for one in check.findings if one.name == name]
    return one


def with_lidar(**changes):
    return replace(GOOD, lidar=GOOD.lidar._replace(**changes))


def with_limits(**changes):
    return replace(GOOD, limits=GOOD.limits._replace(**changes))


def room(door: float) -> OccupancyGrid:
    """Two rooms and a door (m) between them, in cells of 0.02 m."""
    occupied = np.zeros((200, 300), bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    occupied[:, 145:155] = True
    occupied[80 : 80 + round(door / 0.02), 145:155] = False
    return OccupancyGrid.from_occupied(occupied, 0.02)


def test_nothing_is_wrong_with_a_robot_whose_numbers_fit():
    check = check_robot(GOOD, configured("default", DECLARED), room(1.0), timed=False)
    assert [(one.name, one.words()) for one in check.findings if one.level != "ok"] == []
    assert check.level == "ok"
    assert [one.advice for one in check.findings] == [""] * len(check.findings)


@pytest.mark.parametrize(
    ("name", "level", "robot", "changes", "said"),
    [
        ("braking", "problem", with_limits(v_max=2.0, v_brake=0.4), {}, "v_max = 1."),
        ("braking", "problem", with_lidar(fov=1.0, theta=math.pi), {}, "does not look ahead"),
        ("braking", "warning", with_limits(v_max=2.0, v_brake=0.9), {}, "local_map.size"),
        ("braking", "warning", with_lidar(range_max=0.7), {}, "range_max"),
        ("braking", "problem", with_lidar(beams=90), {"local_map": {"narrowest": 0.03}}, "beams"),
        ("brakes", "warning", with_limits(v_brake=9.0), {}, "measure v_brake"),
        ("brakes", "warning", GOOD, {"drive_error": 0.0}, "drive_error"),
        ("beams", "problem", with_lidar(beams=45), {"local_map": {"narrowest": 0.05}}, "beams"),
        ("blind sectors", "warning", with_lidar(fov=4.0), {}, "131 degrees"),
        ("blind sectors", "warning", with_lidar(range_min=0.4), {}, "0.15 m"),
        ("blind sectors", "warning", with_lidar(x=0.4), {}, "outside of the footprint"),
        ("delays", "warning", GOOD, {"latency": 0.0}, "latency"),
        ("delays", "warning", GOOD, {"scan_age": 0.15}, "scan_age = 0.2"),
        ("delays", "problem", GOOD, {"scan_age": 0.1}, "scan_age = 0.2"),
        (
            "cells",
            "warning",
            replace(GOOD, footprint=Footprint.disc(0.05)),
            {},
            "resolution = 0.0125",
        ),
        ("obstacles at rest", "warning", GOOD, {"pose_error": 0.0}, "pose_error"),
        ("obstacles at rest", "warning", GOOD, {"unseen_speed": 0.2}, "unseen_speed"),
        ("moving obstacles", "warning", with_lidar(range_max=0.7), {}, "1.5 m/s"),
        (
            "hidden people",
            "warning",
            with_limits(v_max=2.0, v_brake=0.9),
            {"hidden_speed": 2.0},
            "smaller hidden_speed",
        ),
        ("hidden people", "warning", GOOD, {"hidden_speed": 0.0}, "hidden_speed"),
    ],
)
def test_a_finding_appears_with_its_cause_and_vanishes_without_it(
    name, level, robot, changes, said
):
    one = finding(name, robot, **changes)
    assert one.level == level
    assert said in one.words()
    assert one.advice
    assert finding(name).level == "ok"


@given(st.floats(1.2, 4.0), st.floats(0.02, 0.4), st.floats(0.05, 0.2))
def test_numbers_of_advice_are_right_as_they_are_printed(v_max, period, resolution):
    robot = with_limits(v_max=v_max, v_brake=0.4)
    changes = {"period": period, "scan_age": 0.05, "resolution": resolution, "latency": 0.0}
    names = {"braking": "v_max", "delays": "scan_age", "cells": "resolution"}
    for name, key in names.items():
        told = re.search(rf"eclare {key} = ([\d.]+)", finding(name, robot, **changes).advice)
        if told is None:
            continue
        value = float(told[1])
        slower = with_limits(v_max=value, v_brake=0.4) if key == "v_max" else robot
        after = changes if key == "v_max" else changes | {key: value}
        assert f"{key} =" not in finding(name, slower, **after).advice


@given(st.floats(1e-3, 1e3))
def test_numbers_of_advice_are_rounded_to_the_right_side(value):
    low, high = float(at_most(value)), float(at_least(value))
    assert low <= value * (1.0 + 1e-6)
    assert value * (1.0 - 1e-6) <= high
    assert high - low <= 0.1001 * value


def test_a_robot_that_sees_nothing_ahead_is_not_told_to_stand_still():
    one = finding("braking", with_lidar(range_max=0.3))
    assert one.level == "problem"
    assert one.advice == "Take a lidar with a larger range_max."


def test_beams_are_enough_for_a_stop_that_is_as_short_as_is_told():
    few = {"lidar": GOOD.lidar._replace(beams=30)}
    one = finding("beams", replace(GOOD, **few))
    stop = float(re.search(r"or stop within ([\d.]+) m", one.advice)[1])
    robot = replace(GOOD, limits=GOOD.limits._replace(v_max=0.5), **few)
    delays = {"latency": 0.0, "period": 0.01}
    way = finding("braking", robot, **delays).values["stop"]
    assert (way <= stop) == (finding("beams", robot, **delays).level == "ok")


@pytest.mark.parametrize(
    ("more", "level"), [(-0.04, "problem"), (0.04, "warning"), (0.12, "ok"), (0.5, "ok")]
)
def test_a_door_is_too_narrow_tight_or_wide_enough(more, level):
    width = ways_of(GOOD, configured("default", DECLARED)).drive + more
    one = finding("doors", grid=room(width))
    assert one.level == level
    assert "the map's only passage: " in one.text or "the map's only passage, as" in one.text
    assert "(2.9" in one.text or "(3.0" in one.text
    if level == "problem":
        wider = finding("doors", replace(GOOD, footprint=Footprint.disc(0.1)), room(width))
        assert wider.level == "ok"


def test_a_robot_that_fits_but_cannot_turn_is_told_so():
    long = replace(
        GOOD, footprint=Footprint.polygon([(0.6, 0.2), (-0.6, 0.2), (-0.6, -0.2), (0.6, -0.2)])
    )
    assert "cannot turn" in finding("doors", long, room(0.8)).text
    assert "cannot turn" not in finding("doors", long, room(1.8)).text


def test_a_coarse_map_is_named():
    coarse = OccupancyGrid(np.zeros((20, 20), np.int8), 0.3)
    assert finding("cells", grid=coarse).level == "warning"


@given(st.integers(0, 10**9))
def test_any_legal_robot_and_settings_are_checked_in_finite_words(seed):
    random = np.random.default_rng(seed)

    def drawn(cls, **fixed):
        """Any legal numbers, for a NamedTuple of settings."""
        values = {}
        for name, hint in get_type_hints(cls, include_extras=True).items():
            bounds = get_args(hint)[1] if get_origin(hint) is Annotated else None
            if (
                bounds is not None
                and math.isfinite(bounds.high)
                and get_args(hint)[0] in (int, float)
            ):
                share = random.choice([0.0, 1.0, random.random(), 0.01 * random.random()])
                values[name] = get_args(hint)[0](bounds.low + share * (bounds.high - bounds.low))
        return cls(**{**values, **fixed})

    x, y = random.uniform(0.02, 2.0, 2)
    shape = random.choice([Footprint.disc(x), box(2.0 * x, 2.0 * y)])
    limits = drawn(Limits)
    limits = limits._replace(
        v_least=min(limits.v_least, 0.5 * limits.v_max),
        omega_least=min(limits.omega_least, 0.5 * limits.omega_max),
    )
    robot = Robot("any", limits, shape, drawn(Lidar, range_min=0.05))
    check = check_robot(robot, drawn(NavigatorConfig), room(1.0), timed=False)
    assert len(check.findings) == 11
    for one in check.findings:
        assert one.level in LEVELS
        assert (one.level == "ok") == (one.advice == ""), one
        assert not re.search(r"\b(nan|inf)\b|-0\.0+ ", one.words()), one
        assert all(math.isfinite(value) for value in one.values.values()), one


@pytest.mark.parametrize(("slow", "level"), [(20.0, "ok"), (70.0, "warning"), (130.0, "problem")])
def test_ticks_are_judged_by_the_period(slow, level):
    times = np.full(100, 10.0)
    times[:20] = slow
    assert loop(times, 0.1).level == level
    assert loop(times, 1.0).level == "ok"


def test_one_slow_tick_of_a_hundred_is_no_problem():
    times = np.full(100, 10.0)
    times[3] = 500.0
    assert loop(times, 0.1).level == "ok"


def test_ticks_are_measured_with_the_robot_and_its_period():
    check = check_robot(GOOD, NavigatorConfig(period=1.0))
    [one] = [one for one in check.findings if one.name == "loop"]
    assert one.values["period"] == 1.0
    assert 0.0 < one.values["median_ms"] <= one.values["slow_ms"]


@pytest.mark.parametrize(
    "given", [("pioneer3dx",), (GOOD, {"period": 0.1}), (GOOD, NavigatorConfig(), "map.yaml")]
)
def test_what_is_no_robot_no_settings_or_no_map_is_refused(given):
    with pytest.raises(InputError, match="expected"):
        check_robot(*given)


def test_the_worst_level_counts():
    assert worst("ok") == "ok"
    assert worst(*LEVELS) == "problem"

"""The suite navground: its worlds are navground's, and navground's record decides on contacts."""

import math
import sys

import numpy as np
import pytest

from dynastar.bench.missions import Mission, Options
from dynastar.bench.suites import load_suite
from dynastar.errors import DataError
from dynastar.geometry import Pose2D, Twist
from scripted import Still


def test_without_navground_one_clear_line(monkeypatch):
    for name in [name for name in sys.modules if "navground" in name]:
        monkeypatch.delitem(sys.modules, name)
    monkeypatch.setitem(sys.modules, "navground", None)
    with pytest.raises(DataError, match="the suite navground needs the package navground"):
        load_suite("navground")


pytest.importorskip("navground", reason="needs navground: pip install '.[navground]'")

from navground.core import Disc, Pose2  # noqa: E402

from dynastar.bench.suites import navground as suite  # noqa: E402
from dynastar.bench.suites.navground_world import NavgroundWorld, Watched, drive_agent  # noqa: E402

OPTIONS = Options()
PLACES = {"Cross": 0, "Corridor": 1, "Antipodal": 2}


def world(number, place=None, obstacle=None):
    """The world of a mission, its robot elsewhere if that is said, with one more obstacle."""
    inner = suite.make_world(Mission(number), OPTIONS)
    if place is not None:
        inner.agents[0].pose = Pose2(place, 0.0)
    if obstacle is not None:
        inner.add_obstacle(Disc(obstacle, 0.5))
    watched = Watched(inner, suite.STEP)
    scenario = suite.scenario(Mission(number), OPTIONS, 0)
    agent = watched.agent
    start = Pose2D(*map(float, agent.position), float(agent.orientation))
    return NavgroundWorld(scenario, start, 0, watched), watched


def test_missions_have_all_scenarios_and_behaviors():
    assert len({suite.names_of(Mission(number)) for number in range(12)}) == 12


@pytest.mark.parametrize("place", PLACES)
def test_the_robot_is_one_agent_among_those_of_its_scenario(place):
    made, watched = world(PLACES[place])
    wanted = suite.SCENARIOS[place]
    assert len(made.movers) == len(made.mover_radii) == wanted.others
    assert made.contact == ""
    assert made.clearance > 0.0
    assert len(made.scan().ranges) == 360
    goal = suite.scenario(Mission(PLACES[place]), OPTIONS, 0).goals[0]
    assert math.dist(goal[:2], watched.position) > 3.0


def test_the_corridor_has_its_walls_on_the_map_and_the_goal_between_them():
    made = suite.scenario(Mission(1), OPTIONS, 0)
    x, y, _ = made.start
    (goal,) = made.goals
    assert (abs(goal.x - x), goal.y) == (pytest.approx(11.0), 2.0)
    for there in (-0.02, 4.02):
        assert made.grid.occupied[made.grid.world_to_cell(x, there)]
    assert not made.grid.occupied[made.grid.world_to_cell(x, y)]
    assert not suite.scenario(Mission(0), OPTIONS, 0).grid.occupied.any()


def test_the_robot_does_as_it_is_told_and_others_move():
    made, _ = world(2)
    start, before = made.pose, made.movers
    for _ in range(10):
        made.step(Twist(0.5, 0.0), 0.1)
    assert made.time == pytest.approx(1.0)
    assert math.dist(made.pose[:2], start[:2]) == pytest.approx(0.5, abs=1e-4)
    assert made.twist == pytest.approx((0.5, 0.0), abs=1e-6)
    assert np.hypot(*(made.movers - before).T).max() > 0.3


def test_speeds_and_scans_are_those_of_now():
    made, _ = world(0, (-9.0, 0.0), (-7.0, 0.0))
    for v in (0.2, 0.5, 0.4):
        made.step(Twist(v, 0.1), 0.1)
        assert made.twist == pytest.approx((v, 0.1), abs=1e-3)
        scan = made.scan()
        assert scan.stamp == made.time
        gap = float(np.nanmin(scan.readings()))
        assert gap == pytest.approx(math.dist(made.pose[:2], (-7.0, 0.0)) - 0.5, abs=0.04)


def test_the_corridor_goes_on_where_navground_takes_the_agent_back():
    made, watched = world(1, (13.7, 2.0))
    for _ in range(10):
        made.step(Twist(0.8, 0.0), 0.1)
    assert watched.agent.position[0] < 1.0
    assert made.pose.x == pytest.approx(13.7 + 0.8, abs=1e-3)
    assert (np.abs(made.movers[:, 0] - made.pose.x) <= 7.0 + 1e-6).all()


def test_a_touch_is_in_navgrounds_record_and_ends_the_world():
    made, _ = world(0, (-9.0, 0.0), (-7.5, 0.0))
    while not made.contact and made.time < 2.0:
        made.step(Twist(0.8, 0.0), 0.1)
    assert (made.contact, made.clearance) == ("moving", 0.0)
    assert made.pose.x == pytest.approx(-8.25, abs=0.1)
    stopped = made.time
    made.step(Twist(0.8, 0.0), 0.1)
    assert made.time == stopped


def test_a_row_has_navgrounds_behaviors_beside_the_controller(monkeypatch):
    monkeypatch.setattr(suite, "TIME_LIMIT", 1.0)
    monkeypatch.setattr(suite, "controller_named", lambda name: Still)
    seen = []
    options = Options(controller="given", observe=lambda *args: seen.append(args))
    row = suite.run_mission(Mission(5), options, 0)
    assert (row["group"], row["others"], row["outcome"]) == ("Antipodal", "ORCA", "timeout")
    assert row["efficacy"] == pytest.approx(0.0, abs=1e-6)
    assert list(row["beside"]) == list(suite.BEHAVIORS)
    assert row["beside"]["ORCA"]["efficacy"] > 0.3
    assert seen[0][2].outcome == "timeout"


def test_an_agent_of_navgrounds_own_arrives_at_the_same_goal():
    asked = suite.scenario(Mission(2), OPTIONS, 0)
    inner = suite.make_world(Mission(2), OPTIONS, "ORCA")
    watched = Watched(inner, suite.STEP)
    row = drive_agent(watched, asked)
    assert row["outcome"] == "arrived"
    assert math.dist(watched.position, asked.goals[0][:2]) <= asked.goal_tolerance
    assert 8.0 < row["time"] < 30.0
    assert row["contacts_moving"] == row["contacts_resting"] == 0


@pytest.mark.slow
def test_the_navigator_arrives_and_does_so_again():
    first, second = (suite.run_mission(Mission(2), OPTIONS, 0) for _ in range(2))
    assert first["outcome"] == "arrived"
    assert (first["time"], first["length"]) == (second["time"], second["length"])
    assert first["beside"] == second["beside"]

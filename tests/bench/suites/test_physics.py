"""The suite physics: the engine's robot does roughly what it is told, and touches what is there."""

import sys
from dataclasses import replace

import numpy as np
import pytest

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options
from dynastar.bench.suites import load_suite
from dynastar.errors import DataError
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.simulation import Scenario
from scripted import Still


def test_without_mujoco_one_clear_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "mujoco", None)
    for name in ("physics", "physics_world", "physics_model"):
        monkeypatch.delitem(sys.modules, f"dynastar.bench.suites.{name}", raising=False)
    with pytest.raises(DataError, match="the suite physics needs the package mujoco"):
        load_suite("physics")


pytest.importorskip("mujoco")

from dynastar.bench.suites import physics  # noqa: E402
from dynastar.bench.suites.physics_model import rectangles, solids  # noqa: E402
from dynastar.bench.suites.physics_world import PhysicsWorld  # noqa: E402

ROOM = OccupancyGrid.from_occupied(np.pad(np.zeros((58, 98), bool), 1, constant_values=True), 0.1)
POST = np.array([[6.0, 2.5], [6.4, 2.5], [6.4, 3.5], [6.0, 3.5]])
START = Pose2D(3.0, 3.0, 0.3)


def world(number=0, floor=0.9, loaded=False, start=START, **more):
    robot, body = physics.BODIES[number]
    robot = replace(robot, limits=robot.limits._replace(**physics.GENTLE))
    scenario = Scenario("test", ROOM, robot, start, (), **more)
    return PhysicsWorld(scenario, start, 0, body, floor, loaded)


def driven_for(made, command, seconds):
    for _ in range(round(seconds / 0.1)):
        made.step(Twist(*command), 0.1)
    return made


@pytest.mark.parametrize("number", range(len(physics.BODIES)))
@pytest.mark.parametrize(("floor", "loaded"), [(0.9, False), (0.3, True)])
def test_a_robot_follows_its_commands_and_comes_to_rest(number, floor, loaded):
    made = world(number, floor, loaded)
    assert made.pose == pytest.approx(START, abs=0.01)
    assert driven_for(made, (0.2, 0.0), 3.0).twist.v == pytest.approx(0.2, rel=0.15)
    assert made.pose.theta == pytest.approx(START.theta, abs=0.05)
    turned = driven_for(made, (0.0, 0.5), 3.0).twist.omega
    assert 0.3 < turned < 0.55
    assert made.wheels.omega == pytest.approx(turned, rel=0.1)
    assert made.sensed_state().twist == made.wheels
    assert driven_for(made, (0.0, 0.0), 2.0).resting
    assert made.contact == ""


def test_a_payload_makes_it_slower_to_follow():
    light, heavy = (driven_for(world(loaded=loaded), (0.5, 0.0), 0.3) for loaded in (False, True))
    assert light.twist.v > 1.3 * heavy.twist.v


def test_the_engine_finds_contacts_with_the_map_and_with_what_it_lacks():
    ahead = Pose2D(3.0, 3.0, 0.0)
    made = driven_for(world(start=ahead, obstacles=(POST,)), (0.5, 0.0), 9.0)
    assert (made.contact, made.clearance) == ("moving", 0.0)
    assert made.pose.x == pytest.approx(6.0 - 0.25, abs=0.01)
    made = driven_for(world(start=ahead), (0.5, 0.0), 15.0)
    assert made.contact == "moving"
    assert made.pose.x == pytest.approx(9.9 - 0.25, abs=0.01)


def test_clearance_is_that_of_the_footprint():
    made = driven_for(world(start=Pose2D(3.0, 1.0, 0.0)), (0.2, 0.0), 1.0)
    assert made.clearance == pytest.approx(0.9 - 0.25, abs=0.01)


def test_rectangles_cover_the_occupied_cells_once():
    random = np.random.default_rng(0)
    occupied = random.random((20, 30)) < 0.3
    covered = np.zeros((20, 30), int)
    for top, bottom, left, right in rectangles(occupied):
        covered[top:bottom, left:right] += 1
    np.testing.assert_array_equal(covered, occupied)
    assert len(rectangles(np.ones((9, 9), bool))) == 1


def test_obstacles_are_boxes_where_they_stand():
    robot = physics.BODIES[0][0]
    ring = np.array([[1.0, 1.0], [2.0, 2.0], [1.5, 2.5], [0.5, 1.5]])
    [*_, box] = solids(Scenario("test", ROOM, robot, START, (), obstacles=(ring,)))
    assert box == pytest.approx((1.25, 1.75, 0.5**0.5, 0.5 * 0.5**0.5, np.pi / 4))


def test_missions_have_all_robots_floors_and_payloads():
    made = [physics.make(0, number) for number in range(12)]
    found = {(one.robot.name, one.floor, one.loaded) for one in made}
    assert len(found) == 12


def test_a_row_says_what_the_robot_stood_on(monkeypatch):
    monkeypatch.setattr(physics, "EXTRA_TIME", 1.0)
    monkeypatch.setattr(physics, "PATIENCE", 0.0)
    monkeypatch.setattr(physics, "controller_named", lambda name: Still)
    monkeypatch.setattr(driven, "time_bound", lambda scenario: None)
    seen = []
    options = Options(controller="given", observe=lambda *args: seen.append(args))
    row = physics.run_mission(Mission(9), options, 0)
    assert (row["group"], row["map"], row["outcome"]) == ("pioneer3dx", "hall 1", "timeout")
    assert (row["floor"], row["loaded"], row["reachable"]) == (0.3, True, True)
    assert seen[0][2].outcome == "timeout"


def test_the_navigator_is_told_the_delay_of_the_motors_too():
    for number in range(12):
        made, scenario = physics.make(0, number), physics.scenario(Mission(number), Options(), 0)
        told = scenario.navigator["latency"]
        assert told >= scenario.latency + made.body.response(made.loaded) - 1e-9

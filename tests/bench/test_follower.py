"""Path following alone: decent where the map is true, blind where it is not."""

import math
from dataclasses import replace

import pytest

from driving import PERIOD, ROUND, room
from dynastar.bench import paper
from dynastar.bench.follower import Follower
from dynastar.errors import GoalOccupied
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.metrics import measure
from dynastar.navigator import NavigatorConfig, RobotState
from dynastar.simulation import Scenario, drive

WALL = (3.6, 0.0, 4.0, 4.0)


def mission(*boxes, true=None, goals=(Goal(6.5, 3.0),)):
    return Scenario(
        "follow", room(8.0, 6.0, *boxes), ROUND, (1.5, 3.0, 0.0), goals, world=true, time_limit=90.0
    )


def followed(scenario):
    episode = drive(scenario, navigator=Follower)
    return episode, measure(episode)


def test_it_drives_straight_across_and_slows_down_for_the_goal():
    episode, found = followed(mission())
    assert (found.outcome, found.turning_points, found.replans) == ("arrived", 0, 0)
    assert found.length == pytest.approx(5.0, abs=0.3)
    assert episode.trajectory.twists[:, 0].max() > 0.8
    assert math.dist(episode.trajectory.poses[-1, :2], (6.5, 3.0)) < 0.25


def test_it_goes_round_what_the_map_has_and_turns_in_place():
    _, found = followed(mission(WALL, goals=(Goal(6.5, 1.5), Goal(6.5, 4.5))))
    assert found.outcome == "arrived"
    assert found.length > 7.0
    assert found.min_clearance > 0.02


@pytest.mark.parametrize("number", range(3))
def test_it_arrives_where_the_suites_worlds_are_as_their_maps(number):
    scenario = paper.world(7, number)
    assert isinstance(scenario, Scenario)
    _, found = followed(replace(scenario, obstacles=(), movers=()))
    assert found.outcome == "arrived"
    assert 25.0 < found.length < 45.0
    assert found.time < 120.0


def test_it_drives_into_what_the_map_does_not_have():
    episode, found = followed(mission(true=room(8.0, 6.0, WALL)))
    assert (found.outcome, found.contacts_moving) == ("contact", 1)
    assert len(episode.plans) == 1


def test_its_commands_keep_the_limits():
    follower = Follower(room(), ROUND, NavigatorConfig())
    follower.set_goal(Goal(2.0, 5.0))
    twist, limits = Twist(0.9, 0.0), ROUND.limits
    command = follower.command(RobotState(0.0, Pose2D(4.0, 3.0, 0.0), twist))
    assert command.v == pytest.approx(twist.v - limits.v_brake * PERIOD)  # a target behind
    assert command.omega == pytest.approx(limits.omega_accel * PERIOD)


def test_no_plan_is_said():
    with pytest.raises(GoalOccupied):
        followed(mission(WALL, goals=(Goal(3.8, 2.0),)))
    _, found = followed(mission((3.6, 0.0, 4.0, 6.0)))
    assert found.outcome == "blocked"

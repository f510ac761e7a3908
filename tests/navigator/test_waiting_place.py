"""Goals that only sensed obstacles keep the robot from, and goals near walls: whole missions."""

import math

import pytest

from driving import ROUND, Drive, room
from dynastar.errors import GoalObstructed, NoPath
from dynastar.geometry import Goal
from dynastar.navigator.waiting_place import WAIT_WITHIN
from dynastar.perception import MovingObstacle
from dynastar.simulation.lidar import LidarSimulator

OCCUPIED = "an obstacle occupies the goal"
GOAL = 6.0, 3.0


def drive_to(goal, *boxes, **config):
    """A drive to a goal in a room with boxes that are not on its map."""
    drive = Drive(room(), true=room(8.0, 6.0, *boxes), **config)
    drive.navigator.set_goal(Goal(*goal))
    return drive


@pytest.mark.parametrize("box", [(5.8, 2.8, 6.2, 3.2), (5.5, 2.5, 6.5, 3.5)])
def test_an_occupied_goal_is_waited_for_near_by_and_reached_once_it_is_free(box):
    drive = drive_to(GOAL, box, stuck_time=15.0, attempts=4)
    drive.for_seconds(30.0)
    assert (drive.status.state, drive.status.reason) == ("waiting", OCCUPIED)
    assert math.dist(drive.pose[:2], GOAL) < WAIT_WITHIN
    assert drive.status.recoveries <= 2
    before = drive.pose
    drive.for_seconds(20.0)
    assert math.dist(drive.pose[:2], before[:2]) < 0.1  # it stays there
    drive.lidar = LidarSimulator(ROUND.lidar, room())
    drive.until("arrived", seconds=100.0)
    assert math.dist(drive.pose[:2], GOAL) <= 0.25


@pytest.mark.parametrize("goal", [(4.2, 2.2), (5.5, 1.8), (5.8, 1.8), (6.4, 2.4)])
def test_a_robot_that_waits_stands_still(goal):
    x, y = goal
    drive = drive_to(goal, (x - 0.2, y - 0.2, x + 0.2, y + 0.2), stuck_time=60.0)
    drive.until("waiting", seconds=20.0)
    drive.for_seconds(3.0)
    turned, before = 0.0, drive.pose
    for _ in range(200):
        heading = drive.pose.theta
        drive.tick()
        turned += abs(math.remainder(drive.pose.theta - heading, math.tau))
    assert turned < 5.0
    assert math.dist(drive.pose[:2], before[:2]) < 0.1


def test_an_obstacle_at_the_goal_that_never_moves_ends_the_mission_in_time():
    drive = drive_to(GOAL, (5.8, 2.8, 6.2, 3.2))
    drive.until("waiting")
    began = drive.now
    drive.until("blocked", seconds=120.0)
    assert drive.now - began == pytest.approx(4 * 6.0, abs=6.0)
    assert drive.status.recoveries == 4
    assert OCCUPIED in drive.status.reason


@pytest.mark.parametrize("error", [GoalObstructed(OCCUPIED), NoPath("no way leads there")])
def test_a_way_that_comes_and_goes_ends_the_mission_in_time(monkeypatch, error):
    """Noise may open and shut a way: every two seconds a plan succeeds, but the robot gets nowhere."""
    drive = drive_to(GOAL, (3.0, 5.0, 3.3, 5.3))
    drive.tick()
    plan = drive.navigator.planners.plan

    def at_times(*arguments):
        if int(drive.now / 2.0) % 2:
            raise error
        return plan(*arguments)

    monkeypatch.setattr(drive.navigator.planners, "plan", at_times)
    monkeypatch.setattr(drive.navigator.route, "_is_blocked", lambda: True)
    monkeypatch.setattr(drive.navigator.planners, "mark", lambda patch: True)
    while drive.status.state != "blocked":
        drive.navigator.command(drive.state, drive.scan())  # it does not move
        drive.now += 0.1
        assert drive.now < 100.0
    assert 24.0 < drive.now < 40.0
    assert drive.status.recoveries == 4


def test_a_person_at_the_goal_is_waited_for_without_limit():
    drive = drive_to(GOAL, (5.8, 2.8, 6.2, 3.2))
    person = MovingObstacle(6.0, 3.0, 0.0, 0.0, 0.3)
    while drive.now < 90.0:
        drive.tick(movers=[person])
    assert drive.status.state == "waiting"
    drive.lidar = LidarSimulator(ROUND.lidar, room())
    while drive.status.state != "arrived" and drive.now < 130.0:
        drive.tick(movers=[])
    assert drive.status.state == "arrived"


def test_a_goal_shut_off_far_away_ends_blocked():
    drive = drive_to(GOAL, (3.5, 0.0, 3.7, 6.0), stuck_time=1.0, attempts=1)
    drive.until("blocked", seconds=30.0)
    assert "no way is left" in drive.status.reason


@pytest.mark.parametrize("box", [(), ((3.0, 1.0, 3.4, 1.4),)])
def test_a_goal_that_the_map_rules_out_is_blocked_at_once(box):
    drive = drive_to((7.95, 3.0), *box, goal_tolerance=0.2)
    drive.tick()
    assert drive.status.state == "blocked"


@pytest.mark.parametrize("goal", [(7.7, 3.0), (7.72, 5.7), (3.01, 0.25)])
def test_a_goal_a_little_too_near_a_wall_is_reached(goal):
    drive = drive_to(goal)
    drive.until("arrived")
    assert math.dist(drive.pose[:2], goal) <= 0.25
    assert drive.status.recoveries == 0


def test_a_goal_that_is_taken_by_a_small_box_is_reached_beside_it():
    drive = drive_to(GOAL, (6.1, 3.1, 6.3, 3.3), goal_tolerance=0.4)
    drive.until("arrived")
    assert math.dist(drive.pose[:2], GOAL) <= 0.4

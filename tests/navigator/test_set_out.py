"""Goals and paths that are sent again while the robot drives, as behaviour trees do."""

import math

import numpy as np
import pytest

from driving import Drive, room
from dynastar.geometry import Goal

GOAL = Goal(6.5, 3.0)
SHUT_IN = room(8.0, 6.0, (3.0, 0.0, 3.5, 6.0))  # a wall that no map shows


def ticks_until_over(drive, again, every, seconds=90.0):
    """Calls ``again`` every few ticks; the final state."""
    k = 0
    while drive.status.state not in ("arrived", "blocked"):
        if k % every == 0:
            again(drive)
        drive.tick()
        assert drive.now < seconds, (drive.status.state, drive.status.reason)
        k += 1
    return drive.status.state


def test_goals_sent_again_in_every_tick_change_nothing():
    alone, again = Drive(room()), Drive(room())
    alone.navigator.set_goal([GOAL, (2.0, 2.0, 1.0)])
    alone.until("arrived")
    left = {2: [GOAL, (2.0, 2.0, 1.0)], 1: (2.0, 2.0, 1.0)}
    again.navigator.set_goal(left[2])
    ticks_until_over(again, lambda one: one.navigator.set_goal(left[one.status.goals_left]), 1)
    assert again.now == alone.now
    assert again.pose == alone.pose
    assert again.status.plan_id == alone.status.plan_id


def test_a_goal_sent_again_ends_blocked_where_no_way_is_left():
    drive = Drive(room(), true=SHUT_IN)
    assert ticks_until_over(drive, lambda one: one.navigator.set_goal(GOAL), 1) == "blocked"
    drive.navigator.set_goal(GOAL)  # and can be tried anew
    assert drive.status.state == "following"


def test_another_goal_begins_anew():
    drive = Drive(room())
    drive.navigator.set_goal(GOAL)
    drive.for_seconds(1.0)
    drive.navigator.set_goal((2.0, 4.5))
    drive.until("arrived")
    assert math.dist(drive.pose[:2], (2.0, 4.5)) <= 0.3


def from_here(drive):
    """The rest of the way as a planner would send it now: to the same end, from the robot."""
    drive.navigator.follow(np.linspace(drive.pose[:2], GOAL[:2], 20), 0.5)


@pytest.mark.parametrize("every", [1, 10])
def test_a_path_sent_anew_is_driven_to_its_end(every):
    drive = Drive(room())
    assert ticks_until_over(drive, from_here, every) == "arrived"
    assert drive.pose.theta == pytest.approx(0.5, abs=0.15)


@pytest.mark.parametrize("every", [1, 10])
def test_a_path_sent_anew_ends_blocked_where_the_robot_makes_no_progress(every):
    drive = Drive(room(), true=SHUT_IN)
    assert ticks_until_over(drive, from_here, every) == "blocked"


def test_a_goal_in_place_of_a_path_is_planned():
    drive = Drive(room())
    drive.navigator.follow([drive.pose[:2], (1.5, 5.0), GOAL[:2]])
    drive.for_seconds(1.0)
    drive.navigator.set_goal(GOAL)
    drive.until("arrived")
    assert drive.status.plan is not None

"""The cost-to-go in place of the heading to a target."""

import math

import numpy as np
import pytest

from driving import ROUND, room
from dynastar.bench.controllers.printed import Trajectories
from dynastar.bench.controllers.printed_cost_to_go import EVERY, PrintedCostToGo
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.navigator import RobotState, configured

HERE = Pose2D(2.0, 3.0, 0.0)


def driver(*boxes, goal=(6.0, 3.0)):
    made = PrintedCostToGo(room(8.0, 6.0, *boxes), ROUND, configured("paper"))
    made.set_goal(Goal(*goal))
    return made


def nearer(made, *ends, stamp=0.0):
    x, y = np.array(ends, float).T
    state = RobotState(stamp, HERE, Twist(0.0, 0.0))
    return made.towards(state, Trajectories(x, y, np.zeros_like(x)), np.array([[6.0, 3.0]]))


def test_without_obstacles_it_is_how_much_nearer_the_goal_is():
    ends = (3.0, 3.0), (2.5, 3.5), (2.0, 3.0), (1.0, 3.0)
    told = [math.dist(HERE[:2], (6.0, 3.0)) - math.dist(end, (6.0, 3.0)) for end in ends]
    assert nearer(driver(), *ends) == pytest.approx(np.maximum(told, 0.0), abs=0.08)


def test_behind_a_wall_the_way_round_counts():
    made = driver((4.0, 2.0, 4.2, 5.9))  # open at the low end
    ahead, round_it = nearer(made, (3.0, 3.0), (2.7, 2.3))
    assert round_it > ahead + 0.1


def test_it_is_made_anew_for_another_goal_and_after_a_while():
    made = driver()
    assert nearer(made, (3.0, 3.0))[0] > 0.9
    made.set_goal(Goal(1.0, 3.0))
    assert nearer(made, (3.0, 3.0), stamp=0.1)[0] == 0.0
    cell = made.costmap.resolution  # a wall that is open at its low end
    made.costmap.blocked[round(1.5 / cell) :, round(1.5 / cell)] = True
    assert nearer(made, (2.0, 2.5), stamp=0.2)[0] == 0.0
    assert nearer(made, (2.0, 2.5), stamp=0.2 + EVERY)[0] > 0.3

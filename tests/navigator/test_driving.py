"""What driving keeps from tick to tick, and the scene that it makes."""

import math

import numpy as np
import pytest

from driving import LIMITS, room, under_way
from dynastar.dwa.scene import AT_REST
from dynastar.footprint import Footprint
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import NavigatorConfig
from dynastar.navigator.admissibility import Admissibility
from dynastar.perception.prediction import DISCOUNTED
from dynastar.robot import Lidar, Robot


def test_another_map_of_the_same_yaw_keeps_manoeuvre_and_line():
    drive = under_way()
    last, guide = drive.navigator.driving._last, drive.navigator.driving.guide
    assert last.v > 0.0
    drive.navigator.set_map(room(8.0, 6.0, (4.0, 0.0, 4.3, 1.0)))
    assert drive.navigator.driving._last == last
    assert drive.navigator.driving.guide is guide
    turned = OccupancyGrid(room().values, GridFrame(0.1, 0.0, 0.0, 0.1))
    drive.navigator.set_map(turned)
    assert drive.navigator.driving._last == AT_REST
    assert drive.navigator.driving.guide is None


def test_the_lookahead_is_what_can_be_driven_within_the_roll_outs():
    drive = under_way(latency=0.2)
    begin, step, steps, discounted = drive.navigator.driving.times
    assert (begin, discounted) == (0.2, DISCOUNTED)  # it brakes within 4 s
    horizon = drive.navigator.config.dwa.horizon + 0.5 * LIMITS.v_max / LIMITS.v_brake
    assert step * steps == pytest.approx(horizon, abs=8 * step)
    assert drive.navigator.driving.lookahead == pytest.approx(LIMITS.v_max * step * steps)


def test_a_robot_that_brakes_slowly_discounts_later_contacts_less():
    robot = Robot("slow brakes", LIMITS._replace(v_brake=0.1), Footprint.disc(0.3), Lidar(90, 3.0))
    assert Admissibility(robot, NavigatorConfig()).times.discounted == 0.5 * LIMITS.v_max / 0.1


def scene_on(grid):
    """The scene of a tick of a drive on a grid."""
    drive, made = under_way(), []
    drive.navigator.set_map(grid)
    make = drive.navigator.driving.scene
    drive.navigator.driving.scene = lambda *given: made.append(make(*given)) or made[-1]
    drive.for_seconds(0.1)
    return made[-1], drive


def test_a_speed_limit_ahead_is_slowed_down_for_in_time():
    plain, limits = room(), np.full(room().values.shape, np.inf, np.float32)
    assert scene_on(plain)[0].v_cap == LIMITS.v_max
    limits[:, 30:] = 0.2  # from x = 3 m on
    scene, drive = scene_on(OccupancyGrid(plain.values, plain.frame, None, limits))
    room_left = 3.0 - drive.pose.x
    assert room_left > 0.2
    assert 0.2 < scene.v_cap <= math.sqrt(0.2**2 + 2.0 * 0.7 * LIMITS.v_brake * room_left) + 0.1


def test_the_margin_grows_with_the_heading_error_and_the_way_of_a_stop():
    steady, unsure = under_way(), under_way(heading_error=0.05)
    margins = []
    for drive in (steady, unsure):
        made = []
        make = drive.navigator.driving.scene
        drive.navigator.driving.scene = lambda *given, make=make, made=made: (
            made.append(make(*given)) or made[-1]
        )
        drive.for_seconds(0.1)
        margins.append((made[-1].around.margin_to_closed, drive))
    assert margins[0][0] == pytest.approx(steady.navigator.driving.margin)
    v = unsure.twist.v
    stop = v * v / (2.0 * LIMITS.v_brake) + 2.0 * v * unsure.navigator.config.period
    assert margins[1][0] == pytest.approx(unsure.navigator.driving.margin + 0.05 * stop, abs=0.01)

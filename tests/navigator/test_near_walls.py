"""Starts and ways beside walls, of robots that fit there only at some headings."""

import math

import numpy as np
import pytest

from driving import Drive, room
from dynastar.footprint import Footprint
from dynastar.geometry import Goal
from dynastar.robot import ROBOTS, Lidar, Limits, Robot
from dynastar.simulation.contact import Solids

WALL = 0.1  # m, the room's walls are as thick as a cell
LIDAR = Lidar(720, math.tau, 0.05, 10.0)
NOSE = [(0.85, -0.25), (0.85, 0.25), (-0.15, 0.25), (-0.15, -0.25)]  # the axle is at the back
CART = Robot(
    "cart", Limits(0.6, 1.0, 1.0, 2.0, 1.0, 2.0, v_min=-0.3), Footprint.polygon(NOSE), LIDAR
)
JACKAL = Robot("jackal", ROBOTS["jackal"].limits, ROBOTS["jackal"].footprint, LIDAR)


def arrives(drive, known, goal, seconds):
    """Drives to a goal; the smallest gap to anything on the way (m)."""
    solids, nearest = Solids(known), math.inf
    drive.navigator.set_goal(Goal(*goal))
    while drive.status.state != "arrived":
        assert drive.now < seconds, (drive.status.state, drive.status.reason, drive.pose)
        drive.tick()
        nearest = min(nearest, solids.gap(drive.pose, drive.robot.footprint))
    return nearest


@pytest.mark.parametrize("end", [2.5, 4.0])
def test_a_robot_with_a_long_nose_passes_the_end_of_a_wall_beside_it(end):
    """Its axle turns in past the wall's end; the disc round the axle would touch the wall, 0.35 m away."""
    known = room(9.0, 6.0, (end, 3.6, 9.0, 3.8))
    drive = Drive(known, CART, pose=(1.2, 3.0, 0.0))
    assert arrives(drive, known, (7.0, 3.0), 30.0) > 0.0


@pytest.mark.parametrize("gap", [0.04, 0.06])
@pytest.mark.parametrize("heading", [0.0, math.pi])
def test_a_robot_that_is_parked_alongside_a_wall_drives_off(gap, heading):
    y = WALL + gap + float(np.abs(JACKAL.footprint.vertices[:, 1]).max())
    known = room()
    drive = Drive(known, JACKAL, pose=(3.0, y, heading))
    assert arrives(drive, known, (5.0, 3.0), 40.0) > 0.0

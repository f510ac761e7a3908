"""A navigator called by hand, and a robot that does exactly as told."""

import math

import numpy as np

from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import Navigator, NavigatorConfig, RobotState
from dynastar.robot import Lidar, Limits, Robot, arc, slew
from dynastar.scan import LaserScan
from dynastar.simulation.lidar import LidarSimulator

REST = Twist(0.0, 0.0)
PERIOD = 0.1
CELL = 0.1
LIMITS = Limits(1.0, 1.5, 0.8, 2.0, 0.8, 2.0)
ROUND = Robot("round", LIMITS, Footprint.disc(0.25), Lidar(360, math.tau, 0.0, 6.0))


def room(width=8.0, height=6.0, *boxes):
    """A room's map with boxes (x0, y0, x1, y1) in metres that stand in it."""
    occupied = np.zeros((round(height / CELL), round(width / CELL)), bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    for box in boxes:
        x0, y0, x1, y1 = (round(metres / CELL) for metres in box)
        occupied[y0:y1, x0:x1] = True
    return OccupancyGrid(occupied, GridFrame(CELL))


def driven(robot, pose, twist, command, duration):
    """Pose and twist of a robot that does exactly as told, after some seconds."""
    limits = robot.limits
    after = Twist(
        slew(twist.v, command.v, limits.v_accel, limits.v_brake, duration),
        slew(twist.omega, command.omega, limits.omega_accel, limits.omega_brake, duration),
    )
    mean = Twist(*(0.5 * (a + b) for a, b in zip(twist, after, strict=True)))
    return arc(pose, mean, duration), after


class Drive:
    """A navigator and a robot that does exactly as told, in a true room."""

    def __init__(self, known, robot=ROUND, pose=(1.5, 3.0, 0.0), true=None, **config):
        self.navigator = Navigator(known, robot, NavigatorConfig(**config))
        self.lidar = LidarSimulator(robot.lidar, known if true is None else true)
        self.robot, self.pose, self.twist, self.now = robot, Pose2D(*pose), REST, 0.0

    @property
    def state(self):
        return RobotState(self.now, self.pose, self.twist)

    @property
    def status(self):
        return self.navigator.status

    def scan(self):
        return self.lidar.scan(self.pose, self.now)

    def tick(self, *scans, **more):
        """One command on the scans given (the lidar's if none is), carried out for one period."""
        command = self.navigator.command(self.state, scans or self.scan(), **more)
        self.carry_out(command)
        return command

    def carry_out(self, command, parts=10):
        for _ in range(parts):
            self.pose, self.twist = driven(
                self.robot, self.pose, self.twist, command, PERIOD / parts
            )
        self.now += PERIOD

    def until(self, *states, seconds=60.0):
        """Drives until the navigator says one of ``states``; the states it went through."""
        said = []
        while not said or said[-1] not in states:
            assert self.now < seconds, (self.status.state, self.status.reason, self.pose)
            self.tick()
            said.append(self.status.state)
        return said

    def for_seconds(self, seconds):
        return [self.tick() for _ in range(round(seconds / PERIOD))]


def under_way(**more):
    """A drive across the room that has got up speed."""
    drive = Drive(room(), **more)
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.for_seconds(1.5)
    assert drive.twist.v > 0.4
    return drive


def with_ranges(scan, ranges, **more):
    given = {**vars(scan), "ranges": np.asarray(ranges, np.float32), **more}
    return LaserScan(**given)

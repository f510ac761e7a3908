"""Compiling or loading what commands call, so that none of them has to wait for it.

A throwaway navigator drives in an empty room; what the user's own would be given does not matter, for
kernels differ in the types of their arguments only.
"""

import math
from collections.abc import Sequence
from typing import Protocol

import numpy as np
import numpy.typing as npt

from dynastar.geometry import Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator.status import RobotState
from dynastar.path import Path
from dynastar.robot import arc
from dynastar.scan import LaserScan

LENGTH, WIDTH, CELL = 12.0, 8.0, 0.2  # m, of a room with nothing on its map
TICKS, TURNING, PERIOD = 30, 3, 0.1  # s
BOX = (5.0, 4.0, 0.4)  # x, y, radius in metres of what stands in the way
WALKER = (8.0, 2.5, 0.3)  # the same, at the beginning, of a person who walks towards the robot
PACE = 1.0  # m/s
BEAMS = 360

ROOM = OccupancyGrid(np.zeros((round(WIDTH / CELL), round(LENGTH / CELL)), dtype=np.int8), CELL)

Point = tuple[float, float]


class Driver(Protocol):
    """The interface of Navigator that the warm-up uses."""

    def set_goal(self, goal: Sequence[float]) -> None:
        """Takes a goal."""

    def command(self, state: RobotState, scan: LaserScan) -> Twist:
        """The twist to drive."""


class Straight:
    """A planner that needs no kernels: straight to the goal, whatever stands there."""

    def plan(self, grid: OccupancyGrid, start: Point, goal: Point, radius: float) -> Path:
        """The straight line."""
        return Path(np.array([start, goal]))


def drive_a_little(driver: Driver) -> None:
    """Three seconds round something that is not on the map and past a walker, then a turn on the spot."""
    driver.set_goal((10.5, 4.0))
    pose, twist = Pose2D(1.5, 4.0, 0.0), Twist(0.0, 0.0)
    for tick in range(TICKS + TURNING):
        if tick == TICKS:
            driver.set_goal((pose.x, pose.y, pose.theta + 1.0))
        stamp = tick * PERIOD
        twist = driver.command(RobotState(stamp, pose, twist), _scan(pose, stamp))
        pose = arc(pose, twist, PERIOD)


def _scan(pose: Pose2D, stamp: float) -> LaserScan:
    """Scan of a lidar at ``pose`` of the walls, the box and the walker."""
    increment = math.tau / BEAMS
    angles = pose.theta - math.pi + increment * np.arange(BEAMS)
    along = np.stack([np.cos(angles), np.sin(angles)])
    here = np.array([[pose.x], [pose.y]])
    with np.errstate(divide="ignore"):
        walls = (np.where(along > 0.0, [[LENGTH], [WIDTH]], 0.0) - here) / along
    ranges = walls.min(axis=0)
    for x, y, radius in (BOX, (WALKER[0] - PACE * stamp, *WALKER[1:])):
        ranges = np.minimum(ranges, _to_disc(np.array([[x], [y]]) - here, along, radius))
    return LaserScan(stamp, ranges.astype(np.float32), -math.pi, increment, 0.0, 10.0)


def _to_disc(
    centre: npt.NDArray[np.float64], along: npt.NDArray[np.float64], radius: float
) -> npt.NDArray[np.float64]:
    """Ranges (m) of beams (2, n) to a disc about ``centre`` (2, 1); inf for a miss."""
    ahead = (centre * along).sum(axis=0)
    half_chord = radius**2 - ((centre**2).sum(axis=0) - ahead**2)
    meets = (ahead > 0.0) & (half_chord > 0.0)
    return np.where(meets, ahead - np.sqrt(np.maximum(half_chord, 0.0)), np.inf)

"""What drives, odometry, lidars and loops of the suite ``robots`` do, and what their users declare.

Ranges, with the reports that they are taken from (issues on GitHub); the others are assumptions:

- latency up to 0.2 s: yujinrobot/kobuki#389 (0.2 s; ros-navigation/navigation2#6139 has 0.36 s);
- dead band of v up to 0.03 m/s: iRobotEducation/create3_docs#404; of omega up to 0.1 rad/s: assumed;
- steady gain of omega from 0.95 on: mowglinext/mowglinext#530; up to 1.1, and that of v, assumed;
- readings that change by some per cent from scan to scan: ldrobotSensorTeam/ldlidar_stl_ros2#11
  (447 to 461);
- posts in view: turtlebot/turtlebot4#485, ROBOTIS-GIT/turtlebot3#501;
- periods that are longer than told: ros-navigation/navigation2#4759; by how much is assumed;
- lag, slip, odometry, errors of ranges and poses, rounding: assumed.

A careful user declares a latency that is no less than delay and lag together, the bounds of the errors,
what the driver of the lidar writes for no return, and the period that was asked for. Gains, dead bands,
slip, jitter and posts are not declared: nothing tells their user.
"""

import math
from dataclasses import replace
from typing import NamedTuple

import numpy as np

from dynastar.bench.suites.robots_sold import SoldRobot
from dynastar.robot import Robot
from dynastar.simulation import ControlLoop, Drivetrain, LidarDriver, Noise, Odometry

Random = np.random.Generator

GAIN_V, GAIN_OMEGA = (0.95, 1.05), (0.95, 1.1)
LAG, LATENCY = (0.0, 0.1), (0.02, 0.2)  # s
DEADBAND_V, DEADBAND_OMEGA = (0.01, 0.03), (0.02, 0.1)  # m/s, rad/s, in half of the missions
SLIP = (0.0, 0.05)
ODOMETRY = (0.97, 1.03)
RANGE_ERROR, POSE_ERROR, HEADING_ERROR = (0.005, 0.03), (0.0, 0.02), (0.0, 0.01)  # m, m, rad
ROUNDINGS = (0.0, 0.001, 0.01)  # m
FEWEST = 0.96  # of the readings, in half of the missions of lidars that vary
NOTHING = (math.inf, math.nan, 0.0, 65.535)  # what drivers write for no return (m)
PERIODS = (0.05, 0.1, 0.2)  # s
JITTER = (0.0, 0.5)  # of the period
DECLARED_STEP = 0.05  # s, to which a declared latency is rounded up


class Hardware(NamedTuple):
    """What the hardware of a mission does; ``period`` (s) is told, ``latency`` (s) is true."""

    drive: Drivetrain
    odometry: Odometry
    lidar: LidarDriver
    loop: ControlLoop
    noise: Noise
    latency: float
    period: float

    @property
    def declared(self) -> dict[str, float]:
        """Settings of the navigator that a careful user gives."""
        delay = self.latency + self.drive.lag
        latency = DECLARED_STEP * math.ceil(delay / DECLARED_STEP - 1e-9)
        return {"period": self.period, "latency": round(latency, 6)}


def as_declared(robot: Robot, hardware: Hardware) -> Robot:
    """The robot with the driver's value for no return declared."""
    nothing = hardware.lidar.nothing
    codes = () if math.isinf(nothing) else (nothing,)
    return replace(robot, lidar=robot.lidar._replace(nothing=codes))


def draw_hardware(sold: SoldRobot, random: Random) -> Hardware:
    """Draws what the hardware of a robot does."""
    latency, period = _within(LATENCY, random), float(random.choice(PERIODS))
    sticks = random.random() < 0.5
    drive = Drivetrain(
        gain_v=_within(GAIN_V, random),
        gain_omega=_within(GAIN_OMEGA, random),
        lag=_within(LAG, random),
        deadband_v=_within(DEADBAND_V, random) if sticks else 0.0,
        deadband_omega=_within(DEADBAND_OMEGA, random) if sticks else 0.0,
        slip=_within(SLIP, random),
        latency_jitter=random.uniform(0.0, latency),
    )
    noise = Noise(*(_within(bounds, random) for bounds in (RANGE_ERROR, POSE_ERROR, HEADING_ERROR)))
    return Hardware(
        drive,
        Odometry(_within(ODOMETRY, random), _within(ODOMETRY, random)),
        _driver(sold, random),
        ControlLoop(jitter=_within(JITTER, random) * period),
        noise,
        latency,
        period,
    )


def _driver(sold: SoldRobot, random: Random) -> LidarDriver:
    beams = sold.robot.lidar.beams
    varies = random.random() < 0.5 and sold.varies
    return LidarDriver(
        nothing=float(random.choice(NOTHING)),
        readings=(round(FEWEST * beams), beams) if varies else None,
        rounding=float(random.choice(ROUNDINGS)),
        posts=sold.posts,
    )


def _within(bounds: tuple[float, float], random: Random) -> float:
    return float(random.uniform(*bounds))

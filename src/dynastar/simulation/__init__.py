"""Simulation: a true world, what is sensed of it, and missions run in it."""

from dynastar.simulation.faults import Fault
from dynastar.simulation.imperfections import (
    ControlLoop,
    Drivetrain,
    LidarDriver,
    Odometry,
    Post,
)
from dynastar.simulation.run import Controller, drive, run
from dynastar.simulation.scenario import Mover, Noise, Pedestrian, Scenario
from dynastar.simulation.warming import warm_up
from dynastar.simulation.world import World

__all__ = [
    "ControlLoop",
    "Controller",
    "Drivetrain",
    "Fault",
    "LidarDriver",
    "Mover",
    "Noise",
    "Odometry",
    "Pedestrian",
    "Post",
    "Scenario",
    "World",
    "drive",
    "run",
    "warm_up",
]

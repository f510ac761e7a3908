"""Simulation: a true world, what is sensed of it, and missions run in it."""

from dynastar.simulation.faults import Fault
from dynastar.simulation.run import Controller, drive, run
from dynastar.simulation.scenario import Mover, Noise, Pedestrian, Scenario
from dynastar.simulation.warming import warm_up
from dynastar.simulation.world import World

__all__ = [
    "Controller",
    "Fault",
    "Mover",
    "Noise",
    "Pedestrian",
    "Scenario",
    "World",
    "drive",
    "run",
    "warm_up",
]

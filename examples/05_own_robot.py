"""Builds a robot and a map, and drives the robot with its own limits and footprint."""

import numpy as np

from dynastar import Footprint, Goal, Lidar, Limits, OccupancyGrid, Robot, Scenario, run
from dynastar.metrics import measure

limits = Limits(
    v_max=0.8, omega_max=1.5, v_accel=0.5, omega_accel=2.0, v_brake=1.0, omega_brake=2.5
)
footprint = Footprint.polygon([(0.4, 0.25), (-0.3, 0.25), (-0.3, -0.25), (0.4, -0.25)])  # m
robot = Robot("cart", limits, footprint, Lidar(beams=360, range_max=15.0))

hall = np.zeros((120, 200), bool)  # rows are y, columns are x; True is occupied
hall[[0, -1]] = hall[:, [0, -1]] = True
hall[:70, 90:94] = True
grid = OccupancyGrid(hall, 0.05)

box = np.array([(6.0, 4.0), (6.6, 4.0), (6.6, 4.6), (6.0, 4.6)])  # not on the map
scenario = Scenario("cart", grid, robot, (1.0, 1.0, 0.0), (Goal(8.5, 1.5),), obstacles=(box,))
result = measure(run(scenario))
print(f"{result.outcome} after {result.time:.1f} s, {result.length:.1f} m", end=", ")
print(f"at least {result.min_clearance:.2f} m from anything")

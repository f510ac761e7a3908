"""The robots of the suites, one configuration each; the others are ``dynastar.robot.ROBOTS``."""

from dataclasses import replace

from dynastar.robot import ROBOTS, Robot

_JACKAL, _BURGER = ROBOTS["jackal"], ROBOTS["turtlebot3_burger"]

# A Jackal among pedestrians: 1.2 m/s, 1 m/s2.
CROWD_ROBOT: Robot = replace(
    _JACKAL,
    name="jackal_among_people",
    limits=_JACKAL.limits._replace(
        v_max=1.2,
        omega_max=2.0,
        v_accel=1.0,
        omega_accel=3.0,
        v_brake=1.0,
        omega_brake=3.0,
        v_min=-0.3,
    ),
)

# A TurtleBot3 Burger with a faster drive.
MAPS_ROBOT: Robot = replace(
    _BURGER,
    name="turtlebot3_burger_0.5",
    limits=_BURGER.limits._replace(v_max=0.5, v_min=-0.2),
)

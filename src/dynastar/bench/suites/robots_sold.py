"""The robots of the suite ``robots``, each as it is sold, with its usual lidar.

Where no source is named, a number is an assumption: accelerations of TurtleBots, the turning rate and
the radius of the TurtleBot 4, and all of the cart and the AGV, which stand for their kinds.
"""

import math
from typing import NamedTuple

from dynastar.footprint import Footprint
from dynastar.robot import ROBOTS, Lidar, Limits, Robot
from dynastar.simulation import Post


class SoldRobot(NamedTuple):
    """A robot, parts of its body that its lidar may see, and whether its scans change in length."""

    robot: Robot
    posts: tuple[Post, ...] = ()
    varies: bool = False


# [Robotis]: 0.26 m/s, 1.82 rad/s, 281 x 306 mm. Its URDF: body and LDS-01 64 mm behind the axle.
WAFFLE = Robot(
    "turtlebot3_waffle",
    Limits(0.26, 1.82, 2.5, 3.2, 2.5, 3.2, v_min=-0.26),
    Footprint.polygon([(0.0765, -0.153), (0.0765, 0.153), (-0.2045, 0.153), (-0.2045, -0.153)]),
    Lidar(360, math.tau, 0.12, 3.5, x=-0.064),
)

# [Create3]: 0.306 m/s and 0.9 m/s2 at the wheels. [TurtleBot4]: 640 readings, 0.164 to 12 m, 40 mm
# behind the middle, turned by 90 degrees; four standoffs.
TURTLEBOT4 = Robot(
    "turtlebot4",
    Limits(0.306, 1.9, 0.9, 7.0, 0.9, 7.0, v_min=-0.15),
    Footprint.disc(0.175),
    Lidar(640, math.tau, 0.164, 12.0, x=-0.04, theta=0.5 * math.pi),
)
STANDOFFS = ((0.0306, 0.1143), (0.0306, -0.1143), (-0.0761, 0.0907), (-0.0761, -0.0907))  # m

# A cart for warehouses: its axle at the back, a safety scanner at its nose.
CART = Robot(
    "cart",
    Limits(0.6, 1.0, 1.0, 2.0, 1.0, 2.0, v_min=-0.3),
    Footprint.polygon([(0.85, -0.25), (0.85, 0.25), (-0.15, 0.25), (-0.15, -0.25)]),
    Lidar(720, math.radians(270.0), 0.05, 10.0, x=0.8),
)

# A heavy vehicle that brakes at 0.4 m/s2.
AGV = Robot(
    "agv",
    Limits(1.5, 1.0, 0.3, 0.8, 0.4, 0.8, v_min=-0.3),
    Footprint.disc(0.5),
    Lidar(720, math.tau, 0.05, 20.0),
)


def seen_from(lidar: Lidar, places: tuple[tuple[float, float], ...]) -> tuple[Post, ...]:
    """Posts of 2 readings at ``places`` (x, y) m on the robot, as a lidar sees them."""
    return tuple(
        Post(
            math.remainder(math.atan2(y - lidar.y, x - lidar.x) - lidar.theta, math.tau),
            math.hypot(x - lidar.x, y - lidar.y),
            2,
        )
        for x, y in places
    )


SOLD: dict[str, SoldRobot] = {
    sold.robot.name: sold
    for sold in (
        SoldRobot(ROBOTS["turtlebot3_burger"], varies=True),
        # turtlebot3#501: supports of another layer, at the corners of the body.
        SoldRobot(WAFFLE, seen_from(WAFFLE.lidar, ((-0.18, 0.12), (-0.18, -0.12))), varies=True),
        SoldRobot(TURTLEBOT4, seen_from(TURTLEBOT4.lidar, STANDOFFS), varies=True),
        SoldRobot(ROBOTS["jackal"]),
        SoldRobot(ROBOTS["pioneer3dx"]),
        SoldRobot(CART),
        SoldRobot(AGV),
        SoldRobot(ROBOTS["paper"]),
    )
}

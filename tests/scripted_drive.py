"""A robot driven by hand in simulation, and recorded: rests, steps of both speeds, slow commands."""

import numpy as np

from dynastar.geometry import Pose2D, Twist
from dynastar.ros.bag import BagWriter, make
from dynastar.ros.outgoing import Messages
from dynastar.simulation import World

PERIOD = 0.05
ODOMETRY, SCAN = "nav_msgs/msg/Odometry", "sensor_msgs/msg/LaserScan"


def by_hand(v, omega, slow_v=(), slow_omega=()):
    """Commands and their seconds: a rest, four steps of each speed to and fro, slow commands."""
    script = [(0.0, 0.0, 3.0)]
    for sign in (1.0, -1.0, 1.0, -1.0):
        script += [(0.0, sign * omega, 2.5), (0.0, 0.0, 1.53)]
        script += [(sign * v, 0.0, 3.02), (0.0, 0.0, 1.81)]
    script += [step for one in slow_v for step in ((one, 0.0, 1.2), (0.0, 0.0, 1.2))]
    return script + [step for one in slow_omega for step in ((0.0, one, 1.2), (0.0, 0.0, 1.2))]


def record(folder, scenario, script, stamped=False, noise=0.0, per_command=1, make_world=World):
    """Drives the script in the scenario's world, and writes scans, odometry and commands to a bag.

    ``noise`` (m/s, rad/s) is the standard deviation of the odometry's speeds, ``per_command`` how many
    of its messages there are to a command. The world takes the command anew with each of them. It is the
    simulator's, or ``make_world(scenario, start, seed)``.
    """
    out, random = Messages(make), np.random.default_rng(scenario.seed)
    world = make_world(scenario, Pose2D(*scenario.start), scenario.seed)
    with BagWriter(folder) as bag:
        for v, omega, seconds in script:
            command = Twist(v, omega)
            for _ in range(round(seconds / PERIOD)):
                bag.write("/scan", SCAN, world.time, out.scan(world.scan(), "laser"))
                if stamped:
                    message = out.twist_stamped(command, "base_link", world.time)
                    kind = "geometry_msgs/msg/TwistStamped"
                else:
                    message, kind = out.twist(command), "geometry_msgs/msg/Twist"
                for part in range(per_command):
                    state, now = world.sensed_state(), world.time
                    read = Twist(*(np.array(state.twist) + noise * random.normal(size=2)))
                    odometry = out.odometry(state.pose, read, ("odom", "base_link"), now)
                    bag.write("/odom", ODOMETRY, now, odometry)
                    if part == 0:
                        bag.write("/cmd_vel", kind, now, message)
                    world.step(command, PERIOD / per_command)
                assert not world.contact

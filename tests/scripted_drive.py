"""A robot driven by hand in simulation, and recorded: rests, steps of both speeds, slow commands."""

from dynastar.geometry import Twist
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


def record(folder, scenario, script, stamped=False):
    """Drives the script in the scenario's world, and writes scans, odometry and commands to a bag."""
    out, world = Messages(make), World(scenario)
    with BagWriter(folder) as bag:
        for v, omega, seconds in script:
            for _ in range(round(seconds / PERIOD)):
                state, now = world.sensed_state(), world.time
                odometry = out.odometry(state.pose, state.twist, ("odom", "base_link"), now)
                bag.write("/odom", ODOMETRY, now, odometry)
                bag.write("/scan", SCAN, now, out.scan(world.scan(), "laser"))
                command = Twist(v, omega)
                if stamped:
                    message = out.twist_stamped(command, "base_link", now)
                    bag.write("/cmd_vel", "geometry_msgs/msg/TwistStamped", now, message)
                else:
                    bag.write("/cmd_vel", "geometry_msgs/msg/Twist", now, out.twist(command))
                world.step(command, PERIOD)
                assert not world.contact

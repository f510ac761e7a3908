"""Drives through the office in one's own loop: the same loop drives a real robot."""

from dynastar import (
    Navigator,
    NavigatorConfig,
    Pose2D,
    RobotState,
    Twist,
    World,
    load_scenario,
    warm_up,
)

warm_up()  # nothing is compiled while the robot drives
scenario = load_scenario("examples/office/office.toml")
world = World(scenario, Pose2D(2.0, 2.0, 0.0))
config = NavigatorConfig(latency=0.1, range_error=0.03, pose_error=0.02, heading_error=0.01)
navigator = Navigator(scenario.grid, scenario.robot, config)
navigator.set_goal((7.2, 10.0))
while navigator.status.state not in ("arrived", "blocked") or not world.resting:
    state = RobotState(world.time, world.pose, world.twist)
    world.step(navigator.command(state, world.scan()), 0.1)
world.step(Twist(0.0, 0.0), 0.1)
print(f"{world.time:.1f} s: {navigator.status.state}, {navigator.status.reason}")

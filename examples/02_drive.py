"""Drives through the office in one's own loop: the same loop drives a real robot."""

from dynastar import Navigator, NavigatorConfig, World, load_scenario, warm_up

warm_up()  # compiles or loads the kernels, so that no command waits for it
scenario = load_scenario("office")
world = World(scenario)  # on a robot: its odometry, lidar and motor driver
config = NavigatorConfig(latency=0.1, range_error=0.03, pose_error=0.03, heading_error=0.01)
navigator = Navigator(scenario.grid, scenario.robot, config)
navigator.set_goal((7.2, 10.0))
while not (world.contact or (world.resting and navigator.status.state in ("arrived", "blocked"))):
    state = world.sensed_state()
    world.step(navigator.command(state, world.scan()), 0.1)
print(f"{world.time:.1f} s: {navigator.status.state}, {navigator.status.reason}")

"""Visits several goals in order, one of them with a heading, and changes its mind on the way."""

from dynastar import Navigator, Pose2D, World, load_scenario

scenario = load_scenario("goals")
world = World(scenario, Pose2D(1.5, 1.5, 0.0))
navigator = Navigator(scenario.grid, scenario.robot)


def drive() -> None:
    """Drives until the last goal is reached, and says when each one is."""
    left = navigator.status.goals_left
    while navigator.status.state not in ("arrived", "blocked") or not world.resting:
        state = world.sensed_state()
        world.step(navigator.command(state, world.scan()), 0.1)
        if navigator.status.goals_left < left:
            left = navigator.status.goals_left
            x, y, heading = world.pose
            print(f"{world.time:5.1f} s: at ({x:.2f}, {y:.2f}), {heading:.2f} rad, {left} left")
    print(f"{world.time:5.1f} s: {navigator.status.state}")


navigator.set_goal([(2.0, 6.5, 1.5708), (8.0, 6.5), (8.0, 1.5)])  # x, y (m), heading (rad)
drive()
navigator.set_goal((2.0, 2.0))  # a new goal replaces all others
drive()

"""Hands the navigator a path to follow, and cancels it under way."""

from dynastar import Navigator, Pose2D, World, load_scenario

scenario = load_scenario("office")
world = World(scenario, Pose2D(2.0, 2.0, 0.0))
navigator = Navigator(scenario.grid, scenario.robot)


def drive(seconds: float) -> None:
    """Drives until the mission is over and the robot rests, or for so long."""
    end = world.time + seconds
    while world.time < end:
        state = world.sensed_state()
        world.step(navigator.command(state, world.scan()), 0.1)
        if navigator.status.state in ("arrived", "blocked", "idle") and world.resting:
            break
    x, y, _ = world.pose
    print(f"{world.time:.1f} s, ({x:.2f}, {y:.2f}): {navigator.status.state}")


navigator.follow([(2.0, 2.0), (4.0, 2.5), (5.0, 5.0), (3.0, 6.0)])
drive(60.0)
navigator.follow([(3.0, 6.0), (7.2, 10.0)], heading=0.0)
drive(2.0)
navigator.cancel()
drive(5.0)

"""Hands the navigator a path to follow, then a planner of one's own, and cancels."""

from dynastar import Goal, Navigator, Path, Pose2D, RobotState, load_scenario
from dynastar.planning import GridPlanner
from dynastar.simulation import World

scenario = load_scenario("examples/office/office.toml")
world = World(scenario, Pose2D(2.0, 2.0, 0.0))


class Cautious:
    """A planner that keeps half a metre more clear than it is asked to."""

    def plan(self, grid, start, goal, radius):
        return GridPlanner(grid, radius + 0.5).plan(start, goal).path


def drive(navigator: Navigator, seconds: float) -> None:
    """Drives until the mission is over and the robot rests, or for so long."""
    end = world.time + seconds
    while world.time < end:
        state = RobotState(world.time, world.pose, world.twist)
        world.step(navigator.command(state, world.scan()), 0.1)
        if navigator.status.state in ("arrived", "blocked", "idle") and world.resting:
            break
    x, y, _ = world.pose
    print(
        f"{world.time:5.1f} s, ({x:.2f}, {y:.2f}): {navigator.status.state}, contact: {world.contact!r}"
    )


navigator = Navigator(scenario.grid, scenario.robot, planner=Cautious())
navigator.follow(Path([(2.0, 2.0), (4.0, 2.5), (5.0, 5.0), (3.0, 6.0)]))
drive(navigator, 60.0)
navigator.set_goal(Goal(7.2, 10.0))
drive(navigator, 5.0)
navigator.cancel()
drive(navigator, 5.0)

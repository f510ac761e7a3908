"""Plans by a planner of one's own: any object with ``plan(grid, start, goal, radius)``."""

from dynastar import (
    GridPlanner,
    Navigator,
    OccupancyGrid,
    Path,
    Pose2D,
    World,
    load_scenario,
)

Point = tuple[float, float]


class Cautious:
    """Keeps a quarter of a metre more clear than it is asked to."""

    def plan(self, grid: OccupancyGrid, start: Point, goal: Point, radius: float) -> Path:
        """The path of a disc of ``radius`` metres; raises NoPath where there is none."""
        return GridPlanner(grid, radius + 0.25).plan(start, goal).path


scenario = load_scenario("office")
world = World(scenario, Pose2D(2.0, 2.0, 0.0))
navigator = Navigator(scenario.grid, scenario.robot, planner=Cautious())
navigator.set_goal((7.2, 10.0))
while world.time < 100.0 and navigator.status.state not in ("arrived", "blocked"):
    state = world.sensed_state()
    world.step(navigator.command(state, world.scan()), 0.1)
plan = navigator.status.plan
print(f"{world.time:.1f} s: {navigator.status.state}; planned by {plan.planner if plan else None}")

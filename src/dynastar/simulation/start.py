"""Where the robot of a scenario stands at first."""

import math
from collections.abc import Sequence
from contextlib import suppress

from dynastar.errors import PlanningError, ScenarioError, StartOccupied
from dynastar.geometry import Pose2D, as_point
from dynastar.planning import plan
from dynastar.simulation.contact import Solids
from dynastar.simulation.scenario import Scenario


def start_pose(scenario: Scenario, start: Sequence[float | None] | None = None) -> Pose2D:
    """The pose of ``start``, (x, y) in metres and a heading in radians, or of the scenario's start.

    Without a heading, the robot faces the first leg of a plan to the first goal, or the goal itself
    where nothing can be planned, or along x without any goal. Raises ScenarioError for numbers that
    are not finite, InputError for anything else.
    """
    start = scenario.start if start is None else start
    x, y = as_point(start, "the start")
    heading = start[2] if len(start) == 3 else None
    if not all(map(math.isfinite, (x, y, heading or 0.0))):
        raise ScenarioError(f"the start is {tuple(start)}: expected finite numbers")
    if heading is not None:
        return Pose2D(x, y, float(heading))
    if not scenario.goals:
        return Pose2D(x, y)
    goal = scenario.goals[0]
    towards, radius = (goal.x, goal.y), scenario.robot.footprint.circumscribed
    with suppress(PlanningError):
        path = plan(scenario.grid, (x, y), towards, radius=radius, unknown=scenario.unknown).path
        onward = path.points[path.arc > 1e-6]
        if len(onward):
            towards = (float(onward[0, 0]), float(onward[0, 1]))
    return Pose2D(x, y, math.atan2(towards[1] - y, towards[0] - x))


def check_start(scenario: Scenario) -> None:
    """Raises StartOccupied if the robot overlaps a wall or an obstacle at the scenario's start."""
    grid = scenario.grid if scenario.world is None else scenario.world
    pose = start_pose(scenario)
    if not grid.contains(pose.x, pose.y):
        return  # the navigator says so, with the map's extent
    if Solids(grid, scenario.obstacles).gap(pose, scenario.robot.footprint) <= 0.0:
        raise StartOccupied(
            f"the robot overlaps a wall or an obstacle at its start ({pose.x:.2f}, {pose.y:.2f}): "
            f"expected a free place for {scenario.robot.name}"
        )

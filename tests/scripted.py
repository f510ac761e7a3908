"""Controllers that drive by a script, for worlds and suites without a navigator."""

import math
from types import SimpleNamespace

from dynastar.geometry import Twist


class Scripted:
    """Turns on the spot towards the goal, drives there at ``SPEED``, stops within ``NEAR`` and turns."""

    SPEED, NEAR = 1.0, 0.2

    def __init__(self, grid, robot, config):
        self.status = SimpleNamespace(
            state="following", reason="", recoveries=0, plan=None, plan_id=0, plan_reason="",
            planning_frame=(0.1, 0.0, 0.0, 0.0), error=None, replans=0, tracks=[], goals_left=1,
        )  # fmt: skip

    def set_goal(self, goals):
        self.goal = goals[0]

    def command(self, state, scan):
        x, y, theta = state.pose
        away = math.hypot(self.goal.x - x, self.goal.y - y)
        if away < self.NEAR:
            heading = theta if self.goal.heading is None else self.goal.heading
            off = math.remainder(heading - theta, math.tau)
            self.status.state = "arrived" if abs(off) < 0.05 else "turning"
            return Twist(0.0, 0.0 if abs(off) < 0.05 else max(-1.0, min(1.0, off)))
        error = math.remainder(math.atan2(self.goal.y - y, self.goal.x - x) - theta, math.tau)
        return Twist(self.SPEED if abs(error) < 0.2 else 0.0, max(-1.0, min(1.0, 4.0 * error)))


class Still(Scripted):
    """Never moves."""

    def command(self, state, scan):
        return Twist(0.0, 0.0)

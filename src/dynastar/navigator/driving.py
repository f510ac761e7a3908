"""From what is known and a path to follow to a command: guidance, scene, dynamic window."""

import math

import numpy as np

from dynastar.dwa.clearance import kept_margin
from dynastar.dwa.dwa import Choice, DynamicWindow, Stops
from dynastar.dwa.motion import state_at
from dynastar.dwa.scene import AT_REST, Manoeuvre, Scene
from dynastar.geometry import Pose2D, Twist
from dynastar.guidance import Encounter, Guidance, Guide, PathTarget
from dynastar.guidance.guidance import NO_LINE
from dynastar.navigator.arrival import GENTLE
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.sensing import View
from dynastar.perception import LocalMap
from dynastar.perception.planning_map import PlanningMap
from dynastar.robot import Robot

GIVEN_PATH_WEIGHT = 3.0  # least weight sigma of keeping to a path given by the user


class Driving:
    """One robot's guidance and dynamic window, and what they keep from tick to tick.

    That is the rest of the last manoeuvre, and the line that was followed. ``margin`` (m) is kept from
    closed space.
    """

    def __init__(
        self, robot: Robot, config: NavigatorConfig, local_map: LocalMap, margin: float
    ) -> None:
        self.robot, self.config, self.margin = robot, config, margin
        self.window = DynamicWindow(robot, config.dwa, config.period, config.drive_error)
        self.guidance = Guidance(
            len(local_map.states),
            local_map.resolution,
            robot.footprint.inscribed + margin,
            config.dwa.comfort,
            keep_to_path=config.dwa.weights.simi > 0.0,
        )
        self.guide: Guide | None = None  # of the last tick
        self._last: Manoeuvre = AT_REST

    @property
    def times(self) -> tuple[float, float, int]:
        """The times of roll-outs: when a command acts (s), the step (s), and the number of steps."""
        schedule = self.window.rules.schedule
        return self.config.latency, schedule.period, int(schedule.step[-1])

    @property
    def lookahead(self) -> float:
        """The distance (m) that the robot can drive within the horizon."""
        _, step, steps = self.times
        return self.robot.limits.v_max * step * steps

    def carry_on(self, before: "Driving") -> None:
        """Take over the manoeuvre and the line of the driving that this one replaces."""
        self._last, self.guide = before._last, before.guide

    def forget_manoeuvre(self) -> None:
        """Begin anew from rest: another goal, or a command from elsewhere."""
        self._last = AT_REST

    def choose(self, pose: Pose2D, twist: Twist, scene: Scene, stops: Stops) -> Choice:
        """The best manoeuvre, as ``DynamicWindow.choose``; the next tick can carry it on."""
        choice = self.window.choose(pose, twist, scene, stops)
        self._last = choice.left
        return choice

    def scene(
        self, pose: Pose2D, v: float, view: View, target: PathTarget, planning_map: PlanningMap
    ) -> Scene:
        """The scene for a robot that is at ``pose`` when a command acts, and drives at ``v`` now (m/s)."""
        config, limits = self.config, self.robot.limits
        guide = self.guide = self._guided(view, target, pose)
        stop = v**2 / (2.0 * limits.v_brake) + abs(v) * (
            config.latency + 2.0 * self.window.rules.period
        )
        margin = self.margin + config.heading_error * stop
        closed, at = view.closed, state_at(*pose, 0.0, 0.0).pose
        return Scene(
            closed=closed,
            distance_to_obstacle=view.distance_to_obstacle,
            distance_to_path=guide.distance_to_path,
            cost_to_go=guide.cost_to_go,
            moving=view.moving,
            hidden=view.hidden,
            margin=margin,
            margin_to_closed=kept_margin(closed, self.window.rules.body, margin, at),
            latency=config.latency,
            last=self._last,
            v_cap=min(self._speed_cap(pose, guide, planning_map), view.speed),
            path_weight=GIVEN_PATH_WEIGHT if target.is_given else 0.0,
        )

    def _guided(self, view: View, target: PathTarget, pose: Pose2D) -> Guide:
        """The cost-to-go for a robot at ``pose``, which prefers the line of the last tick."""
        begin, step, _ = self.times
        encounter = Encounter(
            x=pose.x,
            y=pose.y,
            speed=self.robot.limits.v_max,
            radius=self.window.rules.risk_radius,
            begin=begin,
            step=step,
            discount=math.exp(-begin / self.config.prediction.memory),
        )
        followed = NO_LINE if self.guide is None else self.guide.line
        return self.guidance.update(
            view.distance_to_obstacle, target, view.moving, encounter, followed
        )

    def _speed_cap(self, pose: Pose2D, guide: Guide, planning_map: PlanningMap) -> float:
        """The speed (m/s) that leaves room to slow down for the map's speed limits ahead."""
        limits = self.robot.limits
        if planning_map.grid.speed_limit is None:
            return limits.v_max
        ahead = np.maximum(np.arange(len(guide.line)) - 1.0, 0.0) * self.guidance.resolution
        limit = planning_map.speed_limit(np.vstack([[pose.x, pose.y], guide.line]))
        slowed = np.sqrt(limit[1:] ** 2 + 2.0 * GENTLE * limits.v_brake * ahead)
        return float(min(limits.v_max, limit[0], slowed.min(initial=math.inf)))

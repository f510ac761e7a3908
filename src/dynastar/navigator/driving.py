"""From what is known and a path to follow to a command: guidance, scene, dynamic window."""

import numpy as np
import numpy.typing as npt

from dynastar.dwa.dwa import Choice, Stops
from dynastar.dwa.scene import AT_REST, Manoeuvre, Scene
from dynastar.geometry import Pose2D, Twist
from dynastar.guidance import Encounter, Guidance, Guide, PathTarget
from dynastar.navigator.admissibility import Admissibility
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.sensing import View
from dynastar.perception import LocalMap
from dynastar.perception.planning_map import PlanningMap
from dynastar.robot import Robot

Mask = npt.NDArray[np.bool_]

GIVEN_PATH_WEIGHT = 3.0  # least weight sigma of keeping to a path given by the user


class Driving(Admissibility):
    """One robot's guidance and dynamic window, and the rest of the last manoeuvre."""

    def __init__(self, robot: Robot, config: NavigatorConfig, local_map: LocalMap) -> None:
        super().__init__(robot, config)
        self.guidance = Guidance(
            len(local_map.states),
            local_map.resolution,
            robot.footprint.half_gap + self.margin,
            config.dwa.comfort,
            keep_to_path=config.dwa.weights.simi > 0.0,
        )
        self.guide: Guide | None = None  # of the last tick
        self._last: Manoeuvre = AT_REST

    @property
    def lookahead(self) -> float:
        """The distance (m) that the robot can drive within the horizon."""
        _, step, steps, _ = self.times
        return self.robot.limits.v_max * step * steps

    def carry_on(self, before: "Driving") -> None:
        """Take over what the driving that this one replaces kept."""
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
        self,
        pose: Pose2D,
        v: float,
        view: View,
        target: PathTarget,
        closed: Mask,
        planning_map: PlanningMap,
    ) -> Scene:
        """The scene for a robot that is at ``pose`` when a command acts, and drives at ``v`` now (m/s).

        ``closed`` are the cells of the local map where no plan leads.
        """
        encounter = Encounter(
            x=pose.x,
            y=pose.y,
            speed=self.robot.limits.v_max,
            radius=self.window.rules.risk_radius,
            step=self.times.step,
        )
        guide = self.guidance.update(
            view.distance_to_obstacle, closed, target, view.moving, encounter
        )
        self.guide = guide
        cap = self.speed_cap(pose, guide.line, self.guidance.resolution, planning_map)
        return Scene(
            around=self.surroundings(pose, v, view),
            distance_to_obstacle=view.distance_to_obstacle,
            distance_to_path=guide.distance_to_path,
            cost_to_go=guide.cost_to_go,
            margin=self.margin_at(v),
            last=self._last,
            v_cap=min(cap, view.speed),
            path_weight=GIVEN_PATH_WEIGHT if target.is_given else 0.0,
        )

"""What a robot does that makes no progress: stop, plan anew, look for a way over poses, give up at last."""

from collections.abc import Callable

from dynastar.dwa.dwa import DynamicWindow
from dynastar.dwa.scene import Scene
from dynastar.geometry import Pose2D
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.mission import Mission
from dynastar.navigator.progress import CostToGoAt, Progress
from dynastar.navigator.replanning import Route
from dynastar.navigator.status import RobotState
from dynastar.navigator.way_out import WayOut
from dynastar.robot import Limits, stopping_time


class Recovery:
    """Stops a robot that is stuck, makes it plan anew, and ends the mission after ``config.attempts``."""

    def __init__(
        self, mission: Mission, route: Route, limits: Limits, config: NavigatorConfig
    ) -> None:
        self.mission, self.route, self.limits, self.config = mission, route, limits, config
        self.progress = Progress(config.stuck_time)
        self.way_out = WayOut(limits, config.stuck_time)

    def reset(self) -> None:
        """Another goal or map: nothing has been reached or tried yet."""
        self.progress.reset()
        self.way_out.forget()

    def judge(self, state: RobotState, cost_to_go: CostToGoAt) -> None:
        """End the mission if all attempts were made; else begin to stop if the robot is stuck."""
        route, progress, attempts = self.route, self.progress, self.config.attempts
        here, has_path = (state.pose.x, state.pose.y), route.path is not None
        if route.waits_at_taken_goal(here):
            self.mission.say("waiting", "a moving obstacle is at the goal")
            progress.restart(state.stamp)
            return
        nothing_left = not has_path and progress.rounds >= attempts
        stuck = progress.stuck(state.stamp, here, cost_to_go if has_path else None)
        if nothing_left or (stuck and max(progress.rounds, progress.pathless_rounds) > attempts):
            self._give_up()
        elif stuck:
            stops_in = self.config.latency + stopping_time(state.twist, self.limits)
            progress.stops_until = state.stamp + stops_in

    def _give_up(self) -> None:
        if self.route.path is None:
            self.mission.block(f"no way is left: {self.route.error}", self.route.error)
        else:
            self.mission.block(f"gave up: no progress after {self.config.attempts} recoveries")

    @property
    def is_stopping(self) -> bool:
        """Whether the robot stops to plan anew."""
        return self.progress.stops_until is not None

    def go_on(self, state: RobotState, refine: Callable[[], None]) -> None:
        """Plan anew once the robot has come to rest: on a large map that takes seconds.

        Where no path was left, ``refine`` is called for finer cells.
        """
        self.mission.say("recovering", "no progress")
        stops_until = self.progress.stops_until
        if stops_until is None or state.stamp < stops_until:
            return
        route, has_path = self.route, self.route.path is not None
        if not route.is_at_obstructed_goal:  # there it sees what is in the way
            route.drop()
        if not has_path:
            refine()
        self.progress.restart(state.stamp)
        self.way_out.is_wanted = route.given is None
        self.mission.recover(state.stamp, "no progress: plan anew")

    def drives_out(self, scene: Scene, window: DynamicWindow, pose: Pose2D, now: float) -> bool:
        """Whether the robot drives a way over poses; it looks for one when it has planned anew."""
        way_out = self.way_out
        if way_out.is_wanted:
            way_out.forget()
            if self.route.path is not None:
                way_out.look(scene, window, pose, now)
        if not way_out.goes_on(pose, now):
            return False
        self.progress.restart(now)
        self.mission.say("recovering", "backs and turns to where the path leads on")
        return True

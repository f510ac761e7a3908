"""Messages in, commands out: what the node does, and what a recording is replayed with."""

import json
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from dynastar.config import checked
from dynastar.errors import DynastarError, InputError
from dynastar.geometry import Goal, Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator, NavigatorConfig, RobotState, Status
from dynastar.robot import Robot
from dynastar.ros.incoming import goal_of
from dynastar.ros.intake import SENSED, Intake
from dynastar.ros.settings import NodeSettings, flat, nested, robot_from, robot_table

TAKES = {**SENSED, "goal_pose": "geometry_msgs/msg/PoseStamped"}
REQUESTS = "dynastar/requests"  # what was asked for by services, actions and parameters, as JSON


def start_request(settings: NodeSettings, robot: Robot, config: NavigatorConfig) -> str:
    """The first request of a recording: what the bridge was made of, as JSON."""
    table = {
        "settings": settings._asdict(),
        "robot": robot_table(robot),
        "config": nested(flat(config)),
    }
    return json.dumps({"start": table})


def started(table: Mapping[str, Any]) -> "Bridge":
    """The bridge that a recording's first request tells of; InputError where it cannot be."""
    try:
        settings = checked(NodeSettings, table["settings"], "settings")
        config = checked(NavigatorConfig, table["config"], "config")
        return Bridge(settings, robot_from(table["robot"]), config)
    except (KeyError, TypeError) as error:
        raise InputError(f"a recording's start cannot be read: {error}") from None


class Tick(NamedTuple):
    """Result of a tick: command, state of the navigator with its reason, status, state of the robot."""

    command: Twist
    state: str
    reason: str
    status: Status | None = None
    robot: RobotState | None = None


class Bridge(Intake):
    """A navigator that is fed with messages, and brakes while they are missing, late or wrong."""

    def __init__(self, settings: NodeSettings, robot: Robot, config: NavigatorConfig) -> None:
        super().__init__(settings, robot, config)
        self.navigator: Navigator | None = None
        self.goals_taken = self.goals_refused = 0  # since the start

    # -- what comes in ----------------------------------------------------------------------------

    def take(self, topic: str, message: Any) -> str:
        """Use a message of a topic in TAKES. Returns what is wrong with it, or ""."""
        if topic != "goal_pose":
            return super().take(topic, message)
        try:
            self.set_goals([goal_of(message, self.settings.global_frame)])
        except DynastarError as error:
            self.refused = f"the goal is refused: {error}"
            self.goals_refused += 1
            return self.refused
        return ""

    def _use_grid(self, grid: OccupancyGrid) -> None:
        if self.navigator is None:
            self.navigator = Navigator(grid, self.robot, self.config)
        else:
            self.navigator.set_map(grid)

    def _drop_sensed(self) -> None:
        if self.navigator is not None:
            self.navigator.forget()
            self.navigator.forget_times()

    # -- what is asked for ------------------------------------------------------------------------

    def set_goals(self, goals: list[Goal]) -> None:
        """Drives to goals, in order, in place of the present ones; InputError leaves those."""
        if self.navigator is None:
            raise InputError("there is no map yet")
        for goal in goals:
            self.navigator.planning_map.grid.world_to_cell(goal.x, goal.y)
        self.navigator.set_goal(goals)
        self.goals_taken += 1

    def follow(self, points: Sequence[Sequence[float]], heading: float | None = None) -> None:
        """Drives along a path (n, 2), metres, in place of the present goals; InputError leaves those."""
        if self.navigator is None:
            raise InputError("there is no map yet")
        self.navigator.follow(np.array(points, dtype=np.float64).reshape(-1, 2), heading)
        self.goals_taken += 1

    def request(self, **wanted: Any) -> str:
        """Carries out requests by name, and returns them as JSON.

        ``goals`` (x, y, heading), ``follow`` (points, heading), ``cancel``, ``clear``, ``settings``,
        ``restart`` and ``fault`` with their reasons. Raises InputError for one that cannot be carried out,
        which changes nothing.
        """
        for name, value in wanted.items():
            if name == "goals":
                self.set_goals([Goal(*goal) for goal in value])
            elif name == "follow":
                self.follow(*value)
            elif name == "settings":
                self._change(value)
            elif name == "restart":
                self._restart(value)
            elif name == "fault":
                self.fault = str(value)
            elif self.navigator is None:
                raise InputError("there is no map yet")
            elif name == "cancel":
                self.navigator.cancel()
            elif name == "clear":
                self.navigator.forget()
            else:
                raise InputError(f"unknown request '{name:.80}'")
        return json.dumps(wanted)

    def _change(self, values: Mapping[str, Any]) -> None:
        """Other settings from now on; goals, given path and the stop under way stay."""
        config, before = checked(NavigatorConfig, values), self.navigator
        if before is not None and self.grid is not None:
            navigator = Navigator(self.grid, self.robot, config)
            navigator.continue_from(before)
            self.navigator = navigator
        self.config = config

    def _restart(self, reason: str) -> None:
        """Forgets all but the map: time has jumped."""
        self._forget(reason)
        if self.navigator is not None:
            self.navigator.cancel()
            self._drop_sensed()

    # -- the loop ---------------------------------------------------------------------------------

    def tick(self, now: float) -> Tick:
        """The command at ``now`` (s); braking, with the reason, where data are missing or late."""
        scans = self._take_new_scans()
        if self.navigator is None:
            reason = self.fault or self._refusals.get("map", "no map has come yet")
            return Tick(Twist(0.0, 0.0), "idle", reason)
        state, trouble = self._state(now)
        command = self.navigator.command(state, scans)
        status = self.navigator.status
        return Tick(command, status.state, trouble or status.reason, status, state)

    def values(self, tick: Tick) -> dict[str, str]:
        """What is said of a tick beside its state and reason, by name."""
        status = Status() if tick.status is None else tick.status
        return {
            "v": f"{tick.command.v:.3f} m/s",
            "omega": f"{tick.command.omega:.3f} rad/s",
            "limited by": status.limited_by,
            "path": status.plan_reason,
            "goals left": str(status.goals_left),
            "replans": str(status.replans),
            "goals taken": str(self.goals_taken),
            "goals refused": str(self.goals_refused),
            "refused": self.refused,
        }

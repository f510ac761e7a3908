"""Recorded scans and odometry given to the navigator again: the same commands each time."""

import json
import math
import time
from collections.abc import Iterator, Mapping, Set
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.errors import DataError, DynastarError
from dynastar.geometry import Goal, Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator import configured
from dynastar.navigator.config import changed
from dynastar.robot import Robot
from dynastar.ros.bag import BagReader
from dynastar.ros.bridge import REQUESTS, TAKES, Bridge, started
from dynastar.ros.incoming import seconds, twist_of
from dynastar.ros.localization import PoseSource
from dynastar.ros.settings import NodeSettings
from dynastar.terminal import progress_bar

COMMANDS = "cmd_vel"
NOTHING = Twist(math.nan, math.nan)
# Settings that tell of the robot and the mission, which another preset leaves as they are.
OF_THE_ROBOT = (
    "period", "latency", "range_error", "pose_error", "heading_error", "drive_error", "scan_age",
    "hidden_speed", "unseen_speed", "goal_tolerance", "heading_tolerance", "unknown",
)  # fmt: skip
# Options of `dynastar replay` for what a recording may lack.
INSTEAD = {"map": "--map MAP, or ", "goal_pose": "--goal X Y [HEADING], or "}
MOST_REFUSALS = 3  # shown in the summary
SAME = 1e-6  # m/s and rad/s up to which two commands are the same


@dataclass(frozen=True)
class Replay:
    """What the navigator answered at each tick, beside what was recorded, NaN where nothing was."""

    times: npt.NDArray[np.float64]  # (n,) s
    commands: npt.NDArray[np.float64]  # (n, 2) m/s, rad/s
    recorded: npt.NDArray[np.float64]  # (n, 2) m/s, rad/s
    milliseconds: npt.NDArray[np.float64]  # (n,)
    states: tuple[str, ...]
    refused: tuple[str, ...]  # what was wrong with messages, each once

    def summary(self) -> dict[str, Any]:
        """Figures of a replay by name, with units."""
        known = np.isfinite(self.recorded[:, 0])
        off = np.abs(self.commands - self.recorded)[known]
        names = sorted(set(self.states))
        shares = {f"ticks {name}": self.states.count(name) for name in names}
        return {
            "ticks": len(self.times),
            "time [s]": float(np.ptp(self.times)) if len(self.times) else 0.0,
            **shares,
            "mean v [m/s]": _mean(self.commands[:, 0]),
            "mean |omega| [rad/s]": _mean(np.abs(self.commands[:, 1])),
            "command median [ms]": _median(self.milliseconds),
            "ticks as recorded": int((off <= SAME).all(axis=1).sum()) if known.any() else None,
            "largest difference in v [m/s]": float(off[:, 0].max()) if known.any() else None,
            "largest difference in omega [rad/s]": float(off[:, 1].max()) if known.any() else None,
            "refused": self._words(),
        }

    def _words(self) -> str | None:
        """The first messages that were refused, and how many more there are."""
        more = len(self.refused) - MOST_REFUSALS
        words = "; ".join(self.refused[:MOST_REFUSALS])
        return (f"{words}; and {more} more" if more > 0 else words) or None


def _mean(values: npt.NDArray[np.float64]) -> float:
    return float(values.mean()) if len(values) else math.nan


def _median(values: npt.NDArray[np.float64]) -> float:
    return float(np.median(values)) if len(values) else math.nan


class Overrides(NamedTuple):
    """What is used instead of what was recorded; None, {} and () keep that."""

    robot: Robot | None = None
    preset: str | None = None
    settings: Mapping[str, Any] = {}
    pose_source: PoseSource | None = None
    grid: OccupancyGrid | None = None
    goals: tuple[Goal, ...] = ()

    def bridge(self, recorded: Bridge | None) -> Bridge:
        """A bridge like the recorded one, or a new one, but for what is given here, with its map."""
        made = self._bridge(recorded)
        if self.grid is not None:
            made.use_map(self.grid)
        return made

    def _bridge(self, recorded: Bridge | None) -> Bridge:
        if recorded is None:
            assert self.robot is not None
            source = self.pose_source or "odom"
            own = NodeSettings(robot=self.robot.name, pose_source=source)
            config = configured(self.preset or "default", self.settings)
            return Bridge(own, self.robot, config)
        own, config = recorded.settings, recorded.config
        if self.pose_source is not None:
            own = own._replace(pose_source=self.pose_source)
        if self.preset is not None:
            kept: dict[str, Any] = {name: getattr(config, name) for name in OF_THE_ROBOT}
            kept["local_map"] = {"narrowest": config.local_map.narrowest}
            config = configured(self.preset, kept)
        config = changed(config, self.settings)
        return Bridge(own, self.robot or recorded.robot, config)

    @property
    def replaced(self) -> set[str]:
        """Topics and requests of the recording that are left out."""
        goals = {"goal_pose", "goals", "follow", "cancel"} if self.goals else set()
        return goals | ({"map"} if self.grid is not None else set())

    @property
    def keeps_settings(self) -> bool:
        """Whether the navigator's settings are the recorded ones."""
        return self.preset is None and not self.settings


def replay(
    path: Path,
    overrides: Overrides = Overrides(),
    remap: Mapping[str, str] | None = None,
    progress: bool = False,
) -> Replay:
    """Gives a recording's messages to a navigator and returns what it answers.

    A recording by dynastar says which robot and settings it was made with; others need
    ``overrides.robot``, and map and goals in ``overrides`` where they are not recorded. dynastar's own
    are ticked when they were, others at each scan, by its stamp.
    ``remap`` maps a topic as in ``bridge.TAKES`` to the recording's name for it. Raises DataError for
    a recording that cannot be read or lacks map, scan, odometry or a goal.
    """
    bag = BagReader(path)
    try:
        topics = topics_of(bag, remap or {}, overrides.replaced)
        if REQUESTS not in topics and overrides.robot is None:
            raise DataError(f"{bag.path} is not by dynastar: name its robot with --robot")
        if REQUESTS in topics and COMMANDS not in topics:  # which it is ticked by
            have = ", ".join(sorted(bag.topics))
            raise DataError(
                f"{bag.path}: no topic '{COMMANDS}' in it: give --topic {COMMANDS}=TOPIC for one of "
                f"another name; it has {have}"
            )
        ticks = list(_ticks(bag, topics, overrides, progress))
    finally:
        bag.close()
    refused = dict.fromkeys(tick.refused for tick in ticks if tick.refused)
    return Replay(
        np.array([tick.time for tick in ticks]),
        np.array([tick.command for tick in ticks]).reshape(-1, 2),
        np.array([tick.recorded for tick in ticks]).reshape(-1, 2),
        np.array([tick.milliseconds for tick in ticks]),
        tuple(tick.state for tick in ticks),
        tuple(refused),
    )


def topics_of(bag: BagReader, remap: Mapping[str, str], replaced: Set[str]) -> dict[str, str]:
    """The recording's topics by the bridge's names; DataError where one is missing or ambiguous.

    Those in ``replaced`` are left out.
    """
    names: dict[str, str] = {}
    kinds = {**TAKES, REQUESTS: "std_msgs/msg/String", COMMANDS: ""}
    for short, kind in kinds.items():
        if short in replaced:
            continue
        wanted = remap.get(short.lstrip("/"), short)
        found = [
            name
            for name, type_ in bag.topics.items()
            if (name == wanted or name.endswith("/" + wanted.lstrip("/")))
            and (type_ == kind or not kind)
        ]
        if len(found) > 1 and "/" + wanted.lstrip("/") in found:
            found = ["/" + wanted.lstrip("/")]
        if len(found) > 1:
            raise DataError(
                f"{bag.path}: '{short}' may be {' or '.join(sorted(found))}: name one with "
                f"--topic {short.lstrip('/')}={found[0]}"
            )
        if found:
            names[short] = found[0]
    needed = ["map", "scan", "odom", *([] if REQUESTS in names else ["goal_pose"])]
    for short in needed:
        if short not in names and short not in replaced:
            have = ", ".join(sorted(bag.topics)) or "nothing"
            option = INSTEAD.get(short, "")
            raise DataError(
                f"{bag.path}: no topic '{short}' of type {TAKES[short]} in it: give {option}"
                f"--topic {short}=TOPIC for one of another name; it has {have}"
            )
    return names


class _Tick(NamedTuple):
    time: float
    command: Twist
    recorded: Twist
    milliseconds: float
    state: str
    refused: str


def _ticks(
    bag: BagReader, topics: Mapping[str, str], overrides: Overrides, progress: bool
) -> Iterator[_Tick]:
    """Each tick of a replay, in order."""
    ours = REQUESTS in topics  # recorded by dynastar
    bridge = None if ours else overrides.bridge(None)
    shorts = {name: short for short, name in topics.items()}
    refused, led = "", None
    for name, at, message in progress_bar(
        bag.messages(set(shorts)), desc="replay", unit=" messages", disable=not progress, delay=0.5
    ):
        short = shorts[name]
        if short == REQUESTS:
            bridge, refused = _requested(bridge, message.data, overrides)
        elif bridge is not None:
            if short != COMMANDS:
                refused = bridge.take(short, message) or refused
            if overrides.goals and bridge.navigator is not led:
                led = bridge.navigator  # a new one, which has no goals yet
                bridge.set_goals(list(overrides.goals))
            if ours and short == COMMANDS:
                yield _ticked(bridge, at, twist_of(getattr(message, "twist", message)), refused)
                refused = ""
            elif not ours and short == "scan":
                # Odometry that is newer than the scan has come before it, as on the robot.
                now = max(seconds(message.header.stamp), bridge.localization.stamp)
                yield _ticked(bridge, now, NOTHING, refused)
                refused = ""


def _ticked(bridge: Bridge, now: float, recorded: Twist, refused: str) -> _Tick:
    began = time.perf_counter()
    tick = bridge.tick(now)
    took = 1e3 * (time.perf_counter() - began)
    return _Tick(now, tick.command, recorded, took, tick.state, refused)


def _requested(
    bridge: Bridge | None, words: str, overrides: Overrides
) -> tuple[Bridge | None, str]:
    """Carries out a recorded request; settings that are given for the replay stay as they are."""
    try:
        wanted = dict(json.loads(words))
        wanted = {name: one for name, one in wanted.items() if name not in overrides.replaced}
    except (ValueError, TypeError) as error:
        return bridge, f"a request cannot be read: {error}"
    if "start" in wanted:
        return overrides.bridge(started(wanted["start"])), ""
    try:
        if bridge is not None and (overrides.keeps_settings or "settings" not in wanted):
            bridge.request(**wanted)
    except (DynastarError, TypeError) as error:
        return bridge, str(error)
    return bridge, ""

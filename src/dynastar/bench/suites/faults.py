"""Suite faults: sensors, odometry, clock, drive or map fail while the robot drives at speed.

Two rooms and two doors, a straight way of 15 m, two boxes that the map lacks. A mission is a case,
a robot and a time of the strike; its number is 6 case + 3 robot + time. Rows have, beside the usual
keys, ``struck_at`` (s, None if the fault never struck), ``struck_speed`` (m/s), ``stop_begins_s``
(s from there until the commanded speed starts to fall and keeps falling to rest, None if the robot
does not come to rest before the data are good again), ``stopped_in_time`` (None where no stop is
required), ``goes_on`` (the mission arrives after the fault), ``commands_in_limits`` and ``right``:
no contact, stopped in time where that is required, no command beyond the robot's limits, and the
right end, which is ``blocked`` for an occupied goal and ``arrived`` for all others.
"""

from collections.abc import Iterator, Mapping
from functools import lru_cache, partial
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from dynastar.bench import driven
from dynastar.bench.bounded import row_within
from dynastar.bench.missions import Mission, Options
from dynastar.episode import Episode
from dynastar.geometry import Goal, Pose2D
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.robot import ROBOTS
from dynastar.simulation import Fault, Scenario, warm_up

DEFAULT_MISSIONS = None
QUICK_MISSIONS = 24

ROBOT_NAMES = ("pioneer3dx", "jackal")
FRACTIONS = (0.2, 0.4, 0.6)  # of the way at full speed, when the fault may strike
AT_SPEED = 0.4  # fraction of v_max below which the fault waits
START, GOAL = Pose2D(1.5, 2.7, 0.0), Goal(16.5, 2.7)
SIZE = (18.0, 10.0)  # m
WALL_X = (9.0, 9.2)  # m, the wall between the rooms
DOORS = ((2.0, 3.4), (7.0, 8.4))  # m, the first on the way, the second a detour
BOXES = ((5.0, 1.0, 5.6, 1.9), (12.5, 3.4, 13.1, 4.2))  # m, not on the map
OVER_GOAL = (15.9, 2.1, 17.1, 3.3)
ELSEWHERE = Pose2D(4.0, 7.8, 3.0)  # where a kidnapped robot is put
TIME_LIMIT = 90.0  # s
WALL_LIMIT = 60.0  # s; a controller that takes longer has hung

STOP_WITHIN = 0.3  # s, plus the declared latency: a certified stop begins
LASTS = 2.0  # s, long enough to see a stop to its end, short of giving the sensor up
MOVING = 0.05  # m/s, under which there is nothing to stop
AT_REST = 0.02  # m/s
LEVEL = 1e-3  # m/s by which a commanded speed may differ and still counts as level


class Case(NamedTuple):
    """A fault and what is right under it: whether a stop is required, and how the mission ends."""

    name: str
    fault: Mapping[str, Any]
    stop: bool
    rule: str
    ends: str = "arrived"


NO_DATA = "without usable data nothing ahead is known to be free"
ONE_TICK = "one tick of bad data leaves the data of the tick before: going on is right"

CASES = (
    Case("scans_lost", {}, True, NO_DATA),
    Case("scans_frozen", {}, True, NO_DATA),
    Case("scans_repeated", {}, True, "walls in view would have changed the ranges"),
    Case("scans_nan", {}, True, NO_DATA),
    Case("beams_missing", {"size": 0.5}, False, "the beams between still cover the way"),
    Case("side_missing", {"size": 0.5}, False, "the other side is seen: slow down as needed"),
    Case("scans_late_0.2", {"kind": "scans_late", "size": 0.2}, False, "late, but stamped right"),
    Case("scans_late_0.5", {"kind": "scans_late", "size": 0.5}, True, NO_DATA),
    Case("scans_ahead_1", {"kind": "scans_ahead", "size": 1.0}, True, NO_DATA),
    Case("scans_ahead_1e6", {"kind": "scans_ahead", "size": 1e6}, True, NO_DATA),
    Case("scan_ahead_once", {"kind": "scans_ahead", "size": 1e6, "duration": 0.0}, False, ONE_TICK),
    Case("pose_jump", {"size": 1.0}, False, "a scan at the new pose shows anew what is free"),
    Case("pose_off_map", {"kind": "pose_jump", "size": 1e3, "duration": 0.0}, False, ONE_TICK),
    Case("state_frozen", {}, True, "the age of the pose is unknown"),
    Case("state_nan", {}, True, NO_DATA),
    Case(
        "twist_glitch_20", {"kind": "twist_glitch", "size": 20.0, "duration": 0.0}, False, ONE_TICK
    ),
    Case(
        "twist_glitch_1e4", {"kind": "twist_glitch", "size": 1e4, "duration": 0.0}, False, ONE_TICK
    ),
    Case("clock_back", {"size": 2.0}, True, "the age of the data is unknown"),
    Case(
        "clock_back_for_good",
        {"kind": "clock_back", "size": 2.0, "duration": np.inf},
        True,
        "the age of the data is unknown",
    ),
    Case("commands_late", {"size": 0.2}, False, "nothing tells the robot; outside its promise"),
    Case("map_replaced", {}, False, "the local map stays valid; the detour is planned"),
    Case("goal_occupied", {"kind": "obstacle_appears"}, False, "no way to the goal", "blocked"),
    Case("kidnapped", {}, False, "a scan at the new pose shows anew what is free"),
)


class Strike(NamedTuple):
    """A mission: a case, a robot by name, and the fraction of the path at which the fault strikes."""

    case: Case
    robot: str
    fraction: float


def missions(options: Options) -> Iterator[Mission]:
    """All cases, each with both robots at three times."""
    del options
    strikes = (
        Strike(case, robot, fraction)
        for case in CASES
        for robot in ROBOT_NAMES
        for fraction in FRACTIONS
    )
    return (Mission(number, strike) for number, strike in enumerate(strikes))


def leave_out(mission: Mission, options: Options) -> str:
    """Leaves nothing out."""
    del mission, options
    return ""


def scenario(mission: Mission, options: Options, repeat: int) -> Scenario:
    """The two rooms with the mission's robot and fault."""
    del repeat
    case, name, fraction = mission.spec
    robot = ROBOTS[name]
    speed = robot.limits.v_max
    facts = {"kind": case.name, "duration": LASTS} | dict(case.fault)
    fault = Fault(
        start=round(fraction * (GOAL.x - START.x) / speed, 1),
        speed=AT_SPEED * speed,
        pose=ELSEWHERE if case.name == "kidnapped" else None,
        polygon=_corners(OVER_GOAL) if case.name == "goal_occupied" else None,
        grid=rooms(0.05, closed=True) if case.name == "map_replaced" else None,
        **facts,
    )
    rooms_with_fault = Scenario(
        f"faults {case.name} {name}",
        rooms(),
        robot,
        START,
        (GOAL,),
        obstacles=tuple(map(_corners, BOXES)),
        faults=(fault,),
        time_limit=TIME_LIMIT,
        seed=mission.number,
    )
    return driven.realistic(rooms_with_fault, options)


def run_mission(mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """Drives a mission and judges what the robot did about the fault."""
    case, name, _ = mission.spec
    made = scenario(mission, options, repeat)
    if options.controller == "navigator":
        warm_up()  # here, so that the mission's own process has the kernels
    # A controller that raises or never returns has failed this case, too.
    row = row_within(WALL_LIMIT, partial(_row, made, mission, options, repeat))
    episode = row.pop("episode", None)
    failed = {"group": case.name, "right": False, "stopped_in_time": False if case.stop else None}
    row = failed | {"robot": name} | row
    if options.observe is not None and episode is not None:
        options.observe(mission, repeat, episode, row)
    return row


def _row(made: Scenario, mission: Mission, options: Options, repeat: int) -> dict[str, Any]:
    """The row of a mission, with its episode where that is to be observed."""
    case: Case = mission.spec.case
    episodes: list[Episode] = []
    asked = options._replace(observe=lambda *seen: episodes.append(seen[2]))
    row = driven.run_mission(
        made,
        options if options.observe is None else asked,
        mission,
        repeat,
        group=case.name,
        extra=partial(judged, case=case, latency=made.latency),
    )
    return row | {"episode": episodes[0]} if episodes else row


def judged(episode: Episode, case: Case, latency: float) -> dict[str, Any]:
    """The suite's own keys of a row, see the module."""
    onset, over = struck(episode)
    begins = speed = in_time = None
    if onset is not None:
        tick = int(np.searchsorted(episode.trajectory.times, onset - 1e-9))
        speed = abs(float(episode.trajectory.twists[tick, 0]))
        begins = stop_begins(episode, onset, onset + LASTS if over is None else over)
        if case.stop and speed >= MOVING:
            in_time = begins is not None and begins <= STOP_WITHIN + latency + 1e-6
    ended = episode.outcome == case.ends
    limits = ROBOTS[episode.robot].limits
    in_limits = bool(
        (np.abs(episode.commands) <= (limits.v_max + LEVEL, limits.omega_max + LEVEL)).all()
    )
    blocked = case.ends == "blocked"
    return {
        "struck_at": onset,
        "struck_speed": speed,
        "stop_begins_s": begins,
        "stopped_in_time": in_time,
        "goes_on": None if blocked else ended,
        "blocked_rightly": blocked and ended,
        "commands_in_limits": in_limits,
        "right": onset is not None and ended and in_limits and in_time is not False,
    }


def struck(episode: Episode) -> tuple[float | None, float | None]:
    """When the first fault began and when it ended (s); None for what did not happen."""
    stamps = {"begins": None, "ends": None} | {
        event.detail.split(": ")[0].split()[-1]: event.stamp
        for event in reversed(episode.events)
        if event.kind == "fault"
    }
    return stamps["begins"], stamps["ends"]


def stop_begins(episode: Episode, onset: float, over: float) -> float | None:
    """Seconds from ``onset`` until the commanded speed starts to fall and keeps falling to rest.

    None if the robot does not come to rest before ``over`` (s).
    """
    times, commanded = episode.trajectory.times, np.abs(episode.commands[:, 0])
    driven_speed = np.abs(episode.trajectory.twists[:, 0])
    window = (times >= onset - 1e-9) & (times <= over + 1e-9)
    resting = np.flatnonzero(window & (driven_speed < AT_REST) & (commanded < AT_REST))
    if len(resting) == 0:
        return None
    first, rest = int(np.flatnonzero(window)[0]), int(resting[0])
    tick = rest
    while tick > first and commanded[tick - 1] >= commanded[tick] - LEVEL:
        tick -= 1
    falls = (j for j in range(max(tick, 1), rest + 1) if commanded[j] < commanded[j - 1] - LEVEL)
    return float(times[next(falls, first)] - onset)


@lru_cache
def rooms(resolution: float = 0.1, closed: bool = False) -> OccupancyGrid:
    """The map of the two rooms; ``closed`` shows the door on the way as a wall."""
    width, height = (round(metres / resolution) for metres in SIZE)
    occupied = np.zeros((height, width), bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    x0, x1 = (round(x / resolution) for x in WALL_X)
    occupied[:, x0:x1] = True
    for low, high in DOORS[1:] if closed else DOORS:
        occupied[round(low / resolution) : round(high / resolution), x0:x1] = False
    return OccupancyGrid(occupied, GridFrame(resolution))


def _corners(box: tuple[float, float, float, float]) -> npt.NDArray[np.float64]:
    x0, y0, x1, y1 = box
    return np.array([[x0, y0], [x1, y0], [x1, y1], [x0, y1]])

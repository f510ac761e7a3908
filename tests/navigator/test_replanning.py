"""Whose path is driven: one that is given, that of another planner, and what counts as a replan."""

import itertools
import logging
import math
import re
from dataclasses import replace

import numpy as np
import pytest

from driving import REST, ROUND, Drive, room, under_way
from dynastar.dwa.scene import AT_REST
from dynastar.errors import InputError, NoPath, StartOccupied
from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator
from dynastar.path import Path
from dynastar.planning import GridPlanner, PlannerConfig
from dynastar.robot import ROBOTS
from dynastar.simulation.lidar import LidarSimulator

SQUARE = np.array([(1.5, 1.5), (6.5, 1.5), (6.5, 4.5), (1.5, 4.5), (1.5, 2.0)])


def drive_along(path, pose=(1.5, 1.5, 0.0), true=None, **more):
    drive = Drive(room(), pose=pose, true=true)
    drive.navigator.follow(path, **more)
    places = []
    while drive.status.state not in ("arrived", "blocked"):
        drive.tick()
        places.append(drive.pose[:2])
        assert drive.now < 120.0
    return drive, np.array(places)


@pytest.mark.parametrize("as_path", [Path, np.ndarray.tolist])
def test_a_given_path_is_followed_to_its_end(as_path):
    """Though its end is nearer to the robot than its first corner, and another way is shorter."""
    drive, places = drive_along(as_path(SQUARE))
    assert drive.status.state == "arrived"
    assert math.dist(drive.pose[:2], SQUARE[-1]) <= 0.3
    dense = Path(SQUARE).resampled(0.0, 1e9, 0.1)
    for x, y in dense:
        assert np.hypot(*(places - (x, y)).T).min() < 0.75  # corners are rounded
    for place in places:
        assert np.hypot(*(dense - place).T).min() < 0.5
    assert drive.status.plan is None
    assert drive.status.replans == 0


@pytest.mark.parametrize("heading", [None, 1.0])
def test_a_path_that_ends_where_it_begins_is_driven_all_round(heading):
    drive, places = drive_along(np.vstack([SQUARE, SQUARE[:1]]), heading=heading)
    assert drive.status.state == "arrived"
    assert np.hypot(*np.diff(places, axis=0).T).sum() > 12.0


def test_a_path_is_joined_where_the_robot_is():
    drive, places = drive_along(SQUARE, pose=(6.4, 3.0, math.pi / 2))
    assert drive.status.state == "arrived"
    assert places[:, 1].min() > 1.9  # it did not go back to the path's beginning


def test_at_its_end_a_heading_is_turned_to():
    drive, _ = drive_along([(1.5, 3.0), (4.0, 3.0)], pose=(1.5, 3.0, 0.0), heading=2.0)
    assert drive.pose.theta == pytest.approx(2.0, abs=0.15)


def test_a_box_on_a_given_path_is_gone_round():
    drive, places = drive_along(
        [(1.5, 3.0), (6.5, 3.0)], pose=(1.5, 3.0, 0.0), true=room(8.0, 6.0, (3.5, 2.7, 4.0, 3.3))
    )
    assert drive.status.state == "arrived"
    assert abs(places[:, 1] - 3.0).max() > 0.4


@pytest.mark.parametrize(
    ("path", "words"),
    [([1.0, 2.0, 3.0], "shape"), (np.zeros((4, 3)), "shape"), (np.zeros((0, 2)), "shape"),
     ([(0.0, math.nan)], "finite"), ("ab", "expected points"), ([(0, 0), (1,)], "expected points"),
     ([(0, 0), (1e7, 0)], "within 1e[+]06 m"), ([(9e5, 0), (9e5, 1)] * 99_999, "at most 100000 m"),
     ([(0, 0), (1e300, 0)], "within")],
)  # fmt: skip
def test_a_path_that_is_none_is_refused(path, words):
    with pytest.raises(InputError, match=words):
        Drive(room()).navigator.follow(path)


@pytest.mark.parametrize("heading", ["north", math.nan, math.inf, 90.0, 10**400])
def test_a_path_with_a_heading_that_is_none_is_refused(heading):
    with pytest.raises(InputError, match=r"heading|a goal is"):
        Drive(room()).navigator.follow([(1.0, 2.0), (3.0, 2.0)], heading)


def test_a_mission_is_cancelled_by_a_stop_within_the_limits():
    drive = Drive(room())
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.for_seconds(2.0)
    before = drive.twist.v
    assert before > 0.5
    drive.navigator.cancel()
    assert (drive.status.state, drive.status.reason) == ("idle", "cancelled")
    limits = drive.robot.limits
    while drive.twist != REST:
        command = drive.tick()
        assert before - limits.v_brake * 0.1 - 1e-9 <= command.v <= before
        before = command.v
        assert drive.now < 5.0
    assert drive.tick() == REST


def test_the_first_plan_for_each_goal_is_no_replan():
    drive = Drive(room())
    drive.navigator.set_goal([Goal(3.0, 3.0), Goal(4.5, 3.0), Goal(6.0, 3.0)])
    drive.until("arrived")
    assert drive.status.plan_id == 3
    assert drive.status.replans == 0


def test_a_path_by_eq_2_gives_way_to_one_that_is_clearly_shorter():
    """Eq. 2 goes round the nearer end of the first wall; past the second, the other is nearer."""
    known = room(12.0, 8.0, (3.5, 2.0, 3.8, 5.5), (7.0, 2.0, 7.3, 7.9))
    drive = Drive(known, pose=(1.5, 4.0, 0.0), planner=PlannerConfig(exact=True))
    drive.navigator.set_goal(Goal(10.0, 4.0))
    drive.tick()
    first = drive.status.plan
    assert first is not None
    assert first.planner == "improved"
    drive.tick()
    second = drive.status.plan
    assert second is not None
    assert (second.planner, drive.status.plan_id) == ("auto", 2)
    assert drive.status.plan_reason == "an exact search found a shorter path"
    assert second.path.length < 0.99 * first.path.length
    assert drive.status.replans == 0


def test_a_new_goal_ends_the_manoeuvre_for_the_last():
    drive = Drive(room())
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.for_seconds(1.0)
    assert drive.navigator.driving._last.v > 0.0
    drive.navigator.set_goal(Goal(1.5, 1.5))
    assert drive.navigator.driving._last == AT_REST


def test_what_is_blocked_is_still_so_after_data_were_missing():
    drive = Drive(room())
    drive.navigator.set_goal(Goal(100.0, 3.0))
    drive.tick()
    assert drive.status.state == "blocked"
    drive.now += 1.0
    drive.navigator.command(drive.state, [])
    assert drive.status.state == "sensor_lost"
    for _ in range(3):
        assert drive.tick() == REST
        assert drive.status.state == "blocked"


def test_in_the_tick_that_says_blocked_nothing_is_driven():
    """The robot is held where it stands: it is told to drive and does not move."""
    drive = Drive(room(), stuck_time=0.5, attempts=1)
    drive.navigator.set_goal(Goal(6.5, 3.0))
    command = Twist(1.0, 0.0)
    while drive.status.state != "blocked":
        before = command
        command = drive.navigator.command(drive.state, drive.scan())
        drive.now += 0.1
        assert drive.now < 20.0
    assert before.v > 0.0
    assert command == REST


def zoned(x0, y0, x1, y1):
    """The room with a keep-out zone, metres."""
    keepout = np.zeros((60, 80), bool)
    keepout[round(10 * y0) : round(10 * y1), round(10 * x0) : round(10 * x1)] = True
    return OccupancyGrid(room().values, room().frame, keepout), keepout


def ticks_inside(drive, keepout, *states):
    """Whether the robot has not left a zone, tick by tick, and the metres its centre drove inside."""
    inside, driven = [], 0.0
    while not inside or drive.status.state not in states:
        before = drive.pose
        centre = bool(keepout[int(10 * before.y), int(10 * before.x)])
        inside.append(centre or drive.navigator.planning_map.zone is not None)
        drive.tick()
        driven += centre * math.dist(before[:2], drive.pose[:2])
        assert drive.now < 60.0, (drive.status.state, drive.status.reason)
    return inside, driven


@pytest.mark.parametrize(
    ("pose", "longest"),
    [((3.5, 2.2, 0.0), 1.9), ((3.0, 3.7, -1.5), 1.5), ((4.2, 3.0, 3.1), 1.7)],
)
def test_a_robot_in_a_keepout_zone_leaves_it_once_and_arrives(pose, longest):
    known, keepout = zoned(2.0, 1.0, 5.0, 4.0)
    drive = Drive(known, pose=pose)
    drive.navigator.set_goal(Goal(7.0, 5.0))
    inside, driven = ticks_inside(drive, keepout, "arrived", "blocked")
    assert drive.status.state == "arrived"
    assert inside[0]
    assert driven < longest
    assert not any(later and not now for now, later in itertools.pairwise(inside))


LONG = Footprint.polygon([(0.7, -0.25), (0.7, 0.25), (-0.15, 0.25), (-0.15, -0.25)])


@pytest.mark.parametrize("shape", [LONG, ROBOTS["jackal"].footprint], ids=["long", "jackal"])
def test_a_robot_longer_than_wide_leaves_a_keepout_zone_with_all_of_its_footprint(shape):
    """The zone stays open until the disc round the robot has left, so that it can still turn."""
    known, keepout = zoned(2.0, 1.0, 5.0, 3.2)
    keepout[10:45, 20:27] = True  # the zone has an arm
    robot = replace(ROUND, footprint=shape, limits=ROUND.limits._replace(v_min=-0.3))
    drive = Drive(OccupancyGrid(known.values, known.frame, keepout), robot, (3.5, 2.2, 0.0))
    drive.navigator.set_goal(Goal(7.0, 5.0))
    ticks_inside(drive, keepout, "arrived", "blocked")
    assert drive.status.state == "arrived"
    assert drive.navigator.planning_map.zone is None


def test_a_robot_outside_never_enters_a_keepout_zone():
    known, keepout = zoned(3.0, 0.1, 5.0, 4.5)
    drive = Drive(known, pose=(1.5, 2.0, 0.0))
    drive.navigator.set_goal(Goal(6.5, 2.0))
    assert not any(ticks_inside(drive, keepout, "arrived")[0])
    assert drive.navigator.planning_map.zone is None


class Straight:
    """Draws a line from start to goal, or fails as it is told."""

    def __init__(self, answer=None):
        self.answer, self.asked = answer, []

    def plan(self, grid, start, goal, radius):
        assert isinstance(grid, OccupancyGrid)
        self.asked.append((start, goal, radius))
        if isinstance(self.answer, Exception):
            raise self.answer
        return [start, goal] if self.answer is None else self.answer


def drive_by(planner, **more):
    drive = Drive(room(), **more)
    drive.navigator = Navigator(room(), ROUND, planner=planner)
    drive.navigator.set_goal(Goal(6.5, 3.0))
    return drive


def test_another_planner_plans_in_place_of_ours():
    planner = Straight()
    drive = drive_by(planner)
    drive.until("arrived")
    assert drive.status.plan.planner == "Straight"
    assert planner.asked[0][0] == pytest.approx((1.5, 3.0))
    assert planner.asked[0][1] == (6.5, 3.0)
    assert planner.asked[0][2] >= 0.25


def test_another_planner_gets_to_know_what_was_seen():
    class Ours:
        def plan(self, grid, start, goal, radius):
            return GridPlanner(grid, radius).plan(start, goal).path

    drive = drive_by(Ours(), true=room(8.0, 6.0, (3.5, 1.0, 4.0, 4.4)))
    drive.until("arrived")
    assert drive.status.replans > 0


@pytest.mark.parametrize(
    ("answer", "words"),
    [
        (NoPath("there is none"), "there is none"),
        (RuntimeError("out of order"), "Straight failed.*out of order"),
        ([(0.5, 0.5), (6.5, 3.0)], "begins 2.69 m from"),
        ([(1.5, 3.0), (3.0, 3.0)], "ends 3.5 m from"),
        ([(math.inf, 3.0)], "failed"),
    ],
)
def test_a_planner_that_fails_stops_the_robot_and_raises_nothing(answer, words, caplog):
    caplog.set_level(logging.CRITICAL)
    drive = drive_by(Straight(answer))
    assert drive.tick() == REST
    assert drive.status.state == "blocked"
    assert isinstance(drive.status.error, NoPath)
    assert drive.status.error.args[0]
    assert re.search(words, str(drive.status.error))


def test_a_robot_without_a_path_says_which_planner_failed(caplog):
    caplog.set_level(logging.CRITICAL)
    planner = Straight()
    drive = drive_by(planner, true=room(8.0, 6.0, (5.0, 1.0, 5.5, 2.0)))
    drive.tick()
    planner.answer = RuntimeError("out of order")
    drive.navigator.route.drop()
    drive.tick()
    assert drive.status.state == "waiting"
    assert re.search("no path for now: .*Straight failed.*out of order", drive.status.reason)


def test_another_map_keeps_the_path_that_was_given():
    path = [(1.5, 1.5), (3.0, 4.5), (6.5, 1.5)]
    drive = Drive(room(), pose=(1.5, 1.5, 0.0), true=room(8.0, 6.0, (4.0, 0.0, 4.3, 6.0)))
    drive.navigator.follow(path)
    drive.until("blocked", seconds=120.0)
    drive.lidar = LidarSimulator(drive.robot.lidar, room())
    drive.navigator.set_map(room())
    drive.tick()
    assert drive.navigator.route.given is not None
    drive.until("arrived", seconds=240.0)


def test_a_change_of_the_map_is_looked_at_though_it_came_right_after_a_plan():
    drive = under_way()
    route, seen = drive.navigator.route, []
    route._is_blocked = lambda: seen.append(drive.now) or False
    goal = Goal(6.5, 3.0)
    route._planned_at = drive.now
    for changed, later in ((True, 0.2), (False, 0.6), (False, 1.1), (False, 1.2)):
        state = drive.state._replace(stamp=drive.now + later)
        route.update(state, goal, changed, True)
    assert len(seen) == 1


@pytest.mark.parametrize("seen", [True, False])
def test_who_stands_so_near_that_the_start_is_occupied_is_waited_for(seen):
    """All round the robot: on the map, from where nothing leads out, or sensed, which may go."""
    free = np.zeros((120, 160), bool)
    taken = free.copy()
    taken[20:101, 40:121] = True
    grid = OccupancyGrid.from_occupied(free if seen else taken, 0.05)
    navigator = Navigator(grid, ROUND)
    if seen:
        navigator.planning_map.seen[:] = taken
        navigator.planners.mark((0, 0, taken))
    planner = navigator.planners
    with pytest.raises(NoPath if seen else StartOccupied, match="has no room"):
        planner.plan((4.0, 3.0), (7.5, 5.5))


def test_a_robot_comes_to_rest_before_it_plans_anew(monkeypatch):
    """With finer cells that may take seconds, in which a driver goes on with the last command."""
    drive = under_way(latency=0.1)
    at, drop = [], drive.navigator.route.drop

    def noted():
        at.append(drive.twist)
        drop()

    monkeypatch.setattr(drive.navigator.route, "drop", noted)
    monkeypatch.setattr(drive.navigator.progress, "patience", -1.0)
    drive.tick()
    monkeypatch.setattr(drive.navigator.progress, "patience", 6.0)
    said = [drive.tick() and drive.status.state for _ in range(30)]
    assert at == [(0.0, 0.0)]
    assert drive.status.recoveries == 1
    assert said[0] == "recovering"
    drive.until("arrived")


def test_cells_are_halved_where_nothing_leads_on_unless_the_map_is_large(monkeypatch):
    drive = under_way()
    for most, resolution in ((4 * 120 * 160 - 1, 0.05), (4 * 120 * 160, 0.025)):
        monkeypatch.setattr("dynastar.navigator.config.MOST_CELLS", most)
        drive.navigator._refine()
        assert drive.navigator.planning_map.grid.resolution == pytest.approx(resolution)
    drive.until("arrived")

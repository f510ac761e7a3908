"""The navigator, called by hand: goals, masks, movers, and what it tells."""

import math

import numpy as np
import pytest

from driving import LIMITS, PERIOD, REST, ROUND, Drive, room, under_way
from dynastar.errors import GoalOccupied, InputError, NoPath, OutOfMap
from dynastar.footprint import Footprint
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator
from dynastar.navigator.config import FINE, PRESETS
from dynastar.perception import MovingObstacle
from dynastar.robot import ROBOTS, Lidar, Limits, Robot
from dynastar.simulation.lidar import LidarSimulator

BACKING = Robot("backing", LIMITS._replace(v_min=-0.5), ROUND.footprint, ROUND.lidar)

# -- goals -----------------------------------------------------------------------------------------


def test_goals_are_reached_in_order():
    drive = Drive(room())
    goals = [Goal(4.0, 4.5), Goal(6.5, 3.0), Goal(4.0, 1.5)]
    drive.navigator.set_goal(goals)
    visited = []
    while drive.status.state != "arrived":
        left = drive.status.goals_left
        drive.tick()
        if drive.status.goals_left < left:
            visited.append(drive.pose[:2])
        assert drive.now < 90.0
    for (x, y, _), at in zip(goals[:-1], visited, strict=False):
        assert math.dist((x, y), at) < 0.4
    assert math.dist(drive.pose[:2], goals[-1][:2]) < 0.3
    assert drive.status.goals_left == 0


@pytest.mark.parametrize("heading", [math.pi, -math.pi / 2])
def test_a_heading_asked_for_is_turned_to(heading):
    drive = Drive(room())
    drive.navigator.set_goal(Goal(4.0, 3.0, heading))
    said = drive.until("arrived")
    drive.for_seconds(2.0)
    assert "turning" in said
    assert abs(math.remainder(drive.pose.theta - heading, math.tau)) < 0.15
    assert math.dist(drive.pose[:2], (4.0, 3.0)) < 0.3


def test_a_goal_that_is_not_finite_is_an_error():
    with pytest.raises(InputError, match="expected finite numbers"):
        Drive(room()).navigator.set_goal(Goal(math.nan, 1.0))


def test_arrived_is_said_by_a_robot_that_rests_within_the_tolerance():
    for start in ((1.5, 3.0, 0.0), (6.4, 1.0, 1.0), (3.0, 5.0, -2.0)):
        drive = Drive(room(), pose=start)
        drive.navigator.set_goal(Goal(4.5, 3.2))
        drive.until("arrived")
        while drive.twist != REST:
            drive.tick()
        assert math.dist(drive.pose[:2], (4.5, 3.2)) <= 0.25 + 1e-6


def test_no_goal_is_idle():
    drive = Drive(room())
    assert drive.tick() == REST
    assert drive.status.state == "idle"
    drive.navigator.set_goal(Goal(4.0, 3.0))
    drive.for_seconds(1.5)
    drive.navigator.set_goal([])
    drive.for_seconds(2.0)
    assert (drive.status.state, drive.twist) == ("idle", REST)


WALLED = room(8.0, 6.0, (4.0, 0.0, 4.3, 6.0))


@pytest.mark.parametrize(
    ("goal", "error"),
    [
        (Goal(4.1, 3.0), GoalOccupied),
        (Goal(20.0, 3.0), OutOfMap),
        (Goal(-0.01, 3.0), OutOfMap),
        (Goal(6.5, 3.0), NoPath),
    ],
)
def test_a_goal_that_cannot_be_reached_is_said_and_not_raised(goal, error):
    drive = Drive(WALLED)
    drive.navigator.set_goal(goal)
    assert drive.until("blocked", seconds=60.0)
    assert isinstance(drive.status.error, error)
    assert str(drive.status.error) in drive.status.reason
    assert drive.twist == REST
    drive.navigator.set_goal(Goal(2.5, 4.0))  # and it goes on where it can
    drive.until("arrived")
    assert drive.status.error is None


def test_another_goal_under_way_is_driven_to_within_the_limits():
    drive = under_way()
    drive.navigator.set_goal(Goal(1.5, 4.5))
    before = drive.twist
    command = drive.tick()
    assert command.v >= before.v - LIMITS.v_brake * PERIOD - 1e-9
    drive.until("arrived")
    assert math.dist(drive.pose[:2], (1.5, 4.5)) < 0.3


def test_another_map_under_way_is_planned_on():
    drive = under_way()
    drive.navigator.set_map(room(8.0, 6.0, (4.0, 0.0, 4.3, 4.0)))
    drive.tick()
    assert drive.status.plan.path.points[:, 1].max() > 4.0
    drive.until("arrived")


@pytest.mark.parametrize(
    "grid", [OccupancyGrid(np.zeros((80, 80), np.int8), 100.0), np.zeros((60, 80), bool)]
)
def test_a_map_that_is_refused_changes_nothing(grid):
    drive = under_way()
    before = repr(drive.navigator)
    with pytest.raises(InputError):
        drive.navigator.set_map(grid)
    assert repr(drive.navigator) == before
    drive.until("arrived")


def test_the_name_of_a_planner_is_no_planner():
    with pytest.raises(InputError, match=r"a planner: got 'astar'.*PlannerConfig"):
        Navigator(room(), ROUND, planner="astar")


def test_another_map_revives_who_found_no_way_on_the_last():
    drive = Drive(WALLED)
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.until("blocked", seconds=60.0)
    drive.navigator.set_map(room())
    drive.lidar = LidarSimulator(drive.robot.lidar, room())
    drive.until("arrived")
    assert math.dist(drive.pose[:2], (6.5, 3.0)) < 0.3


def test_another_map_revives_who_lost_its_data_after_it_found_no_way():
    drive = Drive(WALLED)
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.until("blocked", seconds=60.0)
    drive.now += 1.0
    drive.navigator.command(drive.state, [])
    assert drive.status.state == "sensor_lost"
    drive.navigator.set_map(room())
    drive.lidar = LidarSimulator(drive.robot.lidar, room())
    drive.until("arrived")


def test_data_that_come_back_after_the_end_are_no_reason_to_drive():
    drive = Drive(room())
    drive.tick()
    for _ in range(3):
        drive.now += 0.4
        drive.navigator.command(drive.state, [])
    assert drive.status.state == "sensor_lost"
    assert drive.tick() == REST
    assert drive.status.state == "idle"


def test_a_start_inside_the_inflation_finds_its_way_out():
    drive = Drive(room(), pose=(0.38, 3.0, math.pi / 2))  # 3 cm from the wall
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.until("arrived")


# -- masks -----------------------------------------------------------------------------------------


def test_what_is_kept_out_of_is_never_entered():
    grid = room()
    keepout = np.zeros(grid.values.shape, bool)
    keepout[10:50, 35:45] = True
    drive = Drive(OccupancyGrid(grid.values, grid.frame, keepout=keepout), true=grid)
    drive.navigator.set_goal(Goal(6.5, 3.0))
    while drive.status.state != "arrived":
        drive.tick()
        dx = max(3.5 - drive.pose.x, drive.pose.x - 4.5, 0.0)
        dy = max(1.0 - drive.pose.y, drive.pose.y - 5.0, 0.0)
        assert math.hypot(dx, dy) >= ROUND.footprint.circumscribed
        assert drive.now < 60.0


def test_a_speed_limit_of_the_map_is_kept():
    grid = room(12.0, 6.0)
    limit = np.full(grid.values.shape, np.inf)
    limit[:, 50:80] = 0.2
    drive = Drive(OccupancyGrid(grid.values, grid.frame, speed_limit=limit), true=grid)
    drive.navigator.set_goal(Goal(10.5, 3.0))
    slow, fast = [0.0], [0.0]
    while drive.status.state != "arrived":
        drive.tick()
        (slow if 5.0 < drive.pose.x < 8.0 else fast).append(drive.twist.v)
        assert drive.now < 90.0
    assert max(slow) <= 0.2 + 0.02
    assert max(fast) > 0.5


# -- movers ----------------------------------------------------------------------------------------


def test_movers_that_are_given_replace_those_tracked():
    drive = under_way()
    ahead = drive.pose.x + 1.2
    standing = MovingObstacle(ahead, 3.0, 0.0, 0.0, 0.3)

    def refused():
        choice = drive.status.choice
        return choice is None or choice.refusals["moving obstacle"] > 0

    seen = []
    for _ in range(40):
        drive.tick(movers=[standing])
        seen.append(refused())
        assert math.dist(drive.pose[:2], (ahead, 3.0)) > 0.3 + ROUND.footprint.circumscribed
    assert any(seen)
    drive.for_seconds(1.0)
    assert not refused()  # the tracker sees nobody


@pytest.mark.parametrize(
    "mover", [(math.nan, 3.0, 0.0, 0.0, 0.3), (4.0, 3.0, 0.0, 1e9, 0.3), (4.0, 3.0, 0.0, 0.0, -0.3)]
)
def test_a_mover_whose_numbers_cannot_be_brakes_and_says_so(mover):
    drive = under_way()
    before = drive.twist.v
    for _ in range(3):
        drive.tick(movers=[MovingObstacle(*mover)])
    assert drive.twist.v < before
    assert "a moving obstacle is (" in drive.status.reason
    drive.tick(movers=[])
    assert drive.status.state == "following"


# -- robots of other kinds -------------------------------------------------------------------------


@pytest.mark.parametrize("goal", [Goal(6.5, 3.0), Goal(1.2, 3.0), Goal(4.0, 1.0)])
def test_a_robot_that_is_blind_behind_starts_and_turns(goal):
    drive = Drive(room(), ROBOTS["jackal"], pose=(4.0, 3.0, 0.0))
    drive.navigator.set_goal(goal)
    drive.until("arrived", seconds=90.0)


def test_a_robot_that_may_reverse_backs_off_out_of_a_dead_end():
    long = Robot(
        "long",
        Limits(0.3, 1.0, 1.0, 2.0, 1.0, 2.0, v_min=-0.3),
        Footprint.polygon([(0.3, -0.15), (0.3, 0.15), (-0.3, 0.15), (-0.3, -0.15)]),
        Lidar(360, math.tau, 0.0, 6.0),
    )
    # A corridor 0.6 m wide, in which it cannot turn; the goal lies behind it.
    grid = room(8.0, 6.0, (4.0, 0.0, 8.0, 2.7), (4.0, 3.3, 8.0, 6.0))
    drive = Drive(grid, long, pose=(4.9, 3.0, 0.0), stuck_time=2.0)
    drive.navigator.set_goal(Goal(1.5, 3.0))
    backwards = False
    while drive.status.state != "arrived":
        backwards |= drive.tick().v < -0.1
        assert drive.now < 120.0, (drive.status.state, drive.status.reason, drive.pose)
    assert backwards


# -- what it tells ---------------------------------------------------------------------------------


def test_a_preset_may_rule_out_driving_back():
    assert ROBOTS["paper"].limits.v_min < 0.0
    for preset, v_min in (("default", ROBOTS["paper"].limits.v_min), ("paper", 0.0)):
        navigator = Navigator(room(), ROBOTS["paper"], PRESETS[preset])
        assert navigator.robot.limits.v_min == v_min
        assert navigator.driving.window.rules.limits.v_min == v_min


@pytest.mark.parametrize(
    ("name", "start", "goal"),
    [
        pytest.param("jackal", (1.5, 4.0, 0.0), (4.5, 4.0)),
        pytest.param("pioneer3dx", (6.0, 6.5, 1.0), (4.0, 4.0)),
        ("turtlebot3_burger", (6.0, 6.5, 1.0), (4.0, 4.0)),
        ("paper", (6.0, 6.5, 1.0), (4.0, 4.0)),
    ],
)
def test_every_robot_reaches_a_goal_in_an_empty_room(name, start, goal):
    drive = Drive(room(8.0, 8.0), ROBOTS[name], start, hidden_speed=0.0)
    drive.navigator.set_goal(Goal(*goal))
    drive.until("arrived", seconds=60.0)
    assert math.dist(drive.pose[:2], goal) <= 0.25 + 0.05


def test_a_block_that_no_map_shows_is_planned_round():
    drive = Drive(room())
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.tick()
    drive.lidar = LidarSimulator(ROUND.lidar, room(8.0, 6.0, (3.6, 2.0, 4.2, 4.0)))
    drive.until("arrived")


def test_who_waits_for_a_path_steps_aside_for_who_comes():
    """A wall that no map shows closes the room, so there is no path for some seconds."""
    drive = Drive(room(), true=room(8.0, 6.0, (5.0, 0.0, 5.2, 6.0)))
    drive.navigator.set_goal(Goal(7.0, 3.0))
    drive.until("waiting")
    assert "no path" in drive.status.reason
    where = drive.pose
    x, gaps = where.x - 2.0, []
    for _ in range(25):
        x += 0.8 * PERIOD
        drive.tick(movers=[MovingObstacle(x, where.y, 0.8, 0.0, 0.25)])
        gaps.append(math.dist(drive.pose[:2], (x, where.y)) - 0.5)
        if drive.status.state != "waiting":
            break
    assert math.dist(drive.pose[:2], where[:2]) > 0.2
    assert min(gaps) > 0.0


@pytest.mark.parametrize(("speed", "ends"), [(0.0, "blocked"), (0.2, "arrived")])
def test_unseen_space_is_backed_into_as_the_last_resort(speed, ends):
    """A Jackal, whose lidar does not see what is behind it, faces a dead end as narrow as itself."""
    walls = [(3.6, 3.3, 5.0, 3.4), (3.6, 2.6, 5.0, 2.7), (5.0, 2.6, 5.1, 3.4)]
    start, true = (4.5, 3.0, 0.0), room(8.0, 6.0, *walls)
    drive = Drive(room(), ROBOTS["jackal"], start, true=true, unseen_speed=speed)
    drive.navigator.set_goal(Goal(7.0, 3.0))
    fastest = 0.0
    while drive.status.state not in ("arrived", "blocked"):
        drive.tick()
        if drive.navigator.sensing.trusts_map:
            fastest = max(fastest, abs(drive.twist.v))
        assert drive.now < 180.0
    assert drive.status.state == ends
    assert fastest <= speed + 1e-9


def test_cells_are_halved_where_sensed_cells_leave_no_way():
    drive = Drive(room(), true=room(8.0, 6.0, (4.0, 0.0, 4.2, 6.0)))
    drive.navigator.set_goal(Goal(6.5, 3.0))
    coarse = drive.navigator.planning_map.grid.resolution
    while drive.status.recoveries < 1:
        drive.tick()
        assert drive.now < 60.0
    assert drive.navigator.planning_map.grid.resolution == pytest.approx(0.5 * coarse)
    assert drive.navigator.sensing.local_map.resolution == pytest.approx(0.5 * coarse)
    drive.tick()
    assert (drive.navigator.sensing.local_map.open > 0).sum() > 1000  # what was seen is kept
    drive.until("blocked", seconds=120.0)
    finest = 0.5 * ROUND.footprint.inscribed / FINE
    assert drive.navigator.planning_map.grid.resolution >= finest
    assert "no way is left" in drive.status.reason

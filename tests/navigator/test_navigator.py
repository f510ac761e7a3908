"""The navigator, called by hand: goals, masks, movers, and what it tells."""

import math

import numpy as np
import pytest

from driving import LIMITS, PERIOD, REST, ROUND, Drive, room, under_way
from dynastar.errors import GoalOccupied, NoPath, OutOfMap
from dynastar.geometry import Goal, Twist
from dynastar.grid import OccupancyGrid
from dynastar.navigator import Navigator, NavigatorConfig
from dynastar.navigator.config import PRESETS
from dynastar.obstacles import MovingObstacle
from dynastar.robot import ROBOTS, Footprint, Lidar, Limits, Robot
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
    with pytest.raises(ValueError, match="expected finite numbers"):
        Drive(room()).navigator.set_goal(Goal(math.nan, 1.0))


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


def test_another_map_revives_who_found_no_way_on_the_last():
    drive = Drive(WALLED)
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.until("blocked", seconds=60.0)
    drive.navigator.set_map(room())
    drive.lidar = LidarSimulator(drive.robot.lidar, room())
    drive.until("arrived")
    assert math.dist(drive.pose[:2], (6.5, 3.0)) < 0.3


def test_data_that_come_back_after_the_end_are_no_reason_to_drive():
    drive = Drive(room())
    drive.tick()
    drive.now += 1.0
    for _ in range(3):
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
    for _ in range(40):
        drive.tick(movers=[standing])
        assert math.dist(drive.pose[:2], (ahead, 3.0)) > 0.3 + ROUND.footprint.circumscribed
    assert drive.status.choice is None or drive.status.choice.refused_for_movers > 0
    drive.for_seconds(1.0)
    assert drive.status.choice.refused_for_movers == 0  # the tracker sees nobody


@pytest.mark.parametrize("step", ["turn", "back off"])
def test_who_recovers_gets_out_of_the_way_of_movers_as_others_do(step):
    drive = Drive(room(), pose=(4.0, 3.0, 0.0), robot=BACKING)
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.tick()
    while drive.navigator.recovery.next(drive.now, True) != step:
        pass
    lasts = drive.now + (2.0 if step == "back off" else 4.0)
    for k in range(40):
        y = 4.5 - 0.05 * k
        drive.tick(movers=[MovingObstacle(4.1, y, 0.0, -0.5, 0.3)])
        assert drive.status.state == "recovering" or drive.now > lasts
        assert math.dist(drive.pose[:2], (4.1, y)) > 0.3 + ROUND.footprint.circumscribed


def test_ways_past_movers_are_told_how_fast_the_path_can_be_driven(monkeypatch):
    drive = under_way()
    told = []
    monkeypatch.setattr(drive.navigator.passing, "go_on", lambda start, **_: told.append(start))
    drive.tick(movers=[MovingObstacle(drive.pose.x + 1.2, 3.0, 0.0, 0.0, 0.3)])
    x, y, pace = told[0].path.T
    assert np.all(y == 3.0)
    assert np.all(np.diff(x) >= 0.0)
    assert np.all(pace[x < 5.5] == LIMITS.v_max)
    assert np.all(pace <= LIMITS.v_max)
    near_goal = Drive(room(), pose=(5.5, 3.0, 0.0))
    near_goal.navigator.set_goal(Goal(6.5, 3.0))
    near_goal.tick()
    monkeypatch.setattr(near_goal.navigator.passing, "go_on", lambda start, **_: told.append(start))
    near_goal.tick(movers=[MovingObstacle(6.4, 3.0, 0.0, 0.0, 0.3)])
    pace = told[1].path[:, 2]
    assert np.all(np.diff(pace) <= 1e-9)  # it brakes for its end
    assert pace[-1] < 0.2


def test_a_mover_that_is_not_finite_is_left_out():
    drive = under_way()
    for _ in range(10):
        drive.tick(movers=[MovingObstacle(math.nan, 3.0, 0.0, 0.0, 0.3)])
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


@pytest.mark.parametrize("normalisation", ["window", "range", "sum"])
def test_the_choice_explains_the_tick(normalisation):
    base = NavigatorConfig()
    drive = under_way(dwa=base.dwa._replace(normalisation=normalisation))
    choice = drive.status.choice
    admissible = choice.refused == 0
    assert sum(choice.shares.values()) == pytest.approx(choice.score.max())
    assert (choice.score[~admissible] == -np.inf).all()
    assert sum(choice.refusals.values()) == (~admissible).sum()
    best = choice.samples[choice.score.argmax()]
    assert tuple(choice.sample) == tuple(best)
    for sample in (REST, Twist(choice.samples[:, 0].max(), 0.0)):
        gap = np.abs(choice.samples - sample).max(axis=1).min()
        assert gap < 1e-9 or LIMITS.v_brake * drive.navigator.window.reach < drive.twist.v


def test_a_preset_may_rule_out_driving_back():
    assert ROBOTS["paper"].limits.v_min < 0.0
    for preset, v_min in (("default", ROBOTS["paper"].limits.v_min), ("paper", 0.0)):
        navigator = Navigator(room(), ROBOTS["paper"], PRESETS[preset])
        assert navigator.robot.limits.v_min == v_min
        assert navigator.passing.robot.limits.v_min == v_min


# -- less than the whole ---------------------------------------------------------------------------

BLOCK = (3.6, 2.0, 4.2, 4.0)


def test_the_target_by_distance_alone_lies_behind_the_corner():
    walled = room(8.0, 6.0, (2.2, 0.0, 2.4, 3.6))
    ahead = {}
    for how in ("visible", "distance"):
        drive = Drive(walled, pose=(1.6, 3.0, math.pi / 2), target=how)
        drive.navigator.set_goal(Goal(4.0, 1.5))
        drive.tick()
        path = drive.status.plan.path
        ahead[how] = path.project(*drive.status.target)
        assert math.dist(path.at(ahead[how]), drive.status.target) < 1e-6
        assert drive.status.state == "following"
        if how == "visible":  # the other drives at the wall's end, and may stay there
            drive.until("arrived")
    lookahead = NavigatorConfig().lookahead
    assert ahead["visible"] < lookahead - 0.1
    assert ahead["distance"] == pytest.approx(lookahead, abs=0.05)


def test_a_path_planned_once_is_kept_whatever_comes():
    replanned, once = (Drive(room(), global_path=how, attempts=1) for how in ("replanned", "once"))
    for drive in (replanned, once):
        drive.navigator.set_goal(Goal(6.5, 3.0))
        drive.tick()
        drive.lidar = LidarSimulator(ROUND.lidar, room(8.0, 6.0, BLOCK))
    replanned.until("arrived")
    assert replanned.status.replans >= 1
    said = once.until("blocked", seconds=200.0)
    assert said.count("recovering") > 0
    assert (once.status.replans, once.status.plan_id) == (0, 1)
    assert once.status.plan.path.turns == 0  # still the way through the block
    once.navigator.set_goal(Goal(1.5, 4.5))
    once.until("arrived")
    assert once.status.plan_id == 2


def test_without_a_global_path_the_line_to_the_goal_is_all():
    alone = {"global_path": "straight", "target": "distance", "lookahead": 50.0}
    free = Drive(room(), **alone)
    free.navigator.set_goal([Goal(4.0, 4.5), Goal(6.5, 3.0)])
    free.tick()
    assert free.status.target == pytest.approx((4.0, 4.5))
    free.until("arrived")
    assert (free.status.plan, free.status.replans, free.status.recoveries) == (None, 0, 0)
    assert math.dist(free.pose[:2], (6.5, 3.0)) < 0.3

    cup = room(8.0, 6.0, (5.0, 1.5, 5.2, 4.5), (3.5, 1.3, 5.2, 1.5), (3.5, 4.5, 5.2, 4.7))
    caught = Drive(cup, attempts=1, **alone)
    caught.navigator.set_goal(Goal(6.5, 3.0))
    caught.until("blocked", seconds=200.0)
    assert caught.pose.x < 5.0

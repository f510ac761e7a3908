"""The navigator, called by hand: states and scans as a robot would give them."""

import math

import numpy as np
import pytest

from dynastar.errors import GoalOccupied, NoPath, OutOfMap
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import Navigator, NavigatorConfig, RobotState
from dynastar.obstacles import MovingObstacle
from dynastar.robot import ROBOTS, Footprint, Lidar, Limits, Robot, arc, slew, stopping_time
from dynastar.scan import LaserScan
from dynastar.simulation.lidar import LidarSimulator

REST = Twist(0.0, 0.0)
PERIOD = 0.1
CELL = 0.1
LIMITS = Limits(1.0, 1.5, 0.8, 2.0, 0.8, 2.0)
ROUND = Robot("round", LIMITS, Footprint.disc(0.25), Lidar(360, math.tau, 0.0, 6.0))


def room(width=8.0, height=6.0, *boxes):
    """A room's map with boxes (x0, y0, x1, y1) in metres that stand in it."""
    occupied = np.zeros((round(height / CELL), round(width / CELL)), bool)
    occupied[[0, -1]] = occupied[:, [0, -1]] = True
    for box in boxes:
        x0, y0, x1, y1 = (round(metres / CELL) for metres in box)
        occupied[y0:y1, x0:x1] = True
    return OccupancyGrid(occupied, GridFrame(CELL))


class Drive:
    """A navigator and a robot that does exactly as told, in a true room."""

    def __init__(self, known, robot=ROUND, pose=(1.5, 3.0, 0.0), true=None, **config):
        self.navigator = Navigator(known, robot, NavigatorConfig(**config))
        self.lidar = LidarSimulator(robot.lidar, known if true is None else true)
        self.robot, self.pose, self.twist, self.now = robot, Pose2D(*pose), REST, 0.0

    @property
    def state(self):
        return RobotState(self.now, self.pose, self.twist)

    @property
    def status(self):
        return self.navigator.status

    def scan(self):
        return self.lidar.scan(self.pose, self.now)

    def tick(self, *scans, **more):
        """One command on the scans given (the lidar's if none is), carried out for one period."""
        command = self.navigator.command(self.state, scans or self.scan(), **more)
        self.carry_out(command)
        return command

    def carry_out(self, command, parts=10):
        limits, h = self.robot.limits, PERIOD / parts
        for _ in range(parts):
            after = Twist(
                slew(self.twist.v, command.v, limits.v_accel, limits.v_brake, h),
                slew(self.twist.omega, command.omega, limits.omega_accel, limits.omega_brake, h),
            )
            mean = Twist(*(0.5 * (a + b) for a, b in zip(self.twist, after, strict=True)))
            self.pose, self.twist = arc(self.pose, mean, h), after
        self.now += PERIOD

    def until(self, *states, seconds=60.0):
        """Drives until the navigator says one of ``states``; the states it went through."""
        said = []
        while not said or said[-1] not in states:
            assert self.now < seconds, (self.status.state, self.status.reason, self.pose)
            self.tick()
            said.append(self.status.state)
        return said

    def for_seconds(self, seconds):
        return [self.tick() for _ in range(round(seconds / PERIOD))]


def under_way(**more):
    """A drive across the room that has got up speed."""
    drive = Drive(room(), **more)
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.for_seconds(1.5)
    assert drive.twist.v > 0.4
    return drive


def with_ranges(scan, ranges, **more):
    given = {**vars(scan), "ranges": np.asarray(ranges, np.float32), **more}
    return LaserScan(**given)


# -- states that are not what they should be -------------------------------------------------------


@pytest.mark.parametrize("bad", [math.nan, math.inf])
@pytest.mark.parametrize("where", ["stamp", "pose", "twist"])
def test_a_state_that_is_not_finite_brakes_and_says_so(where, bad):
    drive = under_way()
    stamp, pose, twist = drive.state
    state = {
        "stamp": RobotState(bad, pose, twist),
        "pose": RobotState(stamp, pose._replace(y=bad), twist),
        "twist": RobotState(stamp, pose, twist._replace(omega=bad)),
    }[where]
    command = drive.navigator.command(state, drive.scan())
    assert 0.0 <= command.v < drive.twist.v
    assert drive.status.state == "sensor_lost"
    assert "not finite" in drive.status.reason


def test_time_that_goes_back_brakes_and_goes_on_when_time_does():
    drive = under_way()
    late = RobotState(drive.now - 1.0, drive.pose, drive.twist)
    command = drive.navigator.command(late, drive.scan())
    assert command.v < drive.twist.v
    assert (drive.status.state, drive.status.reason) == ("sensor_lost", "time went back by 0.900 s")
    drive.carry_out(command)
    drive.tick()
    assert drive.status.state == "following"


def test_a_jump_of_the_pose_is_survived():
    drive = under_way()
    drive.pose = drive.pose._replace(y=drive.pose.y + 1.0)
    drive.until("arrived")
    assert math.dist(drive.pose[:2], (6.5, 3.0)) < 0.3


# -- scans that are not what they should be --------------------------------------------------------


def test_without_any_scan_nothing_moves():
    drive = Drive(room())
    drive.navigator.set_goal(Goal(6.5, 3.0))
    for scans in (None, []):
        assert drive.navigator.command(drive.state, scans) == REST
        assert (drive.status.state, drive.status.reason) == ("sensor_lost", "no scan yet")


def test_a_stale_scan_is_no_scan():
    drive = under_way()
    old = drive.scan()
    for _ in range(30):
        drive.tick(old)
    assert drive.twist == REST
    assert drive.status.state == "sensor_lost"
    assert "no scan for" in drive.status.reason


def test_a_scan_from_the_future_is_not_used():
    drive = Drive(room())
    drive.navigator.set_goal(Goal(6.5, 3.0))
    scan = drive.scan()
    ahead = with_ranges(scan, scan.ranges, stamp=1.0)
    assert drive.tick(ahead) == REST
    assert "1.000 s ahead of the robot's state" in drive.status.reason


@pytest.mark.parametrize("beams", [0, 1, 100, 361])
def test_a_scan_of_another_size_is_not_used(beams):
    drive = under_way()
    for _ in range(30):
        drive.tick(with_ranges(drive.scan(), np.full(beams, 6.0)))
    assert drive.twist == REST
    assert drive.status.state == "sensor_lost"
    assert "beams" in drive.status.reason


@pytest.mark.parametrize("reading", [math.nan, 0.0, -1.0, -math.inf, 1e30])
def test_readings_that_say_nothing_free_nothing(reading):
    drive = Drive(room())
    drive.navigator.set_goal(Goal(6.5, 3.0))
    for _ in range(100):
        drive.tick(with_ranges(drive.scan(), np.full(360, reading)))
    assert math.dist(drive.pose[:2], (1.5, 3.0)) < 0.1
    assert drive.twist == REST


def test_all_inf_is_nothing_up_to_range_max():
    drive = Drive(room(40.0, 30.0), pose=(20.0, 15.0, 0.0))
    drive.navigator.set_goal(Goal(25.0, 15.0))
    assert np.isinf(drive.scan().ranges).all()
    drive.until("arrived")


def test_front_and_rear_lidar_see_together_what_neither_sees_alone():
    halves = [
        Lidar(181, math.pi, 0.0, 6.0, x=0.1),
        Lidar(181, math.pi, 0.0, 6.0, x=-0.1, theta=math.pi),
    ]
    drive = Drive(room(), pose=(4.0, 3.0, math.pi / 2))
    casts = [LidarSimulator(lidar, room()) for lidar in halves]
    drive.navigator.set_goal(Goal(6.5, 3.0))
    for _ in range(200):
        drive.tick(*(cast.scan(drive.pose, drive.now) for cast in casts))
        if drive.status.state == "arrived":
            break
    assert drive.status.state == "arrived"
    layer = drive.navigator.senses.layer
    x0, y0 = layer.origin

    def state(x, y):
        a = layer.config.resolution
        return layer.states[int((y - y0) / a), int((x - x0) / a)]

    assert state(drive.pose.x + 0.8, drive.pose.y) == state(drive.pose.x - 1.5, drive.pose.y) == 1


def test_sensor_loss_stops_along_the_arc_in_the_stopping_time_and_goes_on_afterwards():
    drive = under_way(pose=(1.5, 2.0, 0.6), scan_age=0.05)
    while abs(drive.twist.omega) < 0.05 or drive.twist.v < 0.3:
        drive.tick()
    drive.tick()
    begin, twist = drive.pose, drive.twist
    expected = arc(begin, twist, 0.5 * stopping_time(twist, LIMITS))
    ticks = 0
    stale = with_ranges(drive.scan(), drive.scan().ranges, stamp=drive.now - 1.0)
    while drive.twist != REST:
        drive.tick(stale)
        assert drive.status.state == "sensor_lost"
        ticks += 1
    assert ticks * PERIOD <= stopping_time(twist, LIMITS) + 1.01 * PERIOD
    assert math.dist(drive.pose[:2], expected[:2]) < 0.02
    assert drive.pose.theta == pytest.approx(expected.theta, abs=0.05)
    drive.until("arrived")


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

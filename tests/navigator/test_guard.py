"""The guard: what it lets pass, what it changes, and that nothing is touched."""

import math
from dataclasses import replace

import numpy as np
import pytest

from driving import CELL, LIMITS, PERIOD, ROUND, room, with_ranges
from dynastar.errors import InputError
from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.masks import with_keepout, with_speed_limits
from dynastar.navigator import Guard, Guarded, Navigator, NavigatorConfig, RobotState
from dynastar.navigator.guard import STEADY, STOP_POSES
from dynastar.perception import MovingObstacle
from dynastar.robot import ROBOTS, Lidar, Limits, Robot, slew
from dynastar.simulation import Drivetrain, Noise, Scenario, World
from dynastar.simulation.imperfections import Odometry

START = (1.5, 3.0, 0.0)
BOX = (4.0, 2.0, 5.0, 4.0)


class GuardedDrive:
    """A guard, and a robot in a true world that drives as it says."""

    def __init__(self, true=None, robot=ROUND, start=START, grid=None, scenario=None, **config):
        true = room() if true is None else true
        more = {} if scenario is None else scenario
        made = Scenario("guarded", true, robot, start, (Goal(6.5, 3.0),), **more)
        self.world, self.robot = World(made), robot
        self.config = NavigatorConfig(**{"hidden_speed": 0.0, **config})
        self.guard = Guard(robot, self.config, grid)

    def tick(self, command, **more):
        scan = more.pop("scan", self.world.scan())
        given = self.guard.filter(self.world.sensed_state(), scan, command, **more)
        self.world.step(given.command, self.config.period)
        return given

    def drive(self, command, seconds):
        """Results of asking for the same command, or for what a function of the world says."""
        ask = command if callable(command) else lambda world: command
        ticks = range(round(seconds / self.config.period))
        return [self.tick(ask(self.world)) for _ in ticks]


@pytest.fixture(params=["no map", "the map"])
def grid(request):
    return None if request.param == "no map" else room()


def test_a_command_that_leaves_room_to_stop_is_passed_on(grid):
    drive = GuardedDrive(grid=grid)
    found = drive.drive(Twist(0.5, 0.3), 2.0)
    assert [one.changed for one in found[10:]] == [False] * 10
    assert found[-1] == Guarded(Twist(0.5, 0.3), False, "")
    assert {one.reason for one in found if one.changed} == {"acceleration"}


def test_commands_change_no_faster_than_the_robot_can():
    drive, random = GuardedDrive(), np.random.default_rng(1)
    last = Twist(0.0, 0.0)
    for _ in range(30):
        wanted = Twist(random.uniform(-1.0, 1.5), random.uniform(-2.0, 2.0))
        for one in drive.drive(wanted, 0.5):
            v = slew(last.v, one.command.v, LIMITS.v_accel, LIMITS.v_brake, PERIOD)
            omega = slew(
                last.omega, one.command.omega, LIMITS.omega_accel, LIMITS.omega_brake, PERIOD
            )
            assert one.command == pytest.approx((v, omega), abs=1e-6)
            assert 0.0 <= one.command.v <= LIMITS.v_max
            assert abs(one.command.omega) <= LIMITS.omega_max
            last = one.command


def test_a_wall_ahead_stops_the_robot_before_it(grid):
    drive = GuardedDrive(grid=grid)
    found = drive.drive(Twist(1.0, 0.0), 12.0)
    world = drive.world
    assert world.contact == ""
    assert 0.0 < world.clearance < 0.15
    assert found[-1] == Guarded(Twist(0.0, 0.0), True, "no certified stop")
    assert max(one.command.v for one in found) == 1.0


def test_the_arc_is_kept_and_driven_slower():
    drive = GuardedDrive(true=room(8.0, 6.0, BOX))
    found = drive.drive(Twist(1.0, 0.25), 6.0)
    cut = [
        one.command for one in found if one.reason == "no certified stop" and one.command.v > 0.1
    ]
    assert len(cut) > 3
    assert min(command.v for command in cut) < 0.6
    for command in cut:
        assert command.omega == pytest.approx(0.25 * command.v, rel=0.25)


def test_a_turn_on_the_spot_is_left_where_the_arc_is_blocked():
    drive = GuardedDrive()
    drive.drive(Twist(1.0, 0.0), 12.0)
    theta = drive.world.pose.theta
    found = drive.drive(Twist(0.6, 0.5), 2.0)
    assert any(one.command.v == 0.0 and one.command.omega > 0.2 for one in found)
    assert drive.world.pose.theta > theta + 0.3
    assert drive.world.contact == ""


@pytest.mark.parametrize("period", [0.1, 0.02])
@pytest.mark.parametrize("seed", range(3))
def test_noise_does_not_make_it_start_and_stop_at_a_wall(period, seed):
    noise = Noise(0.02, 0.02, 0.01)
    drive = GuardedDrive(
        scenario={"noise": noise, "seed": seed},
        period=period, range_error=0.02, pose_error=0.02, heading_error=0.01,
    )  # fmt: skip
    found = drive.drive(Twist(1.0, 0.0), 15.0)
    speeds = np.array([one.command.v for one in found])
    changes = np.sign(np.diff(speeds))
    assert np.count_nonzero(np.diff(changes[changes != 0.0])) <= 2
    assert (speeds[-round(3.0 / period) :] == 0.0).all()
    assert drive.world.contact == ""


@pytest.mark.parametrize("period", [0.1, 0.02])
def test_it_turns_away_from_a_wall_and_drives_on_in_one_go(period):
    drive = GuardedDrive(period=period)
    drive.drive(Twist(1.0, 0.0), 12.0)
    found = drive.drive(Twist(1.0, 0.5), 6.0)
    changes = np.sign(np.diff([one.command.v for one in found]))
    assert np.count_nonzero(np.diff(changes[changes != 0.0])) <= 2
    assert drive.world.twist.v > 0.5


def test_from_a_wall_it_starts_again_when_asked_for_a_way_that_is_free():
    drive = GuardedDrive(robot=ROBOTS["pioneer3dx"])
    drive.drive(Twist(0.5, 0.0), 20.0)
    at = drive.world.pose.x
    found = drive.drive(Twist(-0.2, 0.0), STEADY + 1.0)
    assert drive.world.pose.x < at - 0.15
    assert found[-1].command.v == -0.2


def test_without_reverse_a_command_backward_is_a_stop():
    drive = GuardedDrive(robot=ROBOTS["pioneer3dx"], reverse=False)
    found = drive.drive(Twist(-0.2, 0.4), 1.0)
    assert found[-1] == Guarded(Twist(0.0, 0.4), True, "speed limit")


def test_more_than_the_robot_can_is_the_same_arc_at_its_limits():
    drive = GuardedDrive(true=room(20.0, 20.0), start=(10.0, 4.0, 0.0))
    found = drive.drive(Twist(4.0, 2.0), 2.0)
    assert found[-1].command == pytest.approx((1.0, 0.5))
    assert found[-1].reason == "speed limit"


@pytest.mark.parametrize(
    "command",
    [
        None, Twist(math.nan, 0.0), Twist(0.3, math.inf), "ahead", (1.0,), 3, Twist(None, 0.0),
    ],
)  # fmt: skip
def test_what_is_no_command_brakes(command):
    drive = GuardedDrive()
    drive.drive(Twist(0.6, 0.0), 1.5)
    for _ in range(12):
        given = drive.tick(command)
        assert given.changed
        assert "command" in given.reason
    assert given.command == Twist(0.0, 0.0)
    assert drive.tick(Twist(0.3, 0.0)).command.v > 0.0


def test_bad_data_brake_and_say_why_and_good_data_go_on():
    drive = GuardedDrive(scan_age=0.3)
    drive.drive(Twist(0.6, 0.0), 1.5)
    found = [drive.tick(Twist(0.6, 0.0), scan=None) for _ in range(15)]
    assert found[0] == Guarded(Twist(0.6, 0.0), False)
    assert found[-1].command == Twist(0.0, 0.0)
    assert "no scan for" in found[-1].reason
    assert not drive.drive(Twist(0.6, 0.0), 2.0)[-1].changed
    scan = drive.world.scan()
    nothing = with_ranges(scan, np.full(len(scan.ranges), np.nan))
    found = [drive.tick(Twist(0.6, 0.0), scan=nothing) for _ in range(15)]
    assert "no valid range" in found[-1].reason


@pytest.mark.parametrize(
    "state",
    [
        RobotState(math.nan, Pose2D(0, 0, 0), Twist(0, 0)),
        RobotState(1.0, Pose2D(0, 0, math.inf), Twist(0, 0)),
        RobotState(1.0, Pose2D(0, 0, 10**400), Twist(0, 0)),
        RobotState(*np.full((1, 1), math.inf), np.ones((3, 1)), np.ones((2, 1))),
    ],
)  # fmt: skip
def test_a_state_that_is_none_brakes(state):
    guard = Guard(ROUND)
    guard.filter(RobotState(0.0, Pose2D(0, 0, 0), Twist(0, 0)), None, Twist(0.3, 0.0))
    given = guard.filter(state, None, Twist(0.3, 0.0))
    assert given.command == Twist(0.0, 0.0)
    assert "not finite" in given.reason
    assert guard.filter(None, None, Twist(0.3, 0.0)).command == Twist(0.0, 0.0)


def test_numbers_that_are_not_finite_brake_though_the_robot_was_there_before():
    drive = GuardedDrive()
    drive.drive(Twist(0.6, 0.0), 1.5)
    state = drive.world.sensed_state()
    for bad in (math.inf, -math.inf, math.nan):
        for at in range(3):
            pose = Pose2D(*(bad if k == at else value for k, value in enumerate(state.pose)))
            given = drive.guard.filter(state._replace(pose=pose), None, Twist(0.6, 0.0))
            assert "not finite" in given.reason
    assert drive.guard.hints == []


@pytest.mark.parametrize("shift", [-1000.0, -1e18])
def test_a_clock_that_begins_anew_is_followed_after_a_second(shift):
    """A simulation that is reset, or one stamp that was far ahead."""
    drive = GuardedDrive(latency=0.1)
    drive.drive(Twist(0.6, 0.0), 1.5)
    if shift == -1e18:
        state = drive.world.sensed_state()
        drive.guard.filter(state._replace(stamp=1e18), None, Twist(0.6, 0.0))
        shift = 0.0
    speeds = []
    for _ in range(40):
        state, scan = drive.world.sensed_state(), drive.world.scan()
        moved = replace(scan, stamp=scan.stamp + shift)
        state = state._replace(stamp=state.stamp + shift)
        given = drive.guard.filter(state, moved, Twist(0.6, 0.1))
        speeds.append(given.command.v)
        drive.world.step(given.command, PERIOD)
    assert min(speeds) == 0.0
    assert not given.changed
    assert len(drive.guard._commands._sent) < 5
    assert drive.world.contact == ""


def test_keep_out_zones_of_the_map_are_not_entered():
    grid = OccupancyGrid(np.zeros((60, 80), np.int8), GridFrame(CELL))
    zone = np.zeros((60, 80), np.int8)
    zone[:, 40:] = 100
    drive = GuardedDrive(grid=with_keepout(grid, OccupancyGrid(zone, GridFrame(CELL))))
    drive.drive(Twist(1.0, 0.0), 12.0)
    assert 3.2 < drive.world.pose.x + ROUND.footprint.circumscribed < 4.0


def test_speed_limits_of_the_map_count_before_they_begin():
    grid = OccupancyGrid(np.zeros((60, 80), np.int8), GridFrame(CELL))
    zone = np.zeros((60, 80), np.int8)
    zone[:, 40:] = 70
    limited = with_speed_limits(grid, OccupancyGrid(zone, GridFrame(CELL)), LIMITS.v_max)
    drive = GuardedDrive(grid=limited)
    while drive.world.pose.x < 6.0:
        given = drive.tick(Twist(1.0, 0.0))
        assert drive.world.pose.x < 4.0 or drive.world.twist.v <= 0.3 + 0.02
    assert given == Guarded(pytest.approx((0.3, 0.0)), True, "speed limit")


def test_another_map_keeps_what_was_seen_and_its_zones_count():
    grid = OccupancyGrid(np.zeros((60, 80), np.int8), GridFrame(CELL))
    zone = np.zeros((60, 80), np.int8)
    zone[:, 40:] = 100
    drive = GuardedDrive()
    drive.drive(Twist(1.0, 0.0), 1.0)
    for found in (with_keepout(grid, OccupancyGrid(zone, GridFrame(CELL))), None):
        drive.guard.set_map(found)
        assert drive.tick(Twist(1.0, 0.0)).command.v > 0.0
        drive.drive(Twist(1.0, 0.0), 8.0)
        assert (drive.world.pose.x < 4.0) == (found is not None)
    drive.guard.set_map(OccupancyGrid(np.zeros((60, 80), np.int8), GridFrame(CELL, yaw=0.3)))
    assert drive.world.contact == ""
    assert drive.drive(Twist(0.0, 0.4), 1.0)[-1].command.omega > 0.3


def test_a_turned_map_changes_nothing():
    straight, turned = GuardedDrive(), None
    yaw = 0.7
    grid = OccupancyGrid(room().values, GridFrame(CELL, 0.0, 0.0, yaw))
    turned = GuardedDrive(true=grid, grid=grid, start=(*_turned(START[:2], yaw), yaw))
    for drive in (straight, turned):
        drive.drive(Twist(1.0, 0.1), 8.0)
        assert drive.world.contact == ""
    expected = _turned(straight.world.pose[:2], yaw)
    assert math.dist(turned.world.pose[:2], expected) < 0.1
    assert np.hypot(*(turned.guard.stop[0, :2] - expected)) < 0.1


def _turned(point, yaw):
    x, y = point
    return math.cos(yaw) * x - math.sin(yaw) * y, math.sin(yaw) * x + math.cos(yaw) * y


def test_moving_obstacles_that_come_stop_it():
    drive = GuardedDrive(true=room(20.0, 6.0))
    drive.drive(Twist(1.0, 0.0), 1.5)
    walker = MovingObstacle(drive.world.pose.x + 3.0, 3.0, -1.0, 0.0, 0.3)
    given = drive.tick(Twist(1.0, 0.0), movers=[walker])
    assert given.reason == "moving obstacle"
    assert given.command.v < 1.0
    assert "moving obstacles are" in drive.tick(Twist(1.0, 0.0), movers=[3]).reason


def test_the_stop_ends_where_the_robot_comes_to_rest():
    drive = GuardedDrive()
    drive.drive(Twist(0.8, 0.2), 3.0)
    stop = drive.guard.stop
    while drive.world.twist.v > 0.0:
        drive.tick(None)
    assert math.dist(stop[0, :2], stop[-1, :2]) > 0.3
    assert math.dist(drive.world.pose[:2], stop[-1, :2]) < 0.1


def test_it_decides_as_the_navigator_drives():
    """What the navigator commands passes a guard of the same settings unchanged."""
    grid = room(8.0, 6.0, BOX)
    drive, navigator = GuardedDrive(true=grid, grid=grid), Navigator(grid, ROUND)
    navigator.set_goal((6.5, 3.0))
    changed = [drive.tick(_of(navigator, drive.world)).changed for _ in range(120)]
    assert math.dist(drive.world.pose[:2], (6.5, 3.0)) < 0.3
    assert not any(changed)


def _of(navigator, world):
    return navigator.command(world.sensed_state(), world.scan())


def test_a_wrong_part_is_told():
    with pytest.raises(InputError, match="a robot: got int"):
        Guard(3)
    with pytest.raises(InputError, match="a map: got str"):
        Guard(ROUND, grid="map.yaml")
    with pytest.raises(InputError, match="settings: got dict"):
        Guard(ROUND, {})
    guard = Guard("jackal")
    assert guard.robot.name == "jackal"
    with pytest.raises(InputError, match="a map: got str"):
        guard.set_map("map.yaml")


@pytest.mark.parametrize(("v", "omega"), [(0.2, 0.0), (-0.1, 0.0), (0.0, 0.9), (0.2, 0.9)])
def test_a_drive_that_needs_more_than_is_asked_for_stands(v, omega):
    limits = LIMITS._replace(v_max=0.3, v_min=-0.2, v_least=0.3, omega_max=1.5, omega_least=1.5)
    drive = GuardedDrive(robot=replace(ROUND, limits=limits))
    for given in drive.drive(Twist(v, omega), 1.0):
        assert given.command == (0.0, 0.0)
        assert given.reason == "slower than the drive can"


def test_the_stop_is_drawn_from_where_the_robot_is_also_while_it_brakes():
    drive = GuardedDrive()
    assert drive.guard.stop.shape == (0, 3)
    drive.drive(Twist(0.5, 0.0), 2.0)
    drive.drive(None, 1.0)
    assert drive.guard.stop == pytest.approx(np.tile(drive.world.pose, (STOP_POSES, 1)), abs=0.05)


def test_states_of_a_clock_that_stands_are_not_kept():
    drive = GuardedDrive(latency=0.1)
    state, scan = drive.world.sensed_state(), drive.world.scan()
    for _ in range(50):
        drive.guard.filter(state, scan, Twist(0.2, 0.0))
    assert len(drive.guard.sensing.poses._states) == 1
    assert len(drive.guard._commands._sent) <= 2


def test_a_guard_and_its_result_say_what_they_are():
    drive = GuardedDrive(grid=room())
    drive.drive(Twist(1.0, 0.0), 12.0)
    said = repr(drive.guard)
    assert all(word in said for word in ("round", "no certified stop", "cells")), said
    assert len(said) <= 400
    assert "no map" in repr(Guard(ROUND))
    assert len(repr(Guarded(Twist(0.0, 0.0), True, "x" * 1000))) <= 400


ERRORS = Noise(0.03, 0.02, 0.02)


@pytest.mark.parametrize("number", range(24))
def test_no_controller_makes_it_touch_anything_with_all_errors_at_their_bounds(number):
    """Boxes at random, and a controller that turns to the nearest and drives at it, or at random."""
    random = np.random.default_rng(number)
    boxes = [(x, y, x + 0.4, y + 0.6) for x, y in random.uniform((0.3, 0.3), (7.0, 4.9), (10, 2))]
    near = [math.hypot(x + 0.2 - START[0], y + 0.3 - START[1]) for x, y, _, _ in boxes]
    boxes = [box for box, away in zip(boxes, near, strict=True) if away > 0.9]
    robot = list(ROBOTS.values())[number % len(ROBOTS)]
    drive = GuardedDrive(
        true=room(8.0, 6.0, *boxes), robot=robot,
        start=(*START[:2], random.uniform(-3.1, 3.1)),
        scenario={
            "noise": ERRORS, "latency": 0.15, "seed": number,
            "drive": Drivetrain(gain_v=random.choice([0.95, 1.05]), gain_omega=random.choice([0.95, 1.05])),
        },
        latency=0.15, range_error=0.03, pose_error=0.02, heading_error=0.02, drive_error=0.05,
    )  # fmt: skip
    limits = robot.limits
    for _ in range(20):
        wanted = Twist(random.uniform(limits.v_min, limits.v_max), random.uniform(-1.0, 1.0))

        def at_the_nearest(world):
            scan = world.scan()
            bearing = scan.angles[np.nanargmin(scan.readings())]
            return Twist(limits.v_max * max(math.cos(bearing), 0.0), 2.0 * bearing)

        drive.drive(at_the_nearest if number % 2 else wanted, 1.0)
        assert drive.world.contact == "", drive.world


@pytest.mark.parametrize("latency", [0.0, 0.3])
@pytest.mark.parametrize(("gain", "odometry"), [(1.15, 1.0), (1.15, 1.0 / 1.15), (0.85, 1.0)])
@pytest.mark.parametrize("brake", [0.3, 1.0])
def test_a_drive_that_is_as_fast_as_declared_stops_with_the_brakes_declared(
    brake, gain, odometry, latency
):
    """Its brakes are no stronger than those of an exact drive, and nothing else is off."""
    limits = Limits(1.5, 1.0, brake, 2.0, brake, 2.0)
    robot = Robot("fast", limits, Footprint.disc(0.3), Lidar(720, math.tau, 0.0, 10.0))
    drive = GuardedDrive(
        true=room(9.0, 6.0), robot=robot, start=(1.0, 3.0, 0.0),
        scenario={
            "latency": latency, "drive": Drivetrain(gain_v=gain, gain_omega=gain),
            "odometry": Odometry(odometry, odometry),
        },
        latency=latency, drive_error=0.15, range_error=0.0, pose_error=0.0, heading_error=0.0,
    )  # fmt: skip
    found = drive.drive(Twist(1.5, 0.0), 16.0)
    assert found[-1].command == Twist(0.0, 0.0)
    assert drive.world.contact == ""
    assert drive.world.clearance < 0.3

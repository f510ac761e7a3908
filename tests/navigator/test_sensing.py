"""States and scans that are not what they should be, and what the navigator makes of them."""

import math

import numpy as np
import pytest

from driving import PERIOD, REST, Drive, room, under_way, with_ranges
from dynastar.geometry import Goal, Pose2D
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator import RobotState
from dynastar.robot import Lidar, arc, stopping_time
from dynastar.simulation.lidar import LidarSimulator

# -- states that are not what they should be -------------------------------------------------------


@pytest.mark.parametrize("bad", [math.nan, math.inf])
@pytest.mark.parametrize("where", ["stamp", "pose", "heading", "twist"])
def test_a_state_that_is_not_finite_brakes_and_says_so(where, bad):
    drive = under_way()
    stamp, pose, twist = drive.state
    state = {
        "stamp": RobotState(bad, pose, twist),
        "pose": RobotState(stamp, pose._replace(y=bad), twist),
        "heading": RobotState(stamp, pose._replace(theta=bad), twist),
        "twist": RobotState(stamp, pose, twist._replace(omega=bad)),
    }[where]
    command = drive.navigator.command(state, drive.scan())
    assert 0.0 <= command.v < drive.twist.v
    assert drive.status.state == "sensor_lost"
    assert "not finite" in drive.status.reason
    drive.tick()
    assert drive.status.state == "following"


def test_time_that_goes_back_brakes_and_goes_on_when_time_does():
    drive = under_way()
    late = RobotState(drive.now - 1.0, drive.pose, drive.twist)
    command = drive.navigator.command(late, drive.scan())
    assert command.v < drive.twist.v
    assert (drive.status.state, drive.status.reason) == ("sensor_lost", "time went back by 0.9 s")
    drive.carry_out(command)
    drive.tick()
    assert drive.status.state == "following"


def test_a_clock_that_was_set_back_is_taken_after_a_while():
    drive = under_way()
    drive.now -= 500.0
    said = [drive.tick() and drive.status.state for _ in range(30)]
    assert said[0] == "sensor_lost"
    assert said[-1] == "following"
    drive.until("arrived")
    assert math.dist(drive.pose[:2], (6.5, 3.0)) < 0.3


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
    for _ in range(18):
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


@pytest.mark.parametrize(("beams", "words"), [(0, "no beams"), (1, "1 beam:")])
def test_a_scan_without_an_angle_between_beams_is_not_used(beams, words):
    drive = under_way()
    for _ in range(30):
        drive.tick(with_ranges(drive.scan(), np.full(beams, 6.0)))
    assert drive.twist == REST
    assert drive.status.state == "sensor_lost"
    assert words in drive.status.reason


@pytest.mark.parametrize(("low", "high"), [(223, 240), (355, 365), (700, 1400)])
def test_a_lidar_whose_number_of_readings_changes_is_used(low, high):
    """Some drivers send what one turn gave, which differs from turn to turn."""
    drive, random = Drive(room()), np.random.default_rng(0)
    drive.navigator.set_goal(Goal(6.5, 3.0))
    states = set()
    while drive.status.state != "arrived":
        assert drive.now < 20.0
        beams = int(random.integers(low, high + 1))
        lidar = LidarSimulator(Lidar(beams, math.tau, 0.0, 6.0), room())
        drive.tick(lidar.scan(drive.pose, drive.now))
        states.add(drive.status.state)
    assert "sensor_lost" not in states


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
    local_map = drive.navigator.sensing.local_map
    x0, y0 = local_map.origin

    def state(x, y):
        a = local_map.resolution
        return local_map.states[int((y - y0) / a), int((x - x0) / a)]

    assert state(drive.pose.x + 0.8, drive.pose.y) == state(drive.pose.x - 1.5, drive.pose.y) == 1


def test_sensor_loss_stops_along_the_arc_in_the_stopping_time_and_goes_on_afterwards():
    drive = under_way(pose=(1.5, 2.0, 0.6), scan_age=0.05)
    while abs(drive.twist.omega) < 0.05 or drive.twist.v < 0.3:
        drive.tick()
    drive.tick()
    begin, twist, limits = drive.pose, drive.twist, drive.navigator.robot.limits
    expected = arc(begin, twist, 0.5 * stopping_time(twist, limits))
    ticks = 0
    stale = with_ranges(drive.scan(), drive.scan().ranges, stamp=drive.now - 1.0)
    while drive.twist != REST:
        drive.tick(stale)
        assert drive.status.state == "sensor_lost"
        ticks += 1
    assert ticks * PERIOD <= stopping_time(twist, limits) + 1.01 * PERIOD
    assert math.dist(drive.pose[:2], expected[:2]) < 0.02
    assert drive.pose.theta == pytest.approx(expected.theta, abs=0.05)
    drive.until("arrived")


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda scan: [None], "a scan is None"),
        (lambda scan: ["scan"], "a scan is"),
        (lambda scan: [with_ranges(scan, scan.ranges, angle_increment=1e-8)], "increment"),
        (lambda scan: [with_ranges(scan, scan.ranges, angle_increment=0.0)], "fit in a circle"),
        (lambda scan: [with_ranges(scan, scan.ranges, range_min=7.0)], "ranges run from"),
        (lambda scan: [with_ranges(scan, np.full(360, 1e30))], "no valid range"),
    ],
)
def test_what_is_no_scan_brakes_and_says_so(change, words):
    drive = under_way()
    for _ in range(5):
        before = drive.twist.v
        command = drive.tick(*change(drive.scan()))
    assert command.v < before
    assert drive.status.state == "sensor_lost"
    assert words in drive.status.reason
    drive.tick()
    assert drive.status.state != "sensor_lost"


@pytest.mark.parametrize("far", [1e4, 1e18, -1e300])
def test_one_pose_far_off_the_map_ends_nothing(far):
    drive = under_way()
    away = drive.state._replace(pose=Pose2D(far, 3.0, 0.0))
    command = drive.navigator.command(away, drive.scan())
    assert 0.0 <= command.v <= drive.twist.v + 1e-9
    drive.carry_out(command)
    assert "arrived" in drive.until("arrived")


@pytest.mark.parametrize(("corner", "same"), [(-0.3, True), (-0.32, False)])
def test_another_map_keeps_what_was_seen(corner, same):
    """The map has grown by three cells on two sides; the second lies on other cells."""
    drive = Drive(room(), true=room(8.0, 6.0, (4.0, 4.0, 4.5, 4.5)), pose=(4.0, 3.0, 0.0))
    drive.tick()
    before = drive.navigator.sensing.local_map
    larger = np.pad(room().values, ((3, 0), (3, 0)), constant_values=100)
    drive.navigator.set_map(OccupancyGrid(larger, GridFrame(0.1, corner, corner)))
    after, planning_map = drive.navigator.sensing.local_map, drive.navigator.planning_map
    assert (after is before) == same
    for kept, stamps in ((after.free_at, before.free_at), (after.hit_at, before.hit_at)):
        assert (kept >= 0.0).sum() == pytest.approx((stamps >= 0.0).sum(), rel=0.1)
    after.update(0.1, np.zeros(after.states.shape, bool))
    assert planning_map.merge(after) is not None
    cells = np.column_stack(np.nonzero(planning_map.seen))
    at = planning_map.frame.points_to_world(cells + 0.5)
    assert (np.abs(at - (4.25, 4.0)).max(axis=1) < 0.35).sum() >= 8  # the side in sight


def test_a_map_of_other_cells_has_a_local_map_on_them():
    drive = Drive(room(), pose=(4.0, 3.0, 0.0))
    drive.navigator.set_goal(Goal(6.5, 3.0))
    drive.for_seconds(0.5)
    margin, values = drive.navigator.driving.margin, room().refined(5).values
    drive.navigator.set_map(OccupancyGrid(values[::2, ::2], GridFrame(0.04)))
    assert drive.navigator.sensing.local_map.resolution == pytest.approx(0.04)
    assert drive.navigator.driving.margin == margin
    drive.until("arrived")

"""A guard fed with messages: commands in and out, and what is late, wrong or missing brakes it."""

import math
from itertools import pairwise

import numpy as np
import pytest

from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import configured
from dynastar.robot import ROBOTS
from dynastar.ros.bag import make
from dynastar.ros.guard_bridge import GuardBridge
from dynastar.ros.outgoing import Messages
from dynastar.ros.settings import GuardSettings, NodeSettings

OUT = Messages(make)
START = Pose2D(1.0, 2.5, 0.0)
PERIOD = 0.02
AHEAD = Twist(0.2, 0.0)


def a_scan(time, reading=math.inf, frame="laser"):
    noise = np.random.default_rng(round(1e3 * time)).uniform(-0.005, 0.005, 360)
    ranges = (reading + noise).astype(np.float32)
    angles = {"angle_min": 0.0, "angle_increment": math.tau / 360}
    limits = {"range_min": 0.12, "range_max": 3.5, "ranges": ranges}
    return make("sensor_msgs/msg/LaserScan", header=OUT.header(frame, time), **angles, **limits)


class Loop:
    """A bridge and messages for it; the robot moves as told."""

    def __init__(self, **own):
        self.bridge = GuardBridge(
            NodeSettings(),
            ROBOTS["turtlebot3_burger"],
            configured("default", {"period": PERIOD}),
            GuardSettings(**own),
        )
        self.now, self.x, self.twist = 5.0, START.x, Twist(0.0, 0.0)

    def tick(self, command=AHEAD, data=True, reading=math.inf):
        bridge, now = self.bridge, self.now
        if command is not None:
            bridge.ask(OUT.twist(command), now)
        if data:
            pose = Pose2D(self.x, START.y, 0.0)
            frames = ("odom", "base_link")
            assert bridge.take("odom", OUT.odometry(pose, self.twist, frames, now)) == ""
            assert bridge.take("scan", a_scan(now, reading)) == ""
        tick = bridge.tick(now)
        self.twist = tick.guarded.command
        self.x, self.now = self.x + PERIOD * self.twist.v, now + PERIOD
        return tick

    def ticks(self, count, **more):
        return [self.tick(**more) for _ in range(count)]


@pytest.fixture
def loop():
    return Loop()


def test_commands_pass_where_the_way_is_free(loop):
    tick = loop.ticks(30)[-1]
    assert tick.guarded.command == AHEAD
    assert (tick.state, tick.reason) == ("passing", "the command")
    stamped = OUT.twist_stamped(Twist(0.1, 0.0), "base_link", loop.now)
    loop.bridge.ask(stamped, loop.now)
    assert loop.ticks(20, command=None)[-1].guarded.command == Twist(0.1, 0.0)


def test_a_command_with_an_old_stamp_is_late_and_one_without_a_stamp_is_not(loop):
    loop.ticks(30)
    late = OUT.twist_stamped(AHEAD, "base_link", loop.now - 1.0)
    loop.bridge.ask(late, loop.now)
    tick = loop.tick(command=None)
    assert (tick.state, tick.reason) == ("idle", "the command is 1.00 s old")
    loop.bridge.ask(OUT.twist_stamped(AHEAD, "base_link", 0.0), loop.now)
    assert loop.tick(command=None).state == "passing"


def test_a_wall_holds_it_back_and_the_reason_is_told(loop):
    loop.ticks(30)
    tick = loop.ticks(50, reading=0.2)[-1]
    assert tick.guarded.command == Twist(0.0, 0.0)
    assert (tick.state, tick.reason) == ("limiting", "no certified stop")


def test_commands_that_stay_away_stop_it(loop):
    assert loop.tick(command=None).reason == "no command has come yet"
    loop.ticks(30)
    found = loop.ticks(60, command=None)
    assert found[20].guarded.command == AHEAD
    assert found[-1].state == "idle"
    assert "the command is" in found[-1].reason
    assert found[-1].guarded.command == Twist(0.0, 0.0)
    stopped = next(k for k, tick in enumerate(found) if tick.guarded.command.v == 0.0)
    assert stopped * PERIOD < loop.bridge.own.command_age + 0.3


@pytest.mark.parametrize("command", [Twist(math.nan, 0.0), Twist(0.2, math.inf)])
def test_commands_that_are_not_finite_stop_it(loop, command):
    loop.ticks(30)
    tick = loop.ticks(15, command=command)[-1]
    assert tick.guarded.command == Twist(0.0, 0.0)
    assert "finite" in tick.reason


def test_data_that_stay_away_stop_it_and_it_goes_on(loop):
    assert loop.tick(data=False).reason == "no odometry has come yet"
    loop.ticks(30)
    found = loop.ticks(40, data=False)
    assert found[-1].state == "sensor_lost"
    assert "odometry is" in found[-1].reason
    assert found[-1].guarded.command == Twist(0.0, 0.0)
    assert loop.ticks(30)[-1].guarded.command == AHEAD
    loop.bridge.request(fault="the clock stands still")
    assert loop.tick().reason == "the clock stands still"
    loop.bridge.request(fault="")
    assert loop.tick().state == "passing"


@pytest.mark.parametrize("frame", ["odom", "map"])
def test_a_scan_in_a_frame_that_the_robot_moves_in_is_refused(loop, frame):
    for parent, child in (("map", "odom"), ("odom", "base_link"), ("base_link", "laser")):
        message = OUT.transforms([(parent, child, Pose2D(0.0, 0.0, 0.0))], loop.now)
        assert loop.bridge.take("/tf", message) == ""
    assert f"the scan is in the frame '{frame}'" in loop.bridge.take(
        "scan", a_scan(loop.now, 1.0, frame)
    )
    assert loop.bridge.take("scan", a_scan(loop.now, 1.0, "laser")) == ""
    assert loop.bridge.take("scan", a_scan(loop.now, 1.0, "not_in_tf")) == ""


def test_scans_of_two_lidars_count_between_two_ticks(loop):
    loop.ticks(30)
    mount = [("base_link", "rear", Pose2D(-0.02, 0.0, 0.0))]
    assert loop.bridge.take("/tf_static", OUT.transforms(mount, 0.0)) == ""
    for _ in range(50):
        assert loop.bridge.take("scan", a_scan(loop.now, 0.2, "rear")) == ""
        tick = loop.tick()
    assert tick.guarded.command.v < AHEAD.v
    assert tick.state == "limiting"


def test_a_map_with_a_mask_counts_if_it_is_asked_for():
    loop = Loop(use_map=True)
    values, mask = np.zeros((100, 100), np.int8), np.zeros((100, 100), np.int8)
    mask[:, 24:] = 100  # from 1.2 m
    for topic, cells in (("map", values), ("keepout_filter_mask", mask)):
        assert loop.bridge.take(topic, OUT.grid(cells, (0.05, 0.0, 0.0), "map", 0.0)) == ""
    loop.ticks(150)
    assert START.x < loop.x < 1.2 - 0.105
    assert loop.bridge.frame == "map"


def test_nothing_passes_before_a_map_that_is_asked_for():
    loop = Loop(use_map=True)
    assert loop.ticks(10)[-1].reason == "no map has come yet"
    assert loop.x == START.x
    values = np.zeros((100, 100), np.int8)
    assert "frame" in loop.bridge.take("map", OUT.grid(values, (0.05, 0.0, 0.0), "odom", 0.0))
    assert "map: the frame" in loop.ticks(2)[-1].reason or "frame" in loop.ticks(2)[-1].reason
    assert loop.x == START.x
    assert loop.bridge.take("map", OUT.grid(values, (0.05, 0.0, 0.0), "map", 0.0)) == ""
    loop.ticks(30)
    assert loop.x > START.x


def test_a_mask_that_is_refused_stops_it_until_a_good_one_comes():
    loop = Loop(use_map=True)
    values = np.zeros((100, 100), np.int8)
    loop.bridge.take("map", OUT.grid(values, (0.05, 0.0, 0.0), "map", 0.0))
    loop.bridge.take("keepout_filter_mask", OUT.grid(values, (0.05, 0.0, 0.0), "odom", 0.0))
    assert loop.ticks(10)[-1].reason.startswith("keepout_filter_mask: ")
    assert loop.x == START.x
    loop.bridge.take("keepout_filter_mask", OUT.grid(values, (0.05, 0.0, 0.0), "map", 0.0))
    loop.ticks(30)
    assert loop.x > START.x


def test_one_scan_far_ahead_does_not_hide_that_no_other_comes(loop):
    loop.ticks(20)
    loop.bridge.take("scan", a_scan(loop.now + 0.45))
    reasons = [loop.tick(data=False).reason for _ in range(25)]
    assert all(reasons[-10:])
    assert loop.twist == Twist(0.0, 0.0)


def test_a_mask_that_was_refused_is_so_after_the_clock_went_back():
    loop = Loop(use_map=True)
    values = np.zeros((100, 100), np.int8)
    loop.bridge.take("map", OUT.grid(values, (0.05, 0.0, 0.0), "map", 0.0))
    loop.bridge.take("keepout_filter_mask", OUT.grid(values, (0.05, 0.0, 0.0), "odom", 0.0))
    loop.now = 1.0
    loop.bridge.request(restart="the clock went back")
    assert loop.ticks(10)[-1].reason.startswith("keepout_filter_mask: ")


def test_a_lidar_whose_clock_is_a_little_ahead_does_not_turn_time_back(loop):
    for k in range(60):
        if k % 2:
            loop.bridge.take("scan", a_scan(loop.now + 0.05, frame="front"))
        tick = loop.tick(data=k % 2 == 0)
        assert "time went back" not in tick.reason


def test_a_clock_that_went_back_starts_it_anew(loop):
    loop.ticks(30)
    loop.now = 1.0
    assert loop.bridge.jumped(2.0) is False
    assert loop.bridge.jumped(1.0)
    loop.bridge.request(restart="the clock went back")
    brake = PERIOD * ROBOTS["turtlebot3_burger"].limits.v_brake
    speeds = [AHEAD.v, *(loop.tick(command=None, data=False).guarded.command.v for _ in range(20))]
    assert speeds[-1] == 0.0
    assert all(before - brake - 1e-9 <= after <= before for before, after in pairwise(speeds))
    assert loop.ticks(80)[-1].guarded.command == AHEAD
    assert loop.bridge.frame == "odom"

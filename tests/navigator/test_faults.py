"""Data, drive and map at fault while the navigator drives: it stops in time, and goes on."""

import math

import numpy as np
import pytest
from numba.core import event

from driving import under_way, with_ranges
from dynastar.bench.missions import Options
from dynastar.bench.suites import faults
from dynastar.errors import InputError
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import RobotState
from dynastar.navigator.braking import Commands
from dynastar.scan import LaserScan
from dynastar.simulation import drive

# Each fault with one of the two robots in turn; ``dynastar bench faults`` has all.
HALF_WAY = [m for m in faults.missions(Options()) if m.spec.fraction == 0.4]
MISSIONS = [m for n, m in enumerate(HALF_WAY) if n % 2 == n // 2 % 2]


@pytest.mark.parametrize("mission", MISSIONS, ids=lambda m: f"{m.spec.case.name}-{m.spec.robot}")
def test_every_fault_is_survived_as_it_should_be(mission):
    scenario = faults.scenario(mission, Options(), 0)
    row = faults.judged(drive(scenario), mission.spec.case, scenario.latency)
    assert row["right"], row


@pytest.mark.parametrize("reading", [1.05, 0.5, math.nan, math.inf])
def test_a_stop_ends_whatever_the_odometry_reads(reading):
    going = under_way()
    limits, state = going.navigator.robot.limits, going.state
    commands = Commands(limits, 0.1, 0.0)
    command = commands.send(state, Twist(limits.v_max, 0.0))
    for _ in range(math.ceil(limits.v_max / limits.v_brake / 0.1) + 2):
        before, v = command, command.v * reading
        command = commands.brake(state._replace(twist=Twist(v, 0.0)))
        assert command.v <= before.v
    assert command == (0.0, 0.0)


def test_a_speed_that_cannot_be_is_not_answered_by_one():
    going = under_way()
    limits = going.navigator.robot.limits
    for v, omega in [(1e4, 0.0), (-20.0, 0.0), (0.0, 1e6)]:
        command = going.navigator.command(going.state._replace(twist=Twist(v, omega)), going.scan())
        assert limits.v_min <= command.v <= limits.v_max
        assert abs(command.omega) <= limits.omega_max


def test_the_same_ranges_again_are_news_to_a_robot_that_stands():
    going = under_way()
    ranges = np.array(going.scan().ranges)
    for _ in range(20):
        state = going.state._replace(stamp=going.now, twist=Twist(0.0, 0.0))
        going.navigator.command(state, with_ranges(going.scan(), ranges))
        going.now += 0.1
        assert going.status.state != "sensor_lost"


class Compilations(event.Listener):
    """Counts the kernels that numba compiles."""

    def __init__(self):
        self.kernels = []

    def on_start(self, event):
        self.kernels.append(event.data["dispatcher"].py_func.__qualname__)

    def on_end(self, event):
        pass


def test_numbers_of_any_type_compile_nothing():
    going = under_way()
    stamp, pose, _ = going.state
    scan = going.scan()
    compilations = Compilations()
    with event.install_listener("numba:compile", compilations):
        for k, twist in enumerate([Twist(1, 0), Twist(np.float32(0.5), 0), (0, 0), np.zeros(2)]):
            now = int(stamp) + 1 + k
            ints = [np.int64(round(number)) for number in pose]
            given = LaserScan(now, scan.ranges, -3, scan.angle_increment, 0, 6, Pose2D(0, 0, 0))
            going.navigator.command(RobotState(now, Pose2D(*ints), twist), given)
            going.navigator.command(RobotState(now + np.float32(0.25), Pose2D(*ints), twist), given)
    assert going.status.state != "sensor_lost"
    assert compilations.kernels == []


@pytest.mark.parametrize(
    "state",
    [None, 3.0, (1.0, 2.0), "state", RobotState(0.0, None, None), RobotState(0.0, (1, 2), (3, 4))],
)
def test_what_is_not_a_state_brakes_and_says_what_is_expected(state):
    going = under_way()
    command = going.navigator.command(state, going.scan())
    assert 0.0 <= command.v < going.twist.v
    assert going.status.state == "sensor_lost"
    assert "expected a stamp, a pose and a twist" in going.status.reason


@pytest.mark.parametrize("movers", [3, [None], [("a",) * 5], [(1.0, 2.0)]])
def test_what_is_not_a_moving_obstacle_brakes_and_says_what_is_expected(movers):
    going = under_way()
    command = going.navigator.command(going.state, going.scan(), movers)
    assert 0.0 <= command.v < going.twist.v
    assert going.status.state == "sensor_lost"
    assert "expected MovingObstacle" in going.status.reason


def test_a_scan_of_words_is_refused_when_it_is_made():
    with pytest.raises(InputError, match="expected numbers"):
        LaserScan("now", np.ones(9), 0.0, 0.1, 0.0, 1.0)
    with pytest.raises(InputError, match="expected numbers"):
        LaserScan(0.0, ["near", "far"], 0.0, 0.1, 0.0, 1.0)

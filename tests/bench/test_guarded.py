"""Controllers without a look at obstacles, and what makes them safe."""

import math

import numpy as np
import pytest

from driving import ROUND, room
from dynastar.bench.controllers import controller_named, guarded
from dynastar.bench.controllers.monitor import SLOWDOWN, Monitor
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.robot import ROBOTS
from dynastar.scan import LaserScan
from dynastar.simulation import Scenario, drive

WANTED = Twist(0.4, 0.2)
BOX = (4.0, 2.0, 5.0, 4.0)


def ran(controller, known, robot=ROUND):
    scenario = Scenario(
        "guarded", known, robot, (1.5, 3.0, 0.0), (Goal(6.5, 3.0),), time_limit=20.0
    )
    name = f"dynastar.bench.controllers.guarded:{controller}"
    return drive(scenario, navigator=controller_named(name))


@pytest.mark.parametrize("kind", ["Straight", "GuardedStraight", "MonitoredStraight"])
def test_all_arrive_where_nothing_is_in_the_way(kind):
    assert ran(kind, room()).outcome == "arrived"


@pytest.mark.parametrize("kind", ["Straight", "Random", "Adversary"])
def test_alone_they_run_into_things_and_guarded_they_do_not(kind):
    known = room(8.0, 6.0, BOX)
    assert ran(kind, known).outcome == "contact"
    kept = ran(f"Guarded{kind}", known)
    assert kept.outcome in ("timeout", "blocked")
    driven = np.abs(np.diff(kept.trajectory.poses[:, :2], axis=0)).sum()
    assert driven > 0.5
    assert "no certified stop" in set(kept.limits)


def test_random_speeds_are_the_same_for_a_goal_and_within_the_limits():
    def wanted(goal):
        driver = guarded.Random(room(), ROUND, None)
        driver.set_goal([goal])
        states = [guarded.RobotState(0.1 * k, Pose2D(0, 0, 0), WANTED) for k in range(100)]
        return [driver.wanted(state, None) for state in states]

    found = wanted(Goal(1.0, 2.0))
    assert found == wanted(Goal(1.0, 2.0))
    assert found != wanted(Goal(1.5, 2.0))
    assert 3 < len(set(found)) < 40
    assert all(0.0 <= v <= 1.0 and abs(omega) <= 1.5 for v, omega in found)


def scan_with(hits):
    """A scan of 360 beams that hits points (x, y), metres, and nothing else."""
    ranges = np.full(360, np.inf, np.float32)
    for x, y in hits:
        ranges[round(math.degrees(math.atan2(y, x))) % 360] = math.hypot(x, y)
    return LaserScan(0.0, ranges, 0.0, math.tau / 360, 0.05, 5.0)


AHEAD = [(0.2, y) for y in (-0.1, -0.05, 0.0, 0.05)]


@pytest.mark.parametrize(
    ("hits", "share"),
    [
        (AHEAD, 0.0),
        (AHEAD[:3], 1.0),
        ([(0.35, y) for _, y in AHEAD], SLOWDOWN),
        ([(-0.3, y) for _, y in AHEAD], SLOWDOWN),
        ([(0.5, y) for _, y in AHEAD], 1.0),
    ],
)
def test_the_monitor_stops_and_slows_down_for_four_points_in_a_zone(hits, share):
    found = Monitor().filter(scan_with(hits), WANTED).command
    assert found == pytest.approx((share * WANTED.v, share * WANTED.omega))


def test_the_monitor_stops_without_a_scan_and_knows_the_mount():
    assert Monitor().filter(None, WANTED).command == Twist(0.0, 0.0)
    scan = scan_with(AHEAD)
    turned = LaserScan(**{**vars(scan), "mount": Pose2D(0.0, 0.0, math.pi)})
    assert Monitor().filter(turned, WANTED).command == pytest.approx((0.12, 0.06))


def test_the_adversary_drives_at_the_nearest_obstacle():
    driver = guarded.Adversary(room(), ROBOTS["pioneer3dx"], None)
    driver.set_goal([Goal(1.0, 1.0)])
    state = guarded.RobotState(1.0, Pose2D(0, 0, 0), WANTED)
    left = driver.wanted(state, scan_with([(0.0, 1.0), (-3.0, 0.0)]))
    assert left.v == pytest.approx(0.0, abs=1e-6)
    assert left.omega == 1.0
    assert driver.wanted(state, scan_with([(1.0, 0.0)])) == pytest.approx((0.55, 0.0))
    assert driver.wanted(state, scan_with([])) == Twist(0.55, 0.0)

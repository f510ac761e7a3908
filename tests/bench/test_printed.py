"""The paper's controller: its equations against slow oracles, its steps, and missions."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.bench.controllers import controller_named
from dynastar.bench.controllers import printed as p
from dynastar.bench.controllers.costmap import Costmap
from dynastar.bench.controllers.printed import (
    GlobalPath,
    Printed,
    PrintedReplanning,
    Settings,
    Terms,
    Trajectories,
)
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.metrics import measure
from dynastar.navigator import NavigatorConfig, RobotState
from dynastar.path import Path
from dynastar.robot import ROBOTS, arc
from dynastar.scan import LaserScan
from dynastar.simulation import Scenario, drive

ROBOT = ROBOTS["paper"]
LIMITS = ROBOT.limits
RADIUS = ROBOT.footprint.circumscribed
SETTINGS = Settings()
SPEEDS, RATES = st.floats(0.0, 1.5), st.floats(-0.5, 0.5)


def field(occupied=(), cells=30):
    """A map of 1 m cells; ``occupied`` lists (row, column)."""
    mask = np.zeros((cells, cells), bool)
    for row, column in occupied:
        mask[row, column] = True
    return OccupancyGrid.from_occupied(mask)


def curve(pose, v, omega, steps=30, dt=0.1):
    return p.trajectories(pose, np.array([v]), np.array([omega]), dt, steps)


def window(v=0.0, omega=0.0, robot=ROBOT, period=0.1, settings=SETTINGS):
    limits = robot.limits
    return p.sampled(p.possible(limits), p.reachable(v, omega, limits, period), settings)


# -- equations 4 to 7 ------------------------------------------------------------------------------


def test_equation_4_goes_straight_and_turns_then():
    found = curve(Pose2D(1.0, 2.0, math.pi / 2), 2.0, 0.5, steps=2, dt=1.0)
    assert found.x[0] == pytest.approx([1.0, 1.0 - 2.0 * math.sin(0.5)])
    assert found.y[0] == pytest.approx([4.0, 4.0 + 2.0 * math.cos(0.5)])
    assert found.theta[0] == pytest.approx([math.pi / 2 + 0.5, math.pi / 2 + 1.0])


@given(SPEEDS, RATES)
def test_in_small_steps_equation_4_is_the_arc(v, omega):
    start = Pose2D(1.0, 2.0, 0.7)
    found = curve(start, v, omega, steps=2000, dt=5e-4)
    end = [part[0, -1] for part in found]
    assert end == pytest.approx(arc(start, Twist(v, omega), 1.0), abs=1e-3)


def test_the_window_is_what_a_period_reaches_within_the_limits():
    v, omega = window(0.5, 0.1)
    assert sorted(set(v)) == pytest.approx([0.48, 0.49, 0.50, 0.51, 0.52])
    assert np.degrees(sorted(set(omega))) == pytest.approx([5.0, 6.0, 7.0])
    assert len(v) == len(omega) == 15
    v, omega = window(1.5, -0.5)
    assert (v.max(), omega.min()) == (pytest.approx(1.5), pytest.approx(-math.radians(28.0)))
    assert window(0.0)[0].min() == 0.0


@given(SPEEDS, RATES, st.floats(0.01, 1.0))
def test_every_end_of_equation_6_is_the_speed_and_what_its_own_limit_adds(v, omega, dt):
    limits = LIMITS._replace(v_accel=0.2, v_brake=0.3, omega_accel=0.5, omega_brake=0.7)
    ends = v - 0.3 * dt, v + 0.2 * dt, omega - 0.7 * dt, omega + 0.5 * dt
    assert p.reachable(v, omega, limits, dt) == pytest.approx(ends, abs=1e-12)


@pytest.mark.parametrize("name", sorted(ROBOTS))
def test_the_number_of_samples_is_bounded_for_every_robot(name):
    v, omega = window(robot=ROBOTS[name])
    assert 0 < len(v) <= (SETTINGS.v_samples + 1) * (SETTINGS.omega_samples + 1)
    assert (0.0, 0.0) in set(zip(v, omega, strict=True))


def test_a_window_between_two_multiples_has_the_speed_nearest_to_rest():
    assert p.multiples(0.011, 0.019, 0.01, 21) == pytest.approx([0.011])
    assert p.multiples(-0.019, -0.011, 0.01, 21) == pytest.approx([-0.011])


@pytest.mark.parametrize("distance", [0.2, 0.6, 1.2, 5.0])
def test_by_equation_7_no_speed_is_admissible_that_does_not_stop_within_dist(distance):
    v = np.arange(0.01, 1.5, 0.01)
    clearance = distance - v[:, None] * 0.1 * np.arange(1, 100)
    found = p.admissible(v, 0.0 * v, p.time_to_contact(clearance, 0.1), LIMITS)
    bound = math.sqrt(2.0 * distance * LIMITS.v_brake)
    assert not found[v > bound].any()
    assert found[v < math.sqrt(2.0 * max(distance - 0.1 * 1.5, 0.0) * LIMITS.v_brake)].all()


def test_by_equation_7_a_turning_rate_stops_within_the_angle_to_contact():
    v, omega, free = np.zeros(2), np.array([0.3, -0.5]), np.array([0.55, 0.55])
    # |omega| / (2 omega_b) seconds are needed: 0.5 and 0.83.
    assert p.admissible(v, omega, free, LIMITS).tolist() == [True, False]


# -- equations 8 and 9 -----------------------------------------------------------------------------


@given(st.floats(-3.1, 3.1), st.floats(-9.0, 9.0), st.floats(-9.0, 9.0))
def test_heading_is_pi_less_the_angle_to_the_target(theta, x, y):
    end = Trajectories(*(np.array([value]) for value in (1.0, 2.0, theta)))
    off = abs(math.remainder(math.atan2(y - 2.0, x - 1.0) - theta, math.tau))
    assert p.heading(end, np.array([x, y])) == pytest.approx([math.pi - off])


@given(
    st.floats(2.0, 9.0), st.floats(2.0, 9.0), st.floats(-3.1, 3.1), SPEEDS, RATES
)  # fmt: skip
@settings(max_examples=50, deadline=None)
def test_clearance_is_the_distance_from_the_disc_to_the_nearest_obstacle(x, y, theta, v, omega):
    controller = Printed(field([(5, 5), (8, 3)], 12), ROBOT, NavigatorConfig())
    curves = curve(Pose2D(x, y, theta), v, omega)
    found = controller._clearance(curves)[0]
    for x, y, clearance in zip(curves.x[0], curves.y[0], found, strict=True):
        squares = [
            math.hypot(max(c - x, 0.0, x - c - 1.0), max(r - y, 0.0, y - r - 1.0))
            for r, c in ((5, 5), (8, 3))
        ]
        edge = min(x, y, 12.0 - x, 12.0 - y)
        if edge > 0.0:
            assert clearance == pytest.approx(min(*squares, edge) - RADIUS, abs=0.06)


def test_simi_falls_with_the_distance_from_the_path():
    path = np.column_stack([np.arange(0.0, 5.0, 0.1), np.zeros(50)])
    beside = [curve(Pose2D(0.0, y, 0.0), 1.0, 0.0) for y in (0.0, 0.5, 3.0)]
    found = [p.simi(curves, path, 1.0)[0] for curves in beside]
    assert found == pytest.approx([1.0, 0.5, 0.0], abs=1e-2)


def test_equation_9_weights_terms_that_are_normalised_over_the_samples():
    values = Terms(np.array([1.0, 3.0]), np.array([2.0, 0.0]), np.zeros(2), np.array([1.0, 1.0]))
    expected = [0.5 * 0.25 + 0.2 * 1.0 + 0.1 * 0.5, 0.5 * 0.75 + 0.1 * 0.5]
    assert p.evaluated(values, SETTINGS) == pytest.approx(expected)


# -- section V -------------------------------------------------------------------------------------


def test_the_intermediate_target_is_where_the_path_leaves_the_circle():
    path = Path(np.array([[1.0, 1.0], [9.0, 1.0], [9.0, 9.0]]))
    points = p.path_to_target(path, 2.0, Pose2D(3.0, 1.5), 4.5)
    assert points[0] == pytest.approx((3.0, 1.0))
    assert np.hypot(*(points[-1] - (3.0, 1.5))) == pytest.approx(4.5, abs=0.1)
    assert p.path_to_target(path, 15.0, Pose2D(9.0, 8.0), 4.5)[-1] == pytest.approx((9.0, 9.0))


def test_the_path_is_planned_anew_only_where_the_robot_has_left_it():
    route = GlobalPath(Costmap(field(), "blocked"), ROBOT, SETTINGS)
    goal = Goal(20.0, 5.0)
    assert route.update((5.0, 5.0), goal, 0.0)
    assert route.plan.planner == "improved"
    assert not route.update((7.0, 5.9), goal, 10.0)
    assert route.s == pytest.approx(2.0, abs=0.1)
    assert route.update((7.0, 6.2), goal, 20.0)
    assert route.path.at(0.0) == pytest.approx((7.0, 6.2))


@pytest.mark.parametrize("replan_blocked", [False, True])
def test_a_path_blocked_by_something_seen_is_planned_anew_in_that_reading_alone(replan_blocked):
    costmap = Costmap(field(), "blocked")
    route = GlobalPath(costmap, ROBOT, SETTINGS._replace(replan_blocked=replan_blocked))
    goal = Goal(20.0, 5.0)
    route.update((5.0, 5.0), goal, 0.0)
    row, column = (int(at) for at in costmap.grid.frame.to_grid(12.0, 5.0))
    route.mark((row, column, np.ones((1, 1), bool)))
    assert route.update((7.0, 5.0), goal, 10.0) == replan_blocked
    if replan_blocked:
        apart = np.hypot(*(route.path.points - (12.0, 5.0)).T).min()
        assert apart > RADIUS
        assert not route.update((7.0, 5.0), goal, 10.1)


def test_the_target_of_the_second_reading_is_a_metre_ahead(monkeypatch):
    seen = []

    def target(path, s, here, radius):
        seen.append(radius)
        return path.resampled(s, s + radius, 0.1)

    monkeypatch.setattr(p, "path_to_target", target)
    for controller in (Printed, PrintedReplanning):
        drive(mission(time_limit=0.3), navigator=controller)
    assert sorted(set(seen)) == [1.0, 4.5]


def test_the_command_turns_towards_the_target_and_speeds_up():
    for side in (-1.0, 1.0):
        controller = Printed(field(), ROBOT, NavigatorConfig())
        controller.set_goal(Goal(25.0, 15.0 + side * 10.0))
        ranges = np.full(360, np.inf, np.float32)
        scan = LaserScan(0.0, ranges, -math.pi, math.tau / 360, 0.0, 5.0)
        command = controller.command(RobotState(0.0, Pose2D(5.0, 15.0), Twist(0.5, 0.0)), scan)
        assert side * command.omega > 0.0
        assert controller.status.state == "following"


def mission(**more):
    made = Scenario("field", field(), ROBOT, (5.0, 5.0, None), (Goal(20.0, 20.0),))
    return replace(made, **{"goal_tolerance": 0.5, "time_limit": 120.0, **more})


def test_it_arrives_where_nothing_stands_and_keeps_to_the_limits():
    episode = drive(mission(), navigator=controller_named("printed"))
    assert measure(episode).outcome == "arrived"
    assert len(episode.plans) == 1
    v, omega = episode.commands.T
    assert v.min() >= 0.0
    assert np.abs(np.diff(v)).max() <= 0.2 * 0.1 + 1e-9
    assert np.abs(np.diff(omega)).max() <= 0.3 * 0.1 + 1e-9


def test_it_gives_up_without_recovery_before_an_obstacle_of_which_the_map_does_not_know():
    square = np.array([(10.5, 10.5), (14.5, 10.5), (14.5, 14.5), (10.5, 14.5)])
    episode = drive(mission(obstacles=(square,)), navigator=Printed)
    found = measure(episode)
    assert (found.outcome, found.recoveries) == ("blocked", 0)
    assert "no progress" in episode.reason
    second = measure(drive(mission(obstacles=(square,)), navigator=PrintedReplanning))
    assert second.outcome == "arrived"

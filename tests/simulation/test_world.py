import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.errors import InputError, ScenarioError
from dynastar.footprint import Footprint, box
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.robot import ROBOTS, Limits, Robot
from dynastar.simulation.scenario import Mover, Noise, Scenario
from dynastar.simulation.world import SUBSTEP, World

QUICK = Robot("quick", Limits(1.0, 1.0, 50.0, 50.0, 50.0, 50.0, v_min=-0.5), Footprint.disc(0.3))
START = Pose2D(10.0, 10.0, 0.0)


def scenario(robot=ROBOTS["paper"], occupied=None, **more):
    occupied = np.zeros((40, 40), bool) if occupied is None else occupied
    grid = more.pop("grid", OccupancyGrid.from_occupied(occupied, 0.5))
    return Scenario("test", grid, robot, START, (Goal(1.0, 1.0),), **more)


def driven(world, command, seconds):
    for _ in range(round(seconds / 0.1)):
        world.step(Twist(*command), 0.1)
    return world


def test_speeds_ramp_each_on_its_own_to_the_limits():
    world = driven(World(scenario(), START), (9.0, 0.0), 1.0)
    assert world.twist == pytest.approx((0.2, 0.0))
    assert world.pose.x - START.x == pytest.approx(0.5 * 0.2 * 1.0**2)
    driven(world, (9.0, 9.0), 1.0)
    assert world.twist == pytest.approx((0.4, 0.3))
    driven(world, (0.0, 9.0), 1.5)
    assert world.twist == pytest.approx((0.1, 0.5))
    assert world.time == pytest.approx(3.5)


def test_reversing_stops_at_v_min_and_brakes_at_its_own_rate():
    limits = Limits(1.0, 1.0, 0.5, 1.0, 2.0, 1.0, v_min=-0.1)
    world = driven(World(scenario(replace(QUICK, limits=limits)), START), (1.0, 0.0), 1.0)
    assert world.twist.v == pytest.approx(0.5)
    driven(world, (-1.0, 0.0), 0.2)
    assert world.twist.v == pytest.approx(0.1)
    driven(world, (-1.0, 0.0), 1.0)
    assert world.twist.v == pytest.approx(-0.1)


def test_a_steady_twist_drives_a_circle():
    world = driven(World(scenario(QUICK), START), (0.8, 0.5), 0.2)

    def centre():
        x, y, theta = world.pose
        return x - 1.6 * math.sin(theta), y + 1.6 * math.cos(theta)

    before = centre()
    driven(world, (0.8, 0.5), 10.0)
    assert centre() == pytest.approx(before, abs=1e-9)


@pytest.mark.parametrize("latency", [0.0, 0.1, 0.15, 0.35])
def test_a_command_acts_after_the_latency(latency):
    world = World(scenario(latency=latency), START)
    assert world.resting
    world.step(Twist(1.0, 0.0), 0.1)
    assert world.resting is False
    driven(world, (0.0, 0.0), 0.3)
    # 0.1 s of speeding up, then 0.1 s of braking, both at 0.2 m/s2, so 1 mm each
    if latency <= 0.2:
        assert world.pose.x - START.x == pytest.approx(0.002)
        assert world.twist.v == pytest.approx(0.0, abs=1e-12)
    else:
        assert world.twist.v == pytest.approx(0.2 * (0.4 - latency))
    driven(world, (0.0, 0.0), 0.6)
    assert world.pose.x - START.x == pytest.approx(0.002)
    assert world.resting


def test_a_command_that_is_not_finite_is_refused():
    with pytest.raises(InputError, match="expected finite"):
        World(scenario(), START).step(Twist(math.nan, 0.0), 0.1)


@pytest.mark.parametrize("duration", [0.0, -0.1, math.nan, math.inf])
def test_a_step_that_takes_no_time_is_refused(duration):
    with pytest.raises(InputError, match="expected seconds, more than 0"):
        World(scenario(), START).step(Twist(0.1, 0.0), duration)


def test_driving_into_a_wall_is_a_moving_contact_at_the_wall():
    occupied = np.zeros((40, 40), bool)
    occupied[:, 24:] = True
    world = driven(World(scenario(QUICK, occupied), START), (1.0, 0.0), 5.0)
    assert world.contact == "moving"
    assert world.pose.x == pytest.approx(12.0 - 0.3, abs=1.0 * SUBSTEP)
    x, time = world.pose.x, world.time
    driven(world, (1.0, 0.0), 1.0)
    assert (world.pose.x, world.time, world.clearance) == (x, time, 0.0)


def test_a_mover_that_meets_a_standing_robot_is_a_resting_contact():
    mover = Mover(0.3, np.array([0.0, 10.0]), np.array([[15.0, 10.0], [5.0, 10.0]]))
    world = driven(World(scenario(QUICK, movers=(mover,)), START), (0.0, 0.0), 9.0)
    assert world.contact == "resting"
    assert world.time == pytest.approx(5.0 - 0.6, abs=SUBSTEP)


def test_a_mover_that_jumps_onto_the_robot_is_a_contact_and_an_absent_one_is_none():
    points = np.array([[10.0, 10.0], [10.0, 5.0]])
    gone = Mover(0.3, np.array([-5.0, -1.0]), points, "vanish")
    assert driven(World(scenario(movers=(gone,)), START), (0.0, 0.0), 3.0).contact == ""
    jumps = Mover(0.3, np.array([-4.0, 1.0]), points, "loop")
    world = driven(World(scenario(movers=(jumps,)), START), (0.0, 0.0), 3.0)
    assert world.contact == "resting"
    assert world.time == pytest.approx(1.0, abs=SUBSTEP)


def test_a_robot_may_start_in_contact():
    obstacle = np.array([[9.0, 9.0], [11.0, 9.0], [11.0, 11.0], [9.0, 11.0]])
    assert World(scenario(obstacles=(obstacle,)), START).contact == "resting"


def test_the_world_is_the_true_map_and_the_border_holds():
    occupied = np.zeros((40, 40), bool)
    occupied[20, 22] = True
    truth = OccupancyGrid.from_occupied(occupied, 0.5)
    world = driven(World(scenario(QUICK, world=truth), START), (1.0, 0.0), 3.0)
    assert world.contact == "moving"
    world = driven(World(scenario(QUICK), START), (1.0, 0.0), 30.0)
    assert world.contact == "moving"
    assert world.pose.x == pytest.approx(20.0 - 0.3, abs=SUBSTEP)


def test_a_yawed_map_is_touched_where_it_lies():
    occupied = np.zeros((40, 40), bool)
    occupied[20, 30] = True
    grid = OccupancyGrid(occupied, GridFrame(0.5, 3.0, -2.0, 0.7))
    start = Pose2D(*grid.frame.to_world(20.5, 10.5), 0.7)
    world = driven(World(scenario(QUICK, grid=grid), start), (1.0, 0.0), 15.0)
    assert world.contact == "moving"
    travelled = math.dist(world.pose[:2], start[:2])
    assert travelled == pytest.approx(19.5 * 0.5 - 0.3, abs=SUBSTEP)
    assert world.pose.theta == pytest.approx(0.7)


@settings(max_examples=40)
@given(seed=st.integers(0, 10**6))
def test_skipped_checks_miss_no_contact(seed):
    """Driven in ticks, the world ends where it ends with a check after every substep."""
    random = np.random.default_rng(seed)
    occupied = random.random((40, 40)) < 0.03
    occupied[17:24, 17:24] = False
    points = random.uniform(0.0, 20.0, (2, 2))
    mover = Mover(0.3, np.array([0.0, 15.0]), points, "loop")
    shape = box(0.7, 0.4) if seed % 2 else Footprint.disc(0.3)
    where = scenario(replace(QUICK, footprint=shape), occupied, movers=(mover,))
    ticked, fine = World(where, START), World(where, START)
    for _ in range(40):
        command = Twist(random.uniform(-0.5, 1.0), random.uniform(-1.0, 1.0))
        smallest = math.inf
        ticked.step(command, 0.1)
        for _ in range(10):
            fine.step(command, SUBSTEP)
            smallest = min(smallest, fine.clearance)
        assert ticked.contact == fine.contact
        assert ticked.time == pytest.approx(fine.time)
        np.testing.assert_allclose(ticked.pose, fine.pose, atol=1e-9)
        assert smallest - 1e-9 <= ticked.clearance <= max(2 * smallest, smallest + 0.02)
        if ticked.contact:
            break


def test_senses_err_within_their_bounds_and_by_their_seed():
    noise = Noise(0.03, 0.05, 0.02)
    where = scenario(noise=noise)
    world, same, other = (World(where, START, seed) for seed in (1, 1, 2))
    poses = np.array([world.sensed_pose() for _ in range(500)])
    error = np.abs(poses - START)
    assert (error.max(axis=0) <= (0.05 + 1e-12, 0.05 + 1e-12, 0.02 + 1e-12)).all()
    assert (error.max(axis=0) > (0.03, 0.03, 0.01)).all()
    np.testing.assert_array_equal(poses, [same.sensed_pose() for _ in range(500)])
    assert (poses[0] != other.sensed_pose()).all()
    np.testing.assert_array_equal(world.scan().ranges, same.scan().ranges)
    with pytest.raises(ScenarioError, match="seed is -1"):
        World(where, START, -1)


BOX = np.array([[12.0, 9.5], [13.0, 9.5], [13.0, 10.5], [12.0, 10.5]])


def test_a_changed_world_is_one_that_was_made_so():
    walker = Mover(0.3, np.array([0.0, 10.0]), np.array([[11.0, 12.0], [11.0, 8.0]]))
    other = scenario(QUICK, obstacles=(BOX,), movers=(walker,), noise=Noise(0.05))
    made, changed = World(other, START, 3), World(scenario(QUICK, noise=Noise(0.05)), START, 3)
    for world in (made, changed):
        driven(world, (0.3, 0.1), 1.0)
    changed.change(other)
    assert changed.movers == pytest.approx(made.movers)
    assert changed.obstacles == made.obstacles
    assert np.array_equal(changed.scan().ranges, made.scan().ranges)
    while not made.contact:
        for world in (made, changed):
            world.step(Twist(0.3, 0.0), 0.1)
    assert (changed.time, changed.contact) == (made.time, made.contact)
    assert changed.clearance == made.clearance == 0.0


def test_a_change_takes_limits_and_forgets_the_contact():
    world = World(scenario(QUICK, obstacles=(BOX,)), START)
    while not world.contact:
        world.step(Twist(1.0, 0.0), 0.1)
    slow = replace(QUICK, limits=QUICK.limits._replace(v_max=0.2))
    world.change(scenario(slow))
    assert world.contact == ""
    assert world.clearance > 1.0
    driven(world, (1.0, 0.0), 1.0)
    assert world.twist.v == pytest.approx(0.2)


def test_a_change_that_cannot_be_changes_nothing():
    world = World(scenario(QUICK, obstacles=(BOX,)), START)
    knot = BOX[[0, 2, 1, 3]]
    late = Mover(0.3, np.array([1.0, 0.0]), np.zeros((2, 2)))
    for wrong in (scenario(QUICK, obstacles=(knot,)), scenario(QUICK, movers=(late,))):
        before = world.scan().ranges
        with pytest.raises(ScenarioError):
            world.change(wrong)
        assert world.obstacles == (BOX,) or np.array_equal(world.obstacles[0], BOX)
        assert np.array_equal(world.scan().ranges, before)
        assert len(world.movers) == 0


def test_gaps_are_distances_to_what_stands():
    world = World(scenario(QUICK, obstacles=(BOX,)), START)
    points = np.array([[11.0, 10.0], [12.5, 10.0], [-1.0, 5.0], [0.4, 10.0]])
    assert world.gaps(points) == pytest.approx([1.0, 0.0, 0.0, 0.4])


class OneWalker:
    """Walks at 1 m/s towards a robot at ``START``, from 2 m ahead."""

    radii = np.array([0.25])

    def at(self, time):
        return np.array([[START.x + 2.0 - time, START.y]])

    def advance(self, time, pose):
        self.advanced = time


def test_walkers_of_a_callers_own_are_stepped_seen_and_touched():
    walker = OneWalker()
    world = World(scenario(QUICK), START, walkers=walker)
    assert world.movers.tolist() == [[12.0, 10.0]]
    assert np.nanmin(world.scan().ranges) == pytest.approx(1.75, abs=0.02)
    driven(world, (0.0, 0.0), 3.0)
    assert world.contact == "resting"
    assert world.time == pytest.approx(2.0 - 0.25 - 0.3, abs=0.011)
    assert walker.advanced == world.time


def test_a_world_begins_where_its_scenario_does():
    assert World(scenario()).pose == Pose2D(*scenario().start)
    assert World(scenario(), (3.0, 4.0, 0.5)).pose == Pose2D(3.0, 4.0, 0.5)


@pytest.mark.parametrize("start", [(4.0, 5.0, None), Pose2D(4.0, 5.0, None), (4, 5)])
def test_a_start_without_a_heading_faces_the_goal(start):
    where = replace(scenario(), goals=(Goal(4.0, 9.0),))
    world = World(where, start)
    assert world.pose == pytest.approx((4.0, 5.0, math.pi / 2))
    world.place(Pose2D(6.0, 5.0, None))
    assert world.pose == pytest.approx((6.0, 5.0, math.pi - math.atan2(4.0, 2.0)))
    assert World(replace(where, goals=()), start).pose == (4.0, 5.0, 0.0)


@pytest.mark.parametrize(
    ("start", "words"),
    [
        ((math.nan, 1.0, 0.0), "the start is \\(nan, 1.0, 0.0\\): expected finite numbers"),
        ((1.0, 1.0, math.inf), "expected finite numbers"),
        ("here", "the start is 'here': expected \\(x, y\\)"),
        (1.0, "the start is 1.0: expected \\(x, y\\)"),
    ],
)
def test_a_start_that_is_none_is_refused(start, words):
    with pytest.raises(InputError, match=words):
        World(scenario(), start)

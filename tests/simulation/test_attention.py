"""Walkers who notice the robot late: they stop, wait, go round it, and come back to their way."""

import math

import numpy as np
import pytest

from dynastar.footprint import Footprint, box
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.robot import Limits, Robot
from dynastar.simulation.detour import ROUND_GAP, encounter
from dynastar.simulation.movers import gap_to_discs
from dynastar.simulation.run import drive
from dynastar.simulation.scenario import Mover, Scenario
from dynastar.simulation.world import World
from scripted import Still

LIMITS = Limits(1.0, 1.0, 50.0, 50.0, 50.0, 50.0, v_min=-1.0)
QUICK = Robot("quick", LIMITS, Footprint.disc(0.3))
START = Pose2D(5.0, 5.0, 0.0)
RADIUS = 0.25


def walk(speed=1.0, end=1.0, after="stay"):
    """From (8, 5) straight at the robot and on, at ``speed``."""
    return Mover(
        RADIUS, np.array([0.0, (8.0 - end) / speed]), np.array([[8.0, 5.0], [end, 5.0]]), after
    )


def scenario(*movers, robot=QUICK, walls=(), attention="late", **more):
    occupied = np.zeros((100, 100), bool)
    for low, high in walls:
        occupied[round(low * 10) : round(high * 10)] = True
    grid = OccupancyGrid.from_occupied(occupied, 0.1)
    goals = (Goal(9.0, 9.0),)
    return Scenario("late", grid, robot, START, goals, movers=movers, attention=attention, **more)


def trail(world, seconds, command=(0.0, 0.0)):
    """Places (n, m, 2) of the movers after each 0.05 s."""
    places = []
    for _ in range(round(seconds / 0.05)):
        world.step(Twist(*command), 0.05)
        places.append(world.movers)
    return np.array(places)


@pytest.mark.parametrize("robot", [QUICK, Robot("box", LIMITS, box(0.7, 0.4))])
def test_a_walker_stops_waits_goes_round_and_comes_back_later(robot):
    world = World(scenario(walk(), robot=robot), START)
    front = 0.3 if robot is QUICK else 0.35
    places = trail(world, 14.0)[:, 0]
    times = 0.05 * np.arange(1, len(places) + 1)
    stopped = 5.0 + front + RADIUS + 0.15
    arrives = 8.0 - stopped  # s, at 1 m/s
    waiting = (times > arrives) & (times < arrives + 1.95)
    assert np.ptp(places[waiting], axis=0) == pytest.approx((0.0, 0.0))
    assert places[waiting][0] == pytest.approx((stopped, 5.0), abs=0.011)
    gaps = [
        gap_to_discs(START, robot.footprint, place[np.newaxis], world.mover_radii)
        for place in places
    ]
    assert min(gaps) > 0.14
    ring = robot.footprint.circumscribed + RADIUS + ROUND_GAP
    assert np.abs(places[:, 1] - 5.0).max() == pytest.approx(ring, abs=0.01)
    steps = np.hypot(*np.diff(places, axis=0).T)
    assert steps.max() <= 0.05 + 1e-6
    assert places[-1] == pytest.approx((1.0, 5.0))
    back = times[np.flatnonzero(np.abs(places[:, 0] - 2.0) < 0.03)[0]]
    lost = back - 6.0
    assert lost == pytest.approx(2.0 + math.pi * ring - 2.0 * (stopped - 5.0), abs=0.1)
    assert world.contact == ""
    assert (world.late.stops, world.late.bumps) == (1, 0)


def test_without_attention_the_same_walker_walks_into_the_robot():
    world = World(scenario(walk(), attention="none"), START)
    trail(world, 5.0)
    assert world.contact == "resting"


def test_a_robot_that_drives_into_a_walker_has_a_moving_contact():
    stands = Mover(RADIUS, np.array([0.0]), np.array([[6.0, 5.0]]), "stay")
    world = World(scenario(stands), START)
    trail(world, 2.0, (0.5, 0.0))
    assert world.contact == "moving"
    assert world.late.bumps == 0


def test_nobody_stops_for_a_robot_that_comes_towards_them():
    world = World(scenario(walk()), START)
    trail(world, 3.0, (0.3, 0.0))
    assert world.contact == "moving"
    assert world.late.stops == 0


def test_a_robot_that_backs_off_is_not_touched():
    world = World(scenario(walk(speed=1.4, end=0.5)), START)
    smallest = math.inf
    for _ in range(120):
        trail(world, 0.05, (-0.4, 0.0))
        smallest = min(smallest, world.clearance)
    assert world.contact == ""
    assert 0.12 < smallest < 0.16
    assert world.late.stops >= 1


def test_a_walker_walks_on_once_the_robot_is_half_a_metre_away():
    world = World(scenario(walk()), START)
    stopped = trail(world, 3.0)[-1, 0]
    left = trail(world, 0.6, (-0.5, 0.0))[-1, 0]
    assert left == pytest.approx(stopped)
    assert world.clearance < 0.5
    assert trail(world, 0.4, (-0.5, 0.0))[-1, 0, 0] < stopped[0] - 0.1


@pytest.mark.parametrize("side", [1, -1])
def test_a_walker_goes_round_on_the_side_that_is_free_of_walls(side):
    wall = (5.6, 5.9) if side < 0 else (4.1, 4.4)
    world = World(scenario(walk(), walls=[wall]), START)
    places = trail(world, 12.0)[:, 0]
    away = places[np.argmax(np.abs(places[:, 1] - 5.0)), 1] - 5.0
    assert math.copysign(1.0, away) == side
    assert places[-1] == pytest.approx((1.0, 5.0))


def test_a_walker_waits_between_walls_until_the_robot_leaves():
    world = World(scenario(walk(end=5.0), walls=[(4.1, 4.4), (5.6, 5.9)]), START)
    places = trail(world, 20.0)[:, 0]
    assert np.ptp(places[60:], axis=0) == pytest.approx((0.0, 0.0))
    assert trail(world, 4.0, (-0.5, 0.0))[-1, 0] == pytest.approx((5.0, 5.0))


def test_a_walker_whose_way_ends_at_the_robot_stands_there_or_is_gone():
    ends = [walk(end=5.0, after="stay"), walk(end=5.0, after="vanish")]
    worlds = [World(scenario(mover), START) for mover in ends]
    last = [trail(world, 30.0)[-1, 0] for world in worlds]
    assert last[0] == pytest.approx((5.7, 5.0), abs=0.011)
    assert np.isnan(last[1]).all()
    assert [world.contact for world in worlds] == ["", ""]


def test_a_late_walker_is_there_until_the_end_of_its_own_script():
    world = World(scenario(walk(after="vanish")), START)
    places = trail(world, 14.0)[:, 0]
    there = np.isfinite(places[:, 0])
    assert there[: round(7.5 / 0.05)].all()  # its script ends at 7 s
    assert not there[-1]
    assert places[there][-1] == pytest.approx((1.0, 5.0), abs=0.06)


def test_who_appears_on_a_robot_at_rest_bumps_into_it_and_ends_nothing():
    appears = Mover(RADIUS, np.array([1.0, 4.0]), np.array([[5.4, 5.0], [8.4, 5.0]]), "vanish")
    world = World(scenario(appears), START)
    trail(world, 1.05)
    assert world.clearance == 0.0
    trail(world, 4.0)
    assert (world.contact, world.late.bumps, world.late.stops) == ("", 1, 0)
    world = World(scenario(appears), START)
    trail(world, 1.05)
    trail(world, 1.0, (0.5, 0.0))
    assert world.contact == "moving"


def test_only_the_movers_that_come_near_are_late():
    others = [
        Mover(RADIUS, np.array([0.0, 9.0]), np.array([[1.0, y], [9.0, y]]), "loop")
        for y in (1.0, 8.5)
    ]
    places = trail(World(scenario(walk(), *others), START), 10.0)
    alone = trail(World(scenario(*others, attention="none"), START), 10.0)
    np.testing.assert_array_equal(places[:, 1:], alone)


def test_the_same_world_gives_the_same_walkers_however_it_is_stepped():
    worlds = [World(scenario(walk(1.3), walk(0.7, end=3.0)), START) for _ in range(2)]
    np.testing.assert_array_equal(*(trail(world, 12.0) for world in worlds))
    coarse = World(scenario(walk(1.3), walk(0.7, end=3.0)), START)
    for _ in range(24):
        coarse.step(Twist(0.0, 0.0), 0.5)
    np.testing.assert_allclose(coarse.movers, worlds[0].movers, atol=1e-9)


def test_an_episode_names_the_attention_and_counts_stops_and_bumps():
    episode = drive(scenario(walk(), time_limit=8.0), navigator=Still)
    assert episode.scenario["attention"] == "late"
    assert (episode.outcome, episode.contact) == ("timeout", "")
    assert [event.kind for event in episode.events if event.kind in ("stop", "bump")] == ["stop"]


@pytest.mark.parametrize("footprint", [Footprint.disc(0.3), box(0.7, 0.4)])
def test_an_encounter_is_how_the_gap_changes(footprint):
    random = np.random.default_rng(3)
    for _ in range(200):
        pose = Pose2D(*random.uniform(-1.0, 1.0, 2), random.uniform(-3.0, 3.0))
        twist = Twist(*random.uniform(-1.0, 1.0, 2))
        centre = random.uniform(-3.0, 3.0, 2)
        found = encounter(pose, twist, footprint, centre, 0.2)
        discs = centre[np.newaxis], np.array([0.2])
        if found.gap > -0.2:  # the other knows no depth of a disc's centre inside of the footprint
            assert found.gap == pytest.approx(gap_to_discs(pose, footprint, *discs))
        dt = 1e-6
        moved = Pose2D(
            pose.x + dt * twist.v * math.cos(pose.theta),
            pose.y + dt * twist.v * math.sin(pose.theta),
            pose.theta + dt * twist.omega,
        )
        then = encounter(moved, twist, footprint, centre, 0.2)
        assert found.approach == pytest.approx((found.gap - then.gap) / dt, abs=1e-3)

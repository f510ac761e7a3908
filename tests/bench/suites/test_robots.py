"""The suite robots: missions that can be done, hardware within the ranges, and rows as promised."""

import math

import numpy as np
import pytest
import shapely

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options
from dynastar.bench.suites import robots
from dynastar.bench.suites.robots_hardware import NOTHING, draw_hardware
from dynastar.bench.suites.robots_sold import SOLD, seen_from
from dynastar.bench.suites.robots_worlds import (
    GOAL_TOLERANCE,
    MAPS,
    check,
    checked_map,
    draw_map,
    grown,
)
from dynastar.footprint import Footprint, box
from dynastar.geometry import Pose2D
from dynastar.robot import Lidar
from dynastar.simulation import ControlLoop, Drivetrain, Noise, World
from dynastar.simulation.contact import Solids
from dynastar.simulation.run import effective_config
from dynastar.simulation.start import start_pose
from scripted import Still

SOME = (1, 12, 29, 46, 55)  # five robots on five maps


def made_of(number):
    made = robots.make(0, number)
    assert not isinstance(made, str), made
    return made


def test_there_are_eight_robots_and_twelve_maps_that_stay_the_same():
    assert len(SOLD) == 8
    assert len(set(MAPS)) == 12
    for kind, seed in MAPS:
        grid = draw_map(kind, seed)
        assert grid is draw_map(kind, seed)
        assert grid.occupied[0].all()
        assert not grid.unknown.any()
        assert 0.03 < grid.occupied.mean() < 0.8


@pytest.mark.parametrize(("kind", "seed"), MAPS)
def test_the_checked_map_leaves_nothing_out(kind, seed):
    grid, coarse = draw_map(kind, seed), checked_map(kind, seed)
    row, column = np.nonzero(grid.occupied)
    x, y = (column + 0.5) * grid.resolution, (row + 0.5) * grid.resolution
    cells = np.floor(coarse.frame.points_to_grid(np.column_stack([x, y]))).astype(int)
    assert coarse.occupied[tuple(cells.T)].all()


def test_posts_are_where_the_body_has_them():
    ahead, left = seen_from(Lidar(x=0.1, theta=math.pi / 2), ((0.3, 0.0), (0.1, 0.2)))
    assert ahead[:2] == pytest.approx((-math.pi / 2, 0.2))
    assert left[:2] == pytest.approx((0.0, 0.2))
    for sold in SOLD.values():
        reach = sold.robot.footprint.circumscribed
        mount = sold.robot.lidar.mount
        assert all(post.distance < reach + math.hypot(mount.x, mount.y) for post in sold.posts)


def test_hardware_is_drawn_within_what_its_user_declares():
    random = np.random.default_rng(0)
    for sold in SOLD.values():
        for _ in range(30):
            found = draw_hardware(sold, random)
            told = found.declared
            assert found.latency + found.drive.lag <= told["latency"] < found.latency + 0.16
            assert told["period"] == found.period
            assert found.drive.latency_jitter <= found.latency
            assert found.loop.jitter <= 0.5 * found.period
            assert 0.95 <= found.drive.gain_v <= 1.05
            assert found.lidar.nothing in NOTHING or math.isnan(found.lidar.nothing)
            assert sold.varies or found.lidar.readings is None


@pytest.mark.parametrize("number", SOME)
def test_a_robot_fits_at_its_ends_whichever_way_it_faces(number):
    made = made_of(number)
    solids = Solids(draw_map(*made.place), made.world.obstacles)
    for x, y, _ in (made.world.start, made.world.goal):
        assert solids.gap(Pose2D(x, y, 0.0), Footprint.disc(made.robot.footprint.circumscribed)) > 0


def test_one_goal_of_ten_is_enclosed_and_half_of_the_others_have_a_heading():
    worlds = [made_of(number).world for number in range(8, 104, 4) if number % 8 != 6]
    closed = [world for world in worlds if not world.reachable]
    assert 0 < len(closed) < 6
    assert all(world.goal.heading is None for world in closed)
    headings = [world.goal.heading is not None for world in worlds if world.reachable]
    assert 0.2 < np.mean(headings) < 0.8
    for world in closed:
        boards = shapely.union_all([shapely.Polygon(ring) for ring in world.obstacles[-4:]])
        inside = shapely.Polygon(boards.interiors[0])
        assert inside.contains(shapely.Point((world.goal.x, world.goal.y)))
        assert not inside.contains(shapely.Point((world.start.x, world.start.y)))


def test_a_way_is_checked_in_the_true_world():
    made = made_of(1)
    x, y, _ = made.world.goal
    kind, footprint = checked_map(*made.place), made.robot.footprint
    assert check(kind, made.world, footprint) == ""
    half = 0.6
    corners = np.array([(-half, -half), (half, -half), (half, half), (-half, half)])
    ring = shapely.Polygon(corners).exterior.buffer(0.1)
    walls = np.array(ring.exterior.coords)[:-1] + (x, y)
    shut = made.world._replace(obstacles=(walls,))
    assert check(kind, shut, footprint) == "no way with room for a careful robot"
    assert check(kind, made.world._replace(reachable=False), footprint) != ""


def test_a_footprint_grows_on_all_sides():
    assert grown(Footprint.disc(0.3), 0.1).circumscribed == pytest.approx(0.4)
    assert grown(box(1.0, 0.6), 0.1).inscribed == pytest.approx(0.4)
    assert np.ptp(grown(box(1.0, 0.6), 0.1).vertices, axis=0) == pytest.approx((1.2, 0.8))


def test_the_navigator_is_told_what_a_careful_user_declares():
    hardware = made_of(1).hardware
    scenario = robots.scenario(Mission(1), Options(), 0)
    config = effective_config(scenario)
    assert (scenario.drive, scenario.lidar) == (hardware.drive, hardware.lidar)
    assert (scenario.odometry, scenario.loop) == (hardware.odometry, hardware.loop)
    assert config.latency == hardware.declared["latency"] > scenario.latency
    assert config.period == hardware.period
    assert config.range_error >= hardware.noise.range_bound
    assert config.goal_tolerance == GOAL_TOLERANCE
    assert World(scenario, start_pose(scenario)).contact == ""


def test_ideal_missions_are_the_same_on_perfect_hardware():
    real, ideal = (robots.scenario(Mission(2), Options(ideal=flag), 0) for flag in (False, True))
    assert (ideal.drive, ideal.loop, ideal.noise) == (Drivetrain(), ControlLoop(), Noise())
    assert (ideal.start, ideal.goals, ideal.grid) == (real.start, real.goals, real.grid)


def test_a_row_names_robot_map_and_verdict(monkeypatch):
    monkeypatch.setattr(robots, "EXTRA_TIME", 1.0)
    monkeypatch.setattr(robots, "PATIENCE", 0.0)
    monkeypatch.setattr(driven, "controller_named", lambda name: Still)
    monkeypatch.setattr(driven, "time_bound", lambda scenario: None)
    row = robots.run_mission(Mission(3), Options(controller="given"), 0)
    assert (row["group"], row["map"]) == ("jackal", "corridor 1")
    assert row["outcome"] == "timeout"
    assert row["reachable"] is made_of(3).world.reachable

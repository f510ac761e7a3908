"""dynastar in ir-sim: what is read of a robot, and driving as a behaviour."""

import math

import numpy as np
import pytest
import yaml

from dynastar.errors import InputError

pytest.importorskip("irsim", reason="needs ir-sim: pip install '.[irsim]'")

import irsim

from dynastar.adapters.irsim import Driver, map_of, robot_of, scan_of, state_of

LIDAR = {"name": "lidar2d", "range_min": 0.2, "range_max": 6.0, "angle_range": 6.2831853}


@pytest.fixture
def make(tmp_path):
    """Makes an ir-sim world of 10 m by 8 m with one robot at (2, 4) and obstacles."""

    def made(obstacles=(), robot=None, world=None, lidar=None):
        thing = {
            "kinematics": {"name": "diff"},
            "shape": {"name": "circle", "radius": 0.25},
            "state": [2.0, 4.0, 0.0],
            "goal": [8.0, 4.0, 0.0],
            "goal_threshold": 0.3,
            "vel_min": [-0.3, -1.5],
            "vel_max": [1.0, 1.2],
            "acce": [1.0, 3.0],
            "sensors": [{**LIDAR, "number": 361, **(lidar or {})}],
            **(robot or {}),
        }
        file = tmp_path / "world.yaml"
        around = {"width": 10, "height": 8, "step_time": 0.1, **(world or {})}
        text = {"world": around, "robot": [thing], "obstacle": list(obstacles)}
        file.write_text(yaml.safe_dump(text))
        return irsim.make(str(file), headless=True, log_level="ERROR", seed=0)

    return made


def box(x, y, length=1.0, width=1.0):
    return {
        "shape": {"name": "rectangle", "length": length, "width": width},
        "state": [x, y, 0.0],
    }


def test_a_robot_has_the_limits_the_footprint_and_the_lidar_of_the_world_file(make):
    robot = robot_of(make(lidar={"offset": [0.1, 0.0, 0.0]}).robot)
    limits = robot.limits
    assert (limits.v_max, limits.v_min, limits.omega_max) == (1.0, -0.3, 1.2)
    assert (limits.v_accel, limits.v_brake, limits.omega_accel) == (1.0, 1.0, 3.0)
    assert (robot.footprint.inscribed, robot.footprint.is_disc) == (0.25, True)
    assert (robot.lidar.beams, robot.lidar.range_min, robot.lidar.x) == (360, 0.2, 0.1)
    shape = {"name": "rectangle", "length": 0.6, "width": 0.4}
    boxed = robot_of(make(robot={"shape": shape, "acce": [math.inf, math.inf]}).robot)
    assert (boxed.footprint.inscribed, boxed.footprint.is_disc) == (pytest.approx(0.2), False)
    assert boxed.limits.v_accel == 100.0


def test_a_robot_that_dynastar_cannot_drive_is_refused(make):
    omni = {"kinematics": {"name": "omni"}, "vel_min": [-1, -1], "vel_max": [1, 1]}
    for robot in (omni, {"sensors": []}):
        with pytest.raises(InputError, match="expected kinematics 'diff' and a sensor 'lidar2d'"):
            robot_of(make(robot=robot).robot)


def test_a_scan_tells_hits_from_beams_that_met_nothing(make):
    scan = scan_of(make([box(4.0, 4.0)]).robot, 0.5)
    readings = scan.readings()
    assert (len(readings), scan.full_circle, scan.stamp) == (360, True, 0.5)
    ahead = int(np.argmin(np.abs(scan.angles)))
    assert readings[ahead] == pytest.approx(1.5, abs=1e-4)
    assert np.isinf(readings).sum() > 250
    assert scan.angles[1] - scan.angles[0] == pytest.approx(math.tau / 360)


def test_a_hit_nearer_than_the_lidar_measures_has_no_information(make):
    scan = scan_of(make([box(2.9, 4.0)], lidar={"range_min": 0.5}).robot, 0.0)
    ahead = int(np.argmin(np.abs(scan.angles)))
    assert np.isnan(scan.readings()[ahead])


def test_a_part_of_a_circle_keeps_all_its_beams(make):
    lidar = {"angle_range": math.pi, "number": 181}
    thing = make([box(4.0, 4.0)], lidar=lidar).robot
    scan = scan_of(thing, 0.0)
    assert (len(scan.ranges), scan.full_circle) == (181, False)
    assert scan.readings()[90] == pytest.approx(1.5, abs=1e-4)
    assert robot_of(thing).lidar.fov == pytest.approx(math.pi)


def test_the_map_is_the_worlds_rectangle_where_it_stands(make):
    grid = map_of(make(world={"offset": [-3.0, 1.0]}))
    assert (grid.rows, grid.columns) == (160, 200)
    assert (grid.frame.x, grid.frame.y) == (-3.0, 1.0)
    assert not grid.occupied.any()


def test_a_driver_follows_the_goals_that_ir_sim_gives_its_robot(make):
    env = make([box(5.0, 4.0)])
    driver = Driver(env, env.robot)
    assert driver.navigator.config.period == 0.1
    assert driver.navigator.config.goal_tolerance == 0.3
    for _ in range(150):
        env.step(list(driver.command()))
    assert env.robot.arrive
    assert not env.robot.collision
    assert driver.navigator.status.state == "arrived"
    env.robot.set_goal([2.0, 4.0, 0.0])
    assert driver.command().omega != 0.0
    assert driver.navigator.status.state != "arrived"


def test_a_robot_without_a_goal_stands(make):
    env = make()
    env.robot.set_goal(None)
    driver = Driver(env, env.robot)
    assert driver.command() == (0.0, 0.0)
    assert driver.navigator.status.state == "idle"


def test_a_robot_of_a_world_file_drives_by_the_behaviour(make):
    behavior = {"name": "dynastar", "settings": {"reverse": False}}
    env = make([box(5.0, 4.0)], robot={"behavior": behavior})
    first = drive(env)
    handler = env.robot.obj_behavior._invoke_func
    assert handler.driver.navigator.config.reverse is False
    assert state_of(env.robot, env.time).pose.x > 7.5
    env.reset()
    assert drive(env) == first


def drive(env):
    """Lets the robot arrive; where it was at each step."""
    poses = []
    while env.time < 15.0 and not env.robot.arrive:
        env.step()
        poses.append(tuple(state_of(env.robot, env.time).pose))
    assert env.robot.arrive
    assert not env.robot.collision
    return poses

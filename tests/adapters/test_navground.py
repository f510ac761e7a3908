"""dynastar in navground: what is read of an agent, and driving as a behavior."""

import math

import numpy as np
import pytest

pytest.importorskip("navground", reason="needs navground: pip install '.[navground]'")

from navground.core import Disc, LineSegment, Pose2
from navground.core.kinematics import (
    OmnidirectionalKinematics,
    TwoWheelsDifferentialDriveKinematics,
)
from navground.sim import Agent, World
from navground.sim.state_estimations import LidarStateEstimation
from navground.sim.tasks import DirectionTask, GoToPoseTask, WaypointsTask

from dynastar.adapters.navground import DynastarBehavior, lidar_of, robot_of, scan_of, twist_of
from dynastar.robot import Lidar


def wheels(max_speed=1.4, back=0.3):
    return TwoWheelsDifferentialDriveKinematics(
        max_speed=max_speed, wheel_axis=0.5, max_backward_speed=back
    )


def world_with(task, lidar=None, kinematics=None, pose=(0.0, 0.0, 0.0), **settings):
    """A world with one agent that dynastar drives."""
    behavior = DynastarBehavior(kinematics or wheels(), 0.25)
    behavior.optimal_speed = 1.0
    behavior.settings = settings
    senses = lidar or LidarStateEstimation(range=6.0, resolution=361)
    agent = Agent(0.25, behavior, behavior.kinematics, task, [senses])
    agent.pose = Pose2(pose[:2], pose[2])
    world = World()
    world.add_agent(agent)
    return world, agent


def scan_in(world, agent):
    world.update_dry(0.1)
    return scan_of(agent.behavior.get_environment_state(), 0.5)


def test_the_wheels_bound_speed_and_turning_together():
    _, agent = world_with(None)
    limits = robot_of(agent.behavior, Lidar(), 1.0, 3.0).limits
    assert limits.v_max == pytest.approx(1.0)
    assert limits.v_max + 0.25 * limits.omega_max == pytest.approx(1.4)
    assert (limits.v_min, limits.v_accel, limits.omega_accel) == (pytest.approx(-0.3), 1.0, 3.0)
    _, slow = world_with(None, kinematics=wheels(max_speed=1.0, back=0.0))
    limits = robot_of(slow.behavior, Lidar(), 1.0, 3.0).limits
    assert (limits.v_max, limits.v_min) == (pytest.approx(0.8), 0.0)
    assert limits.omega_max == pytest.approx(0.8)


def test_an_agent_without_wheels_has_the_limits_of_its_kinematics():
    body = OmnidirectionalKinematics(max_speed=1.2, max_angular_speed=2.0)
    _, agent = world_with(None, kinematics=body)
    limits = robot_of(agent.behavior, Lidar(), 1.0, 3.0).limits
    assert (limits.v_max, limits.omega_max, limits.v_min) == (pytest.approx(1.0), 2.0, 0.0)


def test_a_scan_has_hits_where_things_are_and_no_beam_twice():
    world, agent = world_with(None, pose=(1.0, 2.0, math.pi / 2))
    world.add_obstacle(Disc((1.0, 5.0), 0.5))
    scan = scan_in(world, agent)
    readings = scan.readings()
    assert (len(readings), scan.full_circle, scan.stamp) == (360, True, 0.5)
    assert readings[int(np.argmin(np.abs(scan.angles)))] == pytest.approx(2.5, abs=1e-3)
    assert np.isinf(readings).sum() > 300
    lidar = lidar_of(scan)
    assert (lidar.beams, lidar.fov, lidar.range_max) == (360, math.tau, 6.0)


def test_a_part_of_a_circle_keeps_all_its_beams():
    lidar = LidarStateEstimation(range=6.0, start_angle=0.0, field_of_view=1.0, resolution=11)
    world, agent = world_with(None, lidar)
    world.add_wall(LineSegment((2.0, -9.0), (2.0, 9.0)))
    scan = scan_in(world, agent)
    assert (len(scan.ranges), scan.full_circle) == (11, False)
    assert scan.readings() == pytest.approx(2.0 / np.cos(scan.angles), abs=1e-3)
    seen = lidar_of(scan)
    assert (seen.beams, seen.fov) == (11, pytest.approx(1.0))
    assert seen.theta == pytest.approx(0.5)


def test_an_agent_drives_round_an_obstacle_to_its_point_and_the_next():
    world, agent = world_with(WaypointsTask([(5.0, 0.0), (5.0, 3.0)], False, 0.3))
    world.add_obstacle(Disc((2.5, 0.1), 0.5))
    reached = drive(world, agent, [(5.0, 0.0), (5.0, 3.0)], 25.0)
    assert reached == 2
    assert agent.last_collision_time < 0.0
    assert agent.task.done()


def test_a_command_is_found_with_the_state_and_the_scan_of_its_moment():
    world, agent = world_with(WaypointsTask([(3.0, 0.0)], False, 0.3))
    world.add_wall(LineSegment((4.0, -9.0), (4.0, 9.0)))
    behavior, commands = agent.behavior, []
    for _ in range(15):
        world.update(0.1)
        scan = scan_of(behavior.get_environment_state(), 0.0)
        assert behavior.position[0] + np.nanmin(scan.readings()) == pytest.approx(4.0, abs=1e-3)
        assert twist_of(behavior).v == pytest.approx(commands[-1] if commands else 0.0, abs=1e-3)
        commands.append(float(agent.twist.velocity[0]))
    assert commands[-1] > 0.9


def drive(world, agent, points, seconds):
    """How many of the points, in order, the agent comes near."""
    reached = 0
    for _ in range(round(seconds / 0.1)):
        world.update(0.1)
        near = reached < len(points) and math.dist(agent.position, points[reached]) < 0.3
        reached += near
    return reached


def test_a_pose_is_reached_with_its_heading():
    world, agent = world_with(GoToPoseTask((2.0, 1.0), math.pi / 2, 0.3, 0.2))
    drive(world, agent, [], 12.0)
    assert agent.task.done()
    assert math.dist(agent.position, (2.0, 1.0)) < 0.3
    assert agent.orientation == pytest.approx(math.pi / 2, abs=0.2)


def test_an_agent_goes_on_in_a_direction_where_the_world_repeats_itself():
    world, agent = world_with(DirectionTask((1.0, 0.0)), pose=(0.5, 0.0, 0.0))
    world.set_lattice(0, (0.0, 5.0))
    places = []
    for _ in range(170):
        world.update(0.1)
        places.append(agent.position[0])
    assert np.count_nonzero(np.diff(places) < 0.0) == 3
    assert agent.behavior.efficacy > 0.95
    assert agent.behavior.navigator.status.state == "following"
    assert agent.behavior.navigator.status.plan.path.points[-1, 0] > 25.0  # it drove 15 m


def test_an_agent_without_a_target_stands_and_settings_reach_the_navigator():
    world, agent = world_with(None, reverse=False)
    drive(world, agent, [], 0.5)
    assert agent.position == pytest.approx([0.0, 0.0])
    assert agent.behavior.navigator.status.state == "idle"
    assert agent.behavior.navigator.config.reverse is False

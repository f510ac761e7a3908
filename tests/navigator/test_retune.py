"""Other settings of the dynamic window while it drives: what was seen, planned and asked for stays."""

import pytest

from dynastar.dwa.config import DwaConfig, Weights
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.io.examples import example_scenarios
from dynastar.io.scenario_file import load_scenario
from dynastar.navigator import Navigator, NavigatorConfig, RobotState
from dynastar.simulation import World


def drive(world, navigator, ticks):
    for _ in range(ticks):
        state = RobotState(world.time, world.pose, world.twist)
        world.step(Twist(*navigator.command(state, world.scan())), 0.1)


@pytest.fixture
def driving():
    scenario = load_scenario(example_scenarios()["u_trap"])
    world = World(scenario, Pose2D(1.5, 5.0, 0.0))
    navigator = Navigator(scenario.grid, scenario.robot, NavigatorConfig())
    navigator.set_goal((12.5, 5.0))
    drive(world, navigator, 30)
    return world, navigator


def test_the_same_settings_change_nothing_but_the_manoeuvre_that_is_carried_on(driving):
    world, navigator = driving
    seen, plan = navigator.planning_map.seen.copy(), navigator.status.plan_id
    navigator.retune(navigator.config.dwa)
    assert (navigator.planning_map.seen == seen).all()
    drive(world, navigator, 1)
    assert navigator.status.plan_id == plan
    assert isinstance(navigator.planning_map.grid, OccupancyGrid)
    drive(world, navigator, 300)
    assert navigator.status.state == "arrived"
    assert world.contact == ""


def test_other_samples_and_weights_are_used_at_once(driving):
    world, navigator = driving
    navigator.retune(DwaConfig(weights=Weights(vel=0.5, simi=0.2), v_samples=9, omega_samples=15))
    drive(world, navigator, 1)
    choice = navigator.status.choice
    assert len(choice.samples) > 100
    assert choice.terms[:, 3].max() > 0.0
    assert navigator.config.dwa.v_samples == 9
    drive(world, navigator, 300)
    assert navigator.status.state == "arrived"
    assert world.contact == ""

"""Pedestrians who react: they avoid a standing robot, keep clear of walls and follow the seed."""

import subprocess
import sys

import numpy as np
import pytest
import shapely

from dynastar.errors import ScenarioError
from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import OccupancyGrid
from dynastar.robot import ROBOTS
from dynastar.simulation import Mover, Pedestrian, Scenario, World
from dynastar.simulation.contact import Solids
from dynastar.simulation.crowd import Crowd, jupedsim_installed

needs_jupedsim = pytest.mark.skipif(not jupedsim_installed(), reason="needs jupedsim")

CORRIDOR = OccupancyGrid.from_text(
    "########################\n" + "#......................#\n" * 5 + "########################",
    resolution=0.5,
)
STOP = Twist(0.0, 0.0)
START = Pose2D(6.0, 1.75, 0.0)


def walkers(*ys, speed=1.2, radius=0.25):
    ends = [np.array([(10.5, y), (1.5, y)]) for y in ys]
    return tuple(Pedestrian(radius, speed, (1.5, y), w) for y, w in zip(ys, ends, strict=True))


def world(crowd, robot="pioneer3dx", seed=0, **more):
    scenario = Scenario("t", CORRIDOR, ROBOTS[robot], START, (Goal(10.0, 1.75),), **more)
    return World(Scenario(**{**vars(scenario), "crowd": crowd}), START, seed)


@needs_jupedsim
@pytest.mark.parametrize("robot", ["pioneer3dx", "jackal"])
def test_walk_past_a_standing_robot(robot):
    made, passed = world(walkers(1.75, 1.2, 2.3), robot), False
    for _ in range(600):
        made.step(STOP, 0.05)
        assert not made.contact
        assert made.clearance > 0.05
        passed |= made.movers[0, 0] > 8.0
    assert passed


@needs_jupedsim
def test_avoid_a_robot_that_drives_towards_them():
    made = world(walkers(1.75), seed=3)
    for _ in range(120):
        made.step(Twist(-0.2 if made.pose.x > 4.0 else 0.0, 0.0), 0.05)
        assert not made.contact


@needs_jupedsim
def test_the_robot_of_the_model_is_where_the_robot_is():
    made, placed = world(walkers(1.2, 1.75, 2.3)), 0
    for tick in range(200):
        made.step(Twist(0.5, 0.6 if tick // 20 % 2 else -0.6), 0.05)
        crowd = made._crowd
        if crowd._robot is None:
            continue  # taken out, to be put where the robot is
        placed += 1
        x, y = crowd._simulation.agent(crowd._robot).position
        assert np.hypot(x - made.pose.x, y - made.pose.y) < 0.06
    assert placed > 100


@needs_jupedsim
def test_seed_gives_the_same_walk_and_no_jumps():
    def track(seed):
        made, out = world(walkers(1.2, 1.75, 2.3), seed=seed), []
        for _ in range(200):
            made.step(STOP, 0.02)
            out.append(made.movers)
        return np.array(out)

    a, b = track(5), track(5)
    assert (a == b).all()
    assert np.hypot(*np.diff(a, axis=0).transpose(2, 0, 1)).max() <= 1.2 * 0.02 + 1e-3


@needs_jupedsim
def test_keep_clear_of_walls_and_unmapped_boxes():
    box = np.array([(5.0, 0.5), (7.0, 0.5), (7.0, 1.4), (5.0, 1.4)])
    crowd = Crowd(walkers(0.9, 1.75, 2.6), CORRIDOR, [box], Footprint.disc(0.25), 1)
    solids, disc = Solids(CORRIDOR, [box]), Footprint.disc(0.25)
    for tick in range(1200):
        crowd.advance(tick * 0.05, Pose2D(11.2, 1.75))
        for x, y in crowd.at(tick * 0.05):
            assert solids.gap(Pose2D(x, y), disc) > 0.0


@needs_jupedsim
def test_scripted_movers_and_pedestrians_stand_in_one_list():
    mover = Mover(0.4, np.array([0.0]), np.array([[3.0, 2.5]]))
    made = world(walkers(1.2), movers=(mover,))
    assert made.mover_radii == pytest.approx([0.4, 0.25])
    assert made.movers == pytest.approx(np.array([(3.0, 2.5), (1.5, 1.2)]))
    assert made.scan().ranges[360] < 9.0


@needs_jupedsim
@pytest.mark.parametrize(
    ("crowd", "message"),
    [
        (walkers(0.6), "pedestrian 0 has no room at"),
        (walkers(1.75, 0.2), "pedestrian 1 has no room at"),
        (walkers(-3.0), "starts in a wall or off the map"),
        (walkers(1.75, 1.8), "cannot start"),
        (walkers(1.75, speed=0.0), "speed 0.0 m/s: expected more than 0"),
    ],
)
def test_pedestrians_who_cannot_be(crowd, message):
    with pytest.raises(ScenarioError, match=message):
        world(crowd)


def test_without_jupedsim_one_clear_error(monkeypatch):
    monkeypatch.setattr("dynastar.simulation.crowd.jupedsim_installed", lambda: False)
    with pytest.raises(ScenarioError, match="pip install"):
        world(walkers(1.75))


def test_simulation_does_not_import_jupedsim():
    code = "import sys, dynastar.simulation; sys.exit('jupedsim' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], check=False).returncode == 0


def test_walkable_area_leaves_out_walls_and_boxes():
    from dynastar.simulation.crowd import walkable_area

    area = walkable_area(CORRIDOR, [np.array([(5.0, 0.5), (7.0, 0.5), (7.0, 1.5), (5.0, 1.5)])])
    assert area.area == pytest.approx(11.0 * 2.5 - 2.0, abs=0.05)
    assert not area.contains(shapely.Point(6.0, 1.0))

"""Controllers by name, and pure pursuit: decent where it can be, static only, and within limits."""

import math
import sys
from dataclasses import replace
from types import ModuleType

import numpy as np
import pytest

from driving import ROUND, room
from dynastar.bench.controllers import BUILT_IN, controller_named
from dynastar.bench.controllers.costmap import Costmap, covering
from dynastar.bench.controllers.pure_pursuit import PurePursuit
from dynastar.bench.controllers.route import Route
from dynastar.errors import ConfigError, GoalOccupied
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.metrics import measure
from dynastar.navigator import NavigatorConfig, RobotState
from dynastar.perception import MovingObstacle
from dynastar.robot import ROBOTS
from dynastar.scan import LaserScan
from dynastar.simulation import Fault, Mover, Noise, Scenario, drive
from dynastar.simulation.lidar import LidarSimulator

WALL = (3.6, 0.0, 4.0, 4.0)
BOX = np.array([[3.5, 2.5], [4.2, 2.5], [4.2, 3.5], [3.5, 3.5]])
JACKAL = ROBOTS["jackal"]


def mission(robot=ROUND, known=None, goals=(Goal(6.5, 3.0),), **more):
    return Scenario(
        "pursue", room() if known is None else known, robot, (1.5, 3.0, 0.0), goals,
        noise=Noise(0.01), latency=0.05, **{"navigator": {"period": 0.05}, **more},
    )  # fmt: skip


def driven(scenario, controller="pure_pursuit"):
    episode = drive(scenario, navigator=controller_named(controller))
    return episode, measure(episode)


# -- by name ---------------------------------------------------------------------------------------


def test_the_navigator_is_the_default():
    assert controller_named("navigator") is None
    assert controller_named("pure_pursuit") is PurePursuit
    assert set(BUILT_IN) == {"navigator", "pure_pursuit", "printed", "kompass_dwa", "orca"}


def test_a_class_of_ones_own_is_imported(monkeypatch):
    module = ModuleType("my_controllers")
    module.Mine = type("Mine", (), {"set_goal": lambda s, g: None, "command": lambda s, a, b: None})
    module.Half = type("Half", (), {"set_goal": lambda s, g: None})
    monkeypatch.setitem(sys.modules, "my_controllers", module)
    assert controller_named("my_controllers:Mine") is module.Mine
    with pytest.raises(
        ConfigError, match=r"no class 'Mime' in my_controllers \(did you mean 'Mine'"
    ):
        controller_named("my_controllers:Mime")
    with pytest.raises(ConfigError, match="the class has no command"):
        controller_named("my_controllers:Half")


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("pure_persuit", "did you mean 'pure_pursuit'"),
        ("nothing.like.it:Mine", "cannot be imported"),
        ("json:", "MODULE:CLASS"),
        (":Mine", "MODULE:CLASS"),
    ],
)
def test_a_wrong_name_is_explained(name, words):
    with pytest.raises(ConfigError, match=words):
        controller_named(name)


@pytest.mark.parametrize(("name", "extra"), [("kompass_dwa", "kompass"), ("orca", "crowdnav")])
def test_a_controller_says_how_to_install_its_package(monkeypatch, name, extra):
    monkeypatch.setattr("dynastar.bench.controllers.find_spec", lambda module: None)
    with pytest.raises(ConfigError, match=rf"{name} needs .* pip install '\.\[{extra}\]'"):
        controller_named(name)


# -- costmap and route -----------------------------------------------------------------------------


def looked(true, *poses, known=None, robot=ROUND):
    costmap = Costmap(room() if known is None else known, "blocked")
    lidar = LidarSimulator(robot.lidar, true)
    for number, pose in enumerate(poses):
        costmap.see(Pose2D(*pose), lidar.scan(Pose2D(*pose), 0.1 * number))
    return costmap


def blocked(costmap, x, y):
    """Whether the cell at (x, y), or one beside it in x, is blocked."""
    cells = [costmap.grid.world_to_cell(x + dx, y) for dx in (-0.02, 0.02)]
    return any(costmap.blocked[cell] for cell in cells)


def test_what_is_seen_is_marked_and_what_is_passed_is_cleared():
    costmap = looked(room(8.0, 6.0, (3.6, 2.0, 4.0, 4.0)), (1.5, 3.0, 0.0))
    assert blocked(costmap, 3.6, 3.0)
    assert not blocked(costmap, 3.9, 3.0)  # behind the face
    lidar = LidarSimulator(ROUND.lidar, room())
    costmap.see(Pose2D(1.5, 3.0), lidar.scan(Pose2D(1.5, 3.0), 1.0))
    assert not blocked(costmap, 3.6, 3.0)


def test_the_map_is_not_cleared_and_forgetting_leaves_it():
    costmap = looked(room(), (1.5, 3.0, 0.0), known=room(8.0, 6.0, WALL))
    assert blocked(costmap, 3.8, 2.0)
    costmap = looked(room(8.0, 6.0, (3.6, 2.0, 4.0, 4.0)), (1.5, 3.0, 0.0))
    costmap.forget()
    assert not blocked(costmap, 3.6, 3.0)
    assert blocked(costmap, 0.05, 3.0)


def test_nothing_is_cleared_beyond_the_lidars_range():
    robot = replace(ROUND, lidar=ROUND.lidar._replace(range_max=3.5))
    true = room(12.0, 6.0, (5.0, 2.0, 5.4, 4.0))
    known = room(12.0, 6.0)
    costmap = looked(true, (2.0, 3.0, 0.0), (1.0, 3.0, 0.0), known=known, robot=robot)
    assert blocked(costmap, 5.0, 3.0)  # seen from 3 m, out of range from 4 m


def test_readings_mean_for_others_what_they_mean_for_the_navigator():
    """A declared value for no return clears, the robot's own body is no obstacle, nothing is a fault."""
    lidar = ROUND.lidar._replace(nothing=(math.nan,))
    controller = PurePursuit(room(12.0, 6.0), replace(ROUND, lidar=lidar), NavigatorConfig())
    controller.set_goal(Goal(10.0, 3.0))
    ranges, angles = np.full(360, np.nan, np.float32), (-math.pi, math.tau / 360, 0.1, 6.0)
    ranges[:4] = 2.0
    state = RobotState(0.0, Pose2D(3.0, 3.0, 0.0), Twist(0.0, 0.0))
    controller.command(state, LaserScan(0.0, ranges, *angles))
    assert blocked(controller.costmap, 1.0, 2.96)
    ranges[:4], ranges[180] = np.nan, 0.2  # its own body
    controller.command(state._replace(stamp=0.1), LaserScan(0.1, ranges, *angles))
    assert controller.status.state == "following"
    assert not blocked(controller.costmap, 1.0, 2.96)
    assert not blocked(controller.costmap, 3.2, 3.0)


def test_nan_and_blind_ranges_clear_and_mark_nothing():
    costmap = looked(room(8.0, 6.0, (3.6, 2.0, 4.0, 4.0)), (1.5, 3.0, 0.0))
    before = costmap.blocked.copy()
    ranges = np.full(360, np.nan, np.float32)
    ranges[::3] = 0.0
    scan = LaserScan(1.0, ranges, -math.pi, math.tau / 360, 0.1, 6.0)
    costmap.see(Pose2D(1.5, 3.0), scan)
    assert np.array_equal(costmap.blocked, before)


@pytest.mark.parametrize("robot", [ROUND, JACKAL], ids=["disc", "polygon"])
def test_gaps_are_right_to_a_cell(robot):
    costmap = Costmap(room(), "blocked")
    front = robot.footprint.circumscribed if robot.footprint.is_disc else 0.254
    around = costmap.surroundings(Pose2D(7.0, 3.0), 3.0)
    for x in (6.2, 6.5, 7.0, 7.4):
        gap = around.gaps(np.array([[x, 3.0, 0.0]]), covering(robot.footprint))[0]
        assert gap == pytest.approx(7.9 - x - front, abs=0.06)


def test_a_path_keeps_room_where_there_is_some_and_squeezes_where_there_is_none():
    narrow = room(8.0, 6.0, (3.6, 0.0, 4.0, 2.7), (3.6, 3.4, 4.0, 6.0))  # 0.7 m for 0.5 m
    for known, least in ((room(8.0, 6.0, (3.6, 0.0, 4.0, 2.7)), 0.45), (narrow, 0.25)):
        route = Route(Costmap(known, "blocked"), ROUND)
        assert route.update((1.5, 2.0), Goal(6.5, 2.0), 0.0)
        assert route.path.length < 6.0
        assert np.hypot(*(route.path.points - (3.6, 2.7)).T).min() > least


def test_a_blocked_path_is_replaced_and_a_clear_one_kept():
    costmap = Costmap(room(), "blocked")
    route = Route(costmap, ROUND)
    goal = Goal(6.5, 3.0)
    assert route.update((1.5, 3.0), goal, 0.0)
    assert not route.update((1.6, 3.0), goal, 0.1)
    assert not route.update((2.0, 3.0), goal, 5.0)
    lidar = LidarSimulator(ROUND.lidar, room(8.0, 6.0, (3.6, 2.0, 4.0, 4.0)))
    route.mark(costmap.see(Pose2D(2.0, 3.0), lidar.scan(Pose2D(2.0, 3.0), 5.1)))
    assert route.update((2.0, 3.0), goal, 5.4)
    assert route.path.length > 4.7


# -- pure pursuit ----------------------------------------------------------------------------------


def test_it_drives_straight_across_fast():
    episode, found = driven(mission())
    assert (found.outcome, found.turning_points) == ("arrived", 0)
    assert found.time < 9.0
    assert episode.trajectory.twists[:, 0].max() > 0.9
    assert math.dist(episode.trajectory.poses[-1, :2], (6.5, 3.0)) < 0.25


@pytest.mark.parametrize("robot", [ROUND, JACKAL], ids=["disc", "polygon"])
def test_it_goes_round_what_no_map_has(robot):
    episode, found = driven(mission(robot, obstacles=(BOX,)))
    assert found.outcome == "arrived"
    assert found.min_clearance > 0.02
    assert found.length > 5.1
    assert {"curvature", "proximity", "approach to the goal"} <= set(episode.limits)


def test_it_turns_to_a_goals_heading_and_takes_goals_in_order():
    goals = (Goal(5.0, 4.5, math.pi), Goal(2.0, 1.5, -math.pi / 2))
    episode, found = driven(mission(goals=goals))
    assert (found.outcome, found.goals_reached) == ("arrived", 2)
    assert abs(episode.trajectory.poses[-1, 2] + math.pi / 2) < 0.12


def test_it_stops_for_what_steps_in_front_of_it():
    walker = Mover(0.3, np.array([0.0, 2.0, 60.0]), np.array([[4.5, 5.0], [4.5, 3.0], [4.5, 3.0]]))
    closed = room(8.0, 6.0, (4.0, 0.0, 4.2, 2.5), (4.0, 3.5, 4.2, 6.0))
    _, found = driven(mission(known=closed, movers=(walker,), time_limit=15.0))
    assert (found.outcome, found.contacts_moving) == ("timeout", 0)
    assert found.min_clearance > 0.0


def test_its_commands_keep_the_limits():
    episode, _ = driven(mission(JACKAL, obstacles=(BOX,)))
    limits, period = JACKAL.limits, 0.05
    assert (np.abs(episode.commands) <= (limits.v_max, limits.omega_max)).all()
    assert np.abs(np.diff(episode.commands[:, 0])).max() <= limits.v_accel * period + 1e-9


def test_no_plan_is_said():
    with pytest.raises(GoalOccupied):
        driven(mission(known=room(8.0, 6.0, WALL), goals=(Goal(3.8, 2.0),)))
    _, found = driven(mission(known=room(8.0, 6.0, (3.6, 0.0, 4.0, 6.0))))
    assert found.outcome == "blocked"
    assert found.time > 10.0  # it could have been something that moves


@pytest.mark.parametrize("kind", ["scans_lost", "scans_nan", "state_nan", "clock_back"])
def test_it_stops_without_data_and_goes_on(kind):
    fault = Fault(kind, 3.0, 2.0, 3.0 if kind == "clock_back" else 0.0)
    episode, found = driven(mission(faults=(fault,)))
    assert found.outcome == "arrived"
    assert "sensor_lost" in episode.states
    during = (episode.trajectory.times > 4.9) & (episode.trajectory.times < 5.0)
    assert np.abs(episode.trajectory.twists[during]).max() < 1e-6


def test_it_takes_another_map():
    other = room(8.0, 6.0, WALL)
    _, found = driven(mission(faults=(Fault("map_replaced", 1.0, grid=other),)))
    assert found.outcome == "arrived"
    assert found.length > 5.5


def test_a_robot_that_cannot_go_on_gives_up():
    boxed = Scenario(
        "boxed", room(), ROUND, (1.5, 3.0, 0.0), (Goal(6.5, 3.0),),
        world=room(8.0, 6.0, (3.6, 0.0, 4.0, 6.0)), time_limit=200.0, navigator={"period": 0.1},
    )  # fmt: skip
    episode, found = driven(boxed)
    assert (found.outcome, found.contacts_moving) == ("blocked", 0)
    assert found.recoveries > 5
    assert {event.detail for event in episode.events if event.kind == "recovery"} >= {
        "forget what was seen"
    }


def test_a_seed_gives_the_same_drive():
    one, two = (driven(mission(obstacles=(BOX,)))[0] for _ in range(2))
    assert np.array_equal(one.trajectory.poses, two.trajectory.poses)


def test_a_lost_state_is_no_error():
    controller = PurePursuit(room(), ROUND, NavigatorConfig())
    controller.set_goal(Goal(6.5, 3.0))
    nan = math.nan
    command = controller.command(RobotState(nan, Pose2D(nan, nan, nan), Twist(nan, nan)), None)
    assert command == Twist(0.0, 0.0)
    assert controller.status.state == "sensor_lost"


# -- kompass-core ----------------------------------------------------------------------------------


@pytest.mark.parametrize("robot", [replace(ROUND, name="round"), JACKAL], ids=["disc", "polygon"])
def test_kompass_goes_round_what_no_map_has(robot):
    pytest.importorskip("kompass_core", reason="pip install '.[kompass]'")
    episode, found = driven(mission(robot, obstacles=(BOX,)), "kompass_dwa")
    assert found.outcome == "arrived"
    assert found.min_clearance > 0.0
    again, _ = driven(mission(robot, obstacles=(BOX,)), "kompass_dwa")
    assert np.array_equal(episode.trajectory.poses, again.trajectory.poses)


# -- ORCA ------------------------------------------------------------------------------------------


@pytest.mark.parametrize("robot", [ROUND, JACKAL], ids=["disc", "polygon"])
@pytest.mark.parametrize("obstacles", [(), (BOX,)], ids=["empty", "box"])
def test_orca_arrives_in_a_room_with_and_without_a_box(robot, obstacles):
    pytest.importorskip("pyrvo", reason="pip install '.[crowdnav]'")
    _, found = driven(mission(robot, obstacles=obstacles), "orca")
    assert found.outcome == "arrived"
    assert found.min_clearance > 0.03
    assert found.length < 5.7


@pytest.mark.parametrize("x", [3.5, 4.0, 4.5])
def test_orca_passes_a_walker_who_crosses_without_a_stop(x):
    pytest.importorskip("pyrvo", reason="pip install '.[crowdnav]'")
    walker = Mover(0.3, np.array([0.0, 8.0]), np.array([[x, 0.8], [x, 5.2]]))
    episode, found = driven(mission(movers=(walker,)), "orca")
    assert found.outcome == "arrived"
    assert found.contacts_moving == found.contacts_resting == 0
    assert found.time < 7.0  # pure pursuit waits until the walker has gone by
    again, _ = driven(mission(movers=(walker,)), "orca")
    assert np.array_equal(episode.trajectory.poses, again.trajectory.poses)


def test_orca_plans_through_people():
    pytest.importorskip("pyrvo", reason="pip install '.[crowdnav]'")
    walker = Mover(0.3, np.array([0.0, 8.0]), np.array([[6.0, 3.0], [3.0, 3.0]]))
    gap = room(8.0, 6.0, (3.6, 0.0, 4.0, 2.5), (3.6, 3.5, 4.0, 6.0))
    for controller, lost in (("pure_pursuit", True), ("orca", False)):
        episode, _ = driven(mission(known=gap, movers=(walker,), time_limit=6.0), controller)
        assert ("waiting" in episode.states) == lost


def test_orca_avoids_a_walker_where_there_is_no_path():
    pytest.importorskip("pyrvo", reason="pip install '.[crowdnav]'")
    walker = Mover(0.3, np.array([0.0, 6.0]), np.array([[1.5, 5.5], [1.5, 0.5]]))
    closed = room(8.0, 6.0, (3.6, 0.0, 4.0, 6.0))
    episode, found = driven(mission(known=closed, movers=(walker,), time_limit=6.0), "orca")
    assert (found.outcome, found.contacts_moving, found.contacts_resting) == ("timeout", 0, 0)
    assert len(episode.plans) == 0


def test_orca_turns_on_the_spot_where_its_velocity_lies_far_aside():
    pytest.importorskip("pyrvo", reason="pip install '.[crowdnav]'")
    episode, found = driven(mission(goals=(Goal(2.5, 5.0),)), "orca")  # 63 degrees to the left
    assert found.outcome == "arrived"
    turning = episode.trajectory.poses[:, 2] < math.radians(15.0)
    assert np.abs(episode.trajectory.twists[turning, 0]).max() < 1e-6


def test_walls_of_orca_lie_to_the_left_of_their_outlines_and_leave_out_people():
    orca = pytest.importorskip("dynastar.bench.controllers.orca", reason="needs pyrvo")
    known = room(8.0, 6.0, (3.6, 0.0, 4.0, 4.0))
    controller = orca.Orca(known, ROUND, NavigatorConfig())
    row, column = controller.costmap.grid.world_to_cell(2.05, 4.95)
    controller.costmap.blocked[row - 1 : row + 2, column - 1 : column + 2] = True
    person = MovingObstacle(2.05, 4.95, 0.0, 0.0, 0.2)
    at_the_wall = MovingObstacle(3.8, 4.0, 0.0, 0.0, 0.2)
    for people, count in (([], 3), ([person, at_the_wall], 2)):
        blocked, corner = controller._static(Pose2D(2.0, 3.0), 9.0, people)
        outlines = controller._outlines(blocked, corner)
        areas = [shoelace(outline) for outline in outlines]
        assert len(areas) == count
        inside = [area for area in areas if area < 0.0]
        assert inside == pytest.approx([-(7.8 * 5.8 - 0.4 * 3.9)], rel=0.02)  # round the free space


def shoelace(ring):
    x, y = ring.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))

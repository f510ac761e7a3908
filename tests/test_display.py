"""What ``print`` and a notebook show of objects: a few lines that say what a roboticist wants to know."""

import inspect
import math

import numpy as np
import pytest

import dynastar
from dynastar import (
    ROBOTS,
    Episode,
    Footprint,
    Goal,
    GridFrame,
    GridPlanner,
    Guard,
    Guarded,
    LaserScan,
    Lidar,
    Limits,
    MovingObstacle,
    Navigator,
    NavigatorConfig,
    OccupancyGrid,
    Path,
    Plan,
    PlannerConfig,
    Pose2D,
    Robot,
    RobotState,
    Scenario,
    Status,
    Twist,
    World,
)
from dynastar.config import LONGEST_TEXT
from dynastar.dwa.dwa import Choice
from dynastar.dwa.scene import AT_REST
from dynastar.episode import EventRecord, PlanRecord, Trace
from dynastar.metrics import measure
from dynastar.path import Trajectory
from dynastar.perception import PlanningMap, Track
from dynastar.planning import SearchResult
from dynastar.simulation import Fault, Mover, Pedestrian
from episodes import episode

LONG = "x" * 3000
NUMBER = np.float64(math.pi * 1e5)
SMALL_GRID = OccupancyGrid([[0, 100]], 0.5)
LARGE_GRID = OccupancyGrid(
    np.zeros((900, 1200), int),
    GridFrame(0.05, -1e3 / 3, 1e3 / 3, 1 / 3),
    np.ones((900, 1200), bool),
    np.full((900, 1200), 0.5),
)
MANY = np.random.default_rng(0).normal(0.0, 1e3, (20000, 2))
NONE = np.empty((0, 2))


def a_plan(points):
    path = Path(points)
    return Plan(
        "improved", path, path, np.zeros((len(points), 2), np.int32), 1.0, 9, None, 1.5, 0.3, 0.0
    )


def a_scan(ranges):
    return LaserScan(0.5, ranges, -math.pi, math.tau / max(len(ranges), 1), 0.1, 10.0)


def a_scenario(grid, movers=(), name="room"):
    start, goals = (0.25, 0.25, 0.0), (Goal(0.75, 0.25),)
    return Scenario(name, grid, Robot.simple(0.1, 0.5), start, goals, movers=movers)


def driven(points):
    return Trajectory(points[:, 0], points[:, [0, 1, 1]], points)


def a_state(number):
    return RobotState(number, Pose2D(number, number, number), Twist(number, number))


def a_trace(n):
    return Trace(
        MANY[:n], np.ones(n), np.arange(n), MANY[:n], MANY[:n], MANY[:n], np.arange(n),
        np.array(["why"] * n, np.str_), np.zeros((n, 4), np.int32), (0.1, 0.0, 0.0, 0.0),
    )  # fmt: skip


def a_choice(n):
    score = np.full(n, -np.inf)
    command = None if n == 0 else Twist(0.4, 0.1)
    return Choice(command, None, AT_REST, {}, MANY[:n], score, MANY[:n], score, LONG)


def a_config(changed):
    if not changed:
        return NavigatorConfig()
    names = [
        name for name in NavigatorConfig._fields if name in ("latency", "stuck_time", "comfort")
    ]
    return NavigatorConfig(**dict.fromkeys(names, 0.7 + 1e-16), unknown="free")


def polygon(corners):
    angles = np.linspace(0.0, math.tau, corners, endpoint=False)
    return Footprint.polygon(np.column_stack([np.cos(angles), np.sin(angles)]))


def mover(keys):
    return Mover(0.3, np.arange(keys), MANY[:keys])


SMALL_AND_LARGE = [
    (SMALL_GRID, LARGE_GRID, "1200 x 900 cells of 0.05 m"),
    (GridFrame(0.5), GridFrame(NUMBER, NUMBER, NUMBER, NUMBER), "resolution"),
    (Path([(0, 0)]), Path(MANY), "20000 points"),
    (driven(NONE), driven(MANY), "20000 poses"),
    (a_plan([(0, 0)]), a_plan(MANY), "by improved"),
    (a_scan([]), a_scan(np.linspace(0.0, 12.0, 20000)), "20000 beams over 360 degrees"),
    (Footprint.disc(0.3), polygon(400), "2 m long"),
    (Lidar(), Lidar(nothing=tuple(np.arange(500.0))), "nothing=(0.0, 1.0"),
    (Limits(1, 1, 1, 1, 1, 1), Limits(*[1 / 3] * 6, v_min=-1 / 3), "v_max=0.33"),
    (Robot.simple(0.2, 1.0), Robot(LONG, ROBOTS["jackal"].limits, polygon(9), Lidar()), "-0.5 to 2 m/s"),
    (ROBOTS, ROBOTS, "jackal"),
    (Pose2D(1, 2), Pose2D(NUMBER, NUMBER, NUMBER), "x="),
    (Twist(1, 2), Twist(NUMBER, NUMBER), "v="),
    (Goal(1, 2), Goal(NUMBER, NUMBER, NUMBER), "heading="),
    (MovingObstacle(*range(5)), MovingObstacle(*[NUMBER] * 5), "radius="),
    (a_state(0), a_state(NUMBER), "pose="),
    (PlannerConfig(), PlannerConfig(exact=True), "PlannerConfig(exact=True)"),
    (a_config(False), a_config(True), "unknown='free'"),
    (GridPlanner(SMALL_GRID, 0.1), GridPlanner(LARGE_GRID, 1 / 3), "for a disc of radius 0.333333 m"),
    (Navigator(SMALL_GRID, "paper"), Navigator(LARGE_GRID, "jackal"), "idle ('no goal')"),
    (Guard("paper"), Guard("jackal", grid=LARGE_GRID), "1200 x 900 cells"),
    (Guarded(Twist(0, 0), False), Guarded(Twist(NUMBER, NUMBER), True, LONG), "changed ('xxx"),
    (PlanningMap(SMALL_GRID), PlanningMap(LARGE_GRID), "0 cells blocked by scans"),
    (Status(), Status("blocked", LONG, 2, 3, a_plan(MANY), tracks=(1,) * 900, limited_by=LONG), "900 t"),
    (Track(*[0] * 8, "moving", 0, 0, 0), Track(*[NUMBER] * 8, "moving", *[NUMBER] * 3), "moving"),
    (a_choice(0), a_choice(20000), "0.40 m/s and 0.10 rad/s"),
    (SearchResult(NONE, 0.0, 0, None), SearchResult(MANY, 1 / 3, 10**9, MANY), "1000000000 cells expanded"),
    (mover(1), mover(20000), "20000 keyframes"),
    (Pedestrian(0.3, 1, (0, 0), MANY[:2]), Pedestrian(0.3, 1, (0, 0), MANY), "20000 waypoints"),
    (Fault("kidnapped", 0, pose=Pose2D(0, 0)), Fault("map_replaced", 1, grid=LARGE_GRID), "map_replaced"),
    (a_scenario(SMALL_GRID), a_scenario(LARGE_GRID, [mover(20000)] * 300, LONG), "300 movers"),
    (World(a_scenario(SMALL_GRID)), World(a_scenario(LARGE_GRID, [mover(9)] * 300)), "300 movers"),
    (episode(0, 0, 0), episode(5000, 300, 9), "arrived ('within 0.25 m')"),
    (PlanRecord(0, "", NONE, NONE), PlanRecord(0, LONG, MANY, MANY), "20000 cells explored"),
    (EventRecord(0, "state", ""), EventRecord(0, LONG, LONG), "at 0.00 s"),
    (a_trace(0), a_trace(20000), "20000 of them refused"),
    (measure(episode(0, 0, 0)), measure(episode(5000, 300, 9)), "8 replans"),
]  # fmt: skip


@pytest.mark.parametrize(
    ("small", "large", "words"), SMALL_AND_LARGE, ids=lambda of: type(of).__name__
)
def test_objects_are_shown_in_a_few_words(small, large, words):
    for thing in (small, large):
        text = repr(thing)
        assert len(text) <= LONGEST_TEXT == 400
        assert " at 0x" not in text
        assert "array(" not in text
        assert text.isprintable()
    assert words in repr(large)


def test_all_public_classes_are_shown():
    shown = {type(small) for small, _, _ in SMALL_AND_LARGE}
    public = (getattr(dynastar, name) for name in dynastar.__all__)
    classes = {thing for thing in public if inspect.isclass(thing)}
    without = {one for one in classes if issubclass(one, Exception)}
    assert {Episode, World} <= classes
    assert classes - without <= shown


def test_settings_show_what_differs_from_the_defaults():
    assert repr(NavigatorConfig()) == "NavigatorConfig()"
    config = NavigatorConfig(period=0.2, planner=PlannerConfig())
    assert repr(config) == "NavigatorConfig(period=0.2, planner=PlannerConfig())"
    assert eval(repr(config)) == config


def test_an_episode_says_how_it_ended():
    text = repr(episode(20))
    for words in ("arrived", "1.9 s", "by 'jackal'", "20 ticks", "2 goals", "2 plans", "2 movers"):
        assert words in text
    assert "with its trace" not in text

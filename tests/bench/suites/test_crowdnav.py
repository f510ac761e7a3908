"""The suite crowdnav: its people walk as pyrvo says, and ORCA's robot as in print."""

import math
import sys

import numpy as np
import pytest

from dynastar.bench.keeping import mission_numbered
from dynastar.bench.missions import Mission, Options
from dynastar.bench.selection import choose_missions
from dynastar.bench.suites import load_suite
from dynastar.errors import DataError
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import Navigator, RobotState
from dynastar.simulation.run import effective_config


def test_without_pyrvo_one_clear_line(monkeypatch):
    monkeypatch.setitem(sys.modules, "pyrvo", None)
    for name in ("crowdnav", "crowdnav_people", "crowdnav_robots"):
        monkeypatch.delitem(sys.modules, f"dynastar.bench.suites.{name}", raising=False)
    with pytest.raises(DataError, match="the suite crowdnav needs the package pyrvo"):
        load_suite("crowdnav")


pyrvo = pytest.importorskip("pyrvo")

from dynastar.bench.suites import crowdnav  # noqa: E402
from dynastar.bench.suites.crowdnav_people import OrcaPeople, Walk, draw_walks  # noqa: E402
from dynastar.bench.suites.crowdnav_robots import OrcaWorld, ToldNavigator  # noqa: E402

STEPS = 60
FAR = [Walk((7.0, 7.0), (7.0, 7.0))]


def stepped_apart(person, others, goal):
    """The next velocity of one (position, velocity), by a simulator of its own, as in print."""
    simulator = pyrvo.RVOSimulator(0.25, 10.0, 10, 5.0, 5.0, 0.3, 1.0)
    for position, velocity in (person, *others):
        simulator.add_agent(tuple(position), 10.0, 10, 5.0, 5.0, 0.31, 1.0, tuple(velocity))
    wanted = np.subtract(goal, person[0])
    if np.hypot(*wanted) > 1.0:
        wanted = wanted / np.hypot(*wanted)
    simulator.set_agent_pref_velocity(0, tuple(wanted))
    for other in range(1, len(others) + 1):
        simulator.set_agent_pref_velocity(other, (0.0, 0.0))
    simulator.do_step()
    return np.array(simulator.get_agent_velocity(0).to_tuple())


@pytest.mark.parametrize("variant", [v for v in crowdnav.VARIANTS if not v.by_orca])
@pytest.mark.parametrize("seed", [3, 2001])
def test_people_walk_as_pyrvo_says_stepped_apart(variant, seed):
    walks = draw_walks(seed, variant.people, variant.square)
    sees = np.random.default_rng(seed).random(variant.people) < variant.seeing
    people = crowdnav.draw_people(variant, seed)
    state = [(np.array(walk.start), np.zeros(2)) for walk in walks]
    robot = np.array([0.0, -4.0]), np.zeros(2)
    for step in range(STEPS):
        people.advance(0.25 * step, Pose2D(*robot[0], 0.0))
        np.testing.assert_allclose(people.at(0.25 * step), [p for p, _ in state], atol=2e-4)
        decided = []
        for i, person in enumerate(state):
            others = state[:i] + state[i + 1 :] + ([robot] if sees[i] else [])
            decided.append(stepped_apart(person, others, walks[i].goal))
        state = [(p + 0.25 * v, v) for (p, _), v in zip(state, decided, strict=True)]
        between = people.at(0.25 * step + 0.1)
        expected = [p - 0.15 * v for p, v in state]
        np.testing.assert_allclose(between, expected, atol=2e-4)
        velocity = np.array([0.3 * math.sin(step), 0.8])
        robot = robot[0] + 0.25 * velocity, velocity


def test_only_people_who_see_the_robot_avoid_it():
    ways = {}
    for seeing in (False, True):
        people = OrcaPeople([Walk((0.0, 4.0), (0.0, -4.0))], np.array([seeing]))
        for step in range(20):
            people.advance(0.25 * step, Pose2D(0.05, 0.0, 0.0))
        ways[seeing] = abs(people.at(4.75)[0, 0])
    assert ways[False] == 0.0
    assert ways[True] > 0.2


def test_draws_are_those_of_the_published_code():
    random = np.random.RandomState(1000)
    angle, x, y = random.random_sample(3)
    start = 4.0 * math.cos(math.tau * angle) + x - 0.5, 4.0 * math.sin(math.tau * angle) + y - 0.5
    assert draw_walks(1000, 1) == [Walk(start, (-start[0], -start[1]))]
    random = np.random.RandomState(1001)
    side, x, y, goal_x, goal_y = random.random_sample(5)
    side = -5.0 if side > 0.5 else 5.0
    expected = Walk((side * x, 10.0 * (y - 0.5)), (-side * goal_x, 10.0 * (goal_y - 0.5)))
    assert draw_walks(1001, 1, square=True) == [expected]


@pytest.mark.parametrize("square", [False, True])
def test_nobody_starts_or_ends_near_another(square):
    for seed in range(20):
        agents = [Walk((0.0, -4.0), (0.0, 4.0)), *draw_walks(seed, 10, square)]
        for i, agent in enumerate(agents):
            for other in agents[:i]:
                assert math.dist(agent.start, other.start) >= 0.8
                assert math.dist(agent.goal, other.goal) >= 0.8
                assert square or math.dist(agent.start, other.goal) >= 0.8


def test_published_cases_are_the_default_and_quick_ones_are_for_development():
    chosen, _ = choose_missions(crowdnav, Options())
    assert [mission.number for mission in chosen] == list(range(1000, 1500))
    quick, _ = choose_missions(crowdnav, Options(quick=True))
    assert len(quick) == crowdnav.QUICK_MISSIONS
    assert all(mission.number % 10_000 < 100 for mission in quick)
    groups = {crowdnav.VARIANTS[mission.number // 10_000].name for mission in quick}
    assert groups == {v.name for v in crowdnav.VARIANTS if not v.by_orca}
    chosen, _ = choose_missions(crowdnav, Options(select="31000:31500"))
    assert (len(chosen), chosen[0].number) == (500, 31_000)
    assert mission_numbered("crowdnav", crowdnav, Options(), 42) == Mission(42)


def test_other_controllers_drive_only_where_nothing_else_does():
    options = Options(controller="pure_pursuit")
    assert crowdnav.leave_out(Mission(7), options) == ""
    assert "orca" in crowdnav.leave_out(Mission(60_007), options)
    assert "told" in crowdnav.leave_out(Mission(50_007), options)


def orca_world(walks):
    scenario = crowdnav.scenario(Mission(60_000), Options(), 0)
    people = OrcaPeople(walks, np.zeros(len(walks), np.bool_))
    return OrcaWorld(scenario, Pose2D(*scenario.start), 0, people)


def test_a_robot_by_orca_goes_straight_whatever_it_is_commanded():
    made = orca_world(FAR)
    for _ in range(24):
        made.step(Twist(-1.0, 2.0), 0.25)
    assert made.pose == pytest.approx((0.0, 2.0, math.pi / 2), abs=1e-4)
    assert (made.twist, made.contact) == (pytest.approx((1.0, 0.0), abs=1e-4), "")


def test_a_robot_by_orca_decides_as_pyrvo_says_stepped_apart():
    walks = draw_walks(5, 5)
    made, people, robot = orca_world(walks), OrcaPeople(walks, np.zeros(5, np.bool_)), None
    robot, before = (np.array([0.0, -4.0]), np.zeros(2)), np.zeros((5, 2))
    for step in range(8):
        people.advance(0.25 * step, made.pose)
        others = list(zip(people.at(0.25 * step), before, strict=True))
        velocity = stepped_apart(robot, others, (0.0, 4.0))
        before = (people.at(0.25 * step + 0.2) - people.at(0.25 * step)) / 0.2
        made.step(Twist(0.0, 0.0), 0.25)
        robot = robot[0] + 0.25 * velocity, velocity
        assert made.pose[:2] == pytest.approx(robot[0], abs=2e-4)


def test_a_row_by_orca_with_its_episode():
    seen = []
    options = Options(observe=lambda *args: seen.append(args))
    row = crowdnav.run_mission(Mission(60_000), options, 0)
    assert (row["group"], row["outcome"]) == ("orca", "arrived")
    assert 7.5 < row["time"] < 24.0
    assert seen[0][2].movers.shape[1] == 5


def test_the_navigator_is_told_positions_and_last_velocities(monkeypatch):
    told = []
    monkeypatch.setattr(Navigator, "command", lambda self, *data: told.append(data[2]))
    scenario = crowdnav.scenario(Mission(50_004), Options(), 0)
    people = crowdnav.draw_people(crowdnav.VARIANTS[5], 4)
    driver = ToldNavigator(scenario.grid, scenario.robot, effective_config(scenario), people)
    for step in range(3):
        people.advance(0.25 * step, Pose2D(0.0, -4.0, 0.0))
        if step == 1:
            last = (people.at(0.35) - people.at(0.25)) / 0.1
    for time in (0.5, 0.6):
        driver.command(RobotState(time, Pose2D(0.0, -4.0, 0.0), Twist(0.0, 0.0)), None)
    moved = (people.at(0.6) - people.at(0.5)) / 0.1
    assert np.abs(moved - last).max() > 1e-3
    for movers, time, velocities in zip(told, (0.5, 0.6), (last, moved), strict=True):
        np.testing.assert_allclose([(m.x, m.y) for m in movers], people.at(time))
        np.testing.assert_allclose([(m.vx, m.vy) for m in movers], velocities, atol=1e-9)

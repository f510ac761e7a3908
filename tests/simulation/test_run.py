import json
import math
import re
import time
from dataclasses import dataclass, field, replace
from types import SimpleNamespace

import numpy as np
import pytest

from dynastar import io
from dynastar.errors import (
    ConfigError,
    GoalOccupied,
    NoPath,
    OutOfMap,
    ScenarioError,
    StartOccupied,
)
from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Twist, wrap_angle
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.path import Path
from dynastar.robot import Limits, Robot
from dynastar.simulation import (
    ControlLoop,
    Drivetrain,
    LidarDriver,
    Mover,
    Noise,
    Odometry,
    Scenario,
    run,
)
from dynastar.simulation.run import effective_config
from dynastar.simulation.start import start_pose

QUICK = Robot("quick", Limits(1.0, 1.0, 5.0, 5.0, 5.0, 5.0), Footprint.disc(0.3))
GRID = OccupancyGrid.from_occupied(np.zeros((20, 20), bool))


@dataclass
class Status:
    state: str = "idle"
    reason: str = ""
    replans: int = 0
    recoveries: int = 0
    plan: object = None
    plan_id: int = 0
    plan_reason: str = ""
    planning_frame: GridFrame = GRID.frame
    error: Exception | None = None


@dataclass
class Straight:
    """Drives straight to the goals, turning on the spot first; sees nothing."""

    grid: object
    robot: object
    config: object
    status: Status = field(default_factory=Status)

    def set_goal(self, goals):
        self.goals = list(goals)

    def command(self, state, scan):
        assert scan.stamp == state.stamp
        goal, (x, y, theta) = self.goals[0], state.pose
        gap = math.hypot(goal.x - x, goal.y - y)
        if gap < self.config.goal_tolerance and self.status.state != "arrived":
            self.status.state = "arrived"
        if self.status.state in ("arrived", "blocked"):
            return Twist(0.0, 0.0)
        off = wrap_angle(math.atan2(goal.y - y, goal.x - x) - theta)
        self.status.state = "turning" if abs(off) > 0.3 else "following"
        return Twist(0.0 if abs(off) > 0.3 else min(1.0, gap + 0.1), max(-1.0, min(1.0, 2.0 * off)))


def saying(*said, drive=Twist(0.0, 0.0)):
    """A controller that drives ``drive`` and sets its status from ``said``: (from s, fields)."""

    class Saying(Straight):
        def command(self, state, scan):
            for since, fields in said:
                if state.stamp >= since - 1e-9:
                    self.status = replace(self.status, **fields)
            return Twist(0.0, 0.0) if self.status.state in ("arrived", "blocked") else drive

    return Saying


def scenario(**more):
    given = {"start": (5.0, 5.0, 0.0), "goals": (Goal(12.0, 5.0),), "robot": QUICK, **more}
    return Scenario("test", given.pop("grid", GRID), **given)


def test_it_arrives_and_everything_is_written_down():
    mover = Mover(0.4, np.array([0.0, 4.0]), np.array([[1.0, 12.0], [5.0, 12.0]]))
    episode = run(scenario(movers=(mover,)), navigator=Straight)
    assert (episode.outcome, episode.contact) == ("arrived", "")
    n = len(episode.states)
    assert episode.trajectory.poses.shape == (n, 3)
    assert episode.commands.shape == episode.trajectory.twists.shape == (n, 2)
    assert episode.clearance.shape == episode.command_ms.shape == (n,)
    assert episode.movers.shape == (n, 1, 2)
    np.testing.assert_allclose(episode.trajectory.times, 0.1 * np.arange(n), atol=1e-9)
    np.testing.assert_allclose(episode.movers[20, 0], (3.0, 12.0), atol=1e-9)
    assert episode.mover_radii.tolist() == [0.4]
    assert episode.clearance[0] == pytest.approx(4.7)
    assert math.dist(episode.trajectory.poses[-1, :2], (12.0, 5.0)) < 0.26
    assert (episode.trajectory.twists[-1] == 0.0).all()
    assert (episode.command_ms > 0.0).all()
    assert [event.detail for event in episode.events] == ["following", "arrived"]
    assert (episode.goals[0, :2] == (12.0, 5.0)).all()
    assert json.loads(json.dumps(episode.config))["goal_tolerance"] == 0.25
    assert json.loads(json.dumps(episode.scenario))["movers"][0]["times"] == [0.0, 4.0]


def test_time_goes_on_until_the_robot_rests_after_its_arrival():
    slow = replace(QUICK, limits=Limits(1.0, 1.0, 5.0, 5.0, 0.2, 5.0))
    fast = saying((4.0, {"state": "arrived"}), drive=Twist(1.0, 0.0))
    episode = run(scenario(robot=slow, goals=(Goal(9.0, 5.0),)), navigator=fast)
    first = episode.trajectory.times[np.flatnonzero(episode.states == "arrived")[0]]
    assert episode.outcome == "arrived"
    assert first == pytest.approx(4.0)
    assert episode.trajectory.times[-1] == pytest.approx(9.0, abs=0.11)


@pytest.mark.parametrize(
    ("goals", "words"),
    [
        ((Goal(12.0, 5.0, 0.2),), ""),  # 0.25 rad are allowed
        ((Goal(12.0, 5.0, 1.0),), "said 'arrived' 0.2. m and 1.00 rad away from the goal"),
        ((Goal(8.0, 5.0), Goal(12.0, 5.0)), ""),  # passed on the way
        ((Goal(8.0, 8.0), Goal(12.0, 5.0)), "away from a goal before the last"),
        ((Goal(8.0, 5.0), Goal(6.0, 5.0), Goal(12.0, 5.0)), "a goal before the last"),
    ],
)
def test_an_arrival_has_the_last_goals_heading_and_all_goals_in_order(goals, words):
    class LastOnly(Straight):
        def set_goal(self, given):
            self.goals = list(given)[-1:]

    made = scenario(goals=goals, heading_tolerance=0.25)
    episode = run(made, navigator=LastOnly)
    assert episode.outcome == ("blocked" if words else "arrived")
    assert re.search(words, episode.reason)


def test_what_hardware_does_is_driven_and_written_down():
    drive, loop = Drivetrain(gain_v=0.5), ControlLoop(period=0.25)
    made = scenario(drive=drive, loop=loop, odometry=Odometry(gain_v=2.0), time_limit=2.0)
    episode = run(made, navigator=saying(drive=Twist(1.0, 0.0)))
    np.testing.assert_allclose(episode.trajectory.times, 0.25 * np.arange(9))
    assert (episode.trajectory.twists[1:, 0] == 0.5).all()
    assert episode.scenario["drive"]["gain_v"] == 0.5
    assert episode.scenario["loop"] == {"period": 0.25, "jitter": 0.0}
    assert "lidar" not in episode.scenario


def test_the_controller_gets_what_odometry_and_driver_say():
    given = []

    class Listening(Straight):
        def command(self, state, scan):
            given.append((state.twist.v, np.isnan(scan.ranges).any()))
            return super().command(state, scan)

    made = scenario(odometry=Odometry(gain_v=2.0), lidar=LidarDriver(nothing=math.nan))
    episode = run(made, navigator=Listening)
    speeds = episode.trajectory.twists[: len(given), 0]
    np.testing.assert_allclose([v for v, _ in given], 2.0 * speeds)
    assert any(nothing for _, nothing in given)


def test_a_contact_while_coming_to_rest_counts():
    slow = replace(QUICK, limits=Limits(1.0, 1.0, 5.0, 5.0, 0.2, 5.0))
    fast = saying((4.0, {"state": "arrived"}), drive=Twist(1.0, 0.0))
    post = np.array([[10.0, 4.0], [10.5, 4.0], [10.5, 6.0], [10.0, 6.0]])
    episode = run(scenario(robot=slow, obstacles=(post,)), navigator=fast)
    assert (episode.outcome, episode.contact) == ("contact", "moving")
    assert episode.events[-1].kind == "contact"
    assert episode.clearance[-1] == 0.0
    assert np.isnan(episode.command_ms[-1])
    assert episode.trajectory.times[-1] == episode.events[-1].stamp
    np.testing.assert_array_equal(episode.obstacles[0], post)


def test_arriving_elsewhere_is_not_arriving():
    episode = run(scenario(), navigator=saying((0.5, {"state": "arrived"})))
    assert episode.outcome == "blocked"
    assert "7.00 m away from the goal" in episode.reason


def test_the_other_ends():
    blocked = run(scenario(), navigator=saying((1.0, {"state": "blocked", "reason": "walls"})))
    assert (blocked.outcome, blocked.reason) == ("blocked", "walls")
    timeout = run(scenario(time_limit=3.0), navigator=saying((0.0, {"state": "waiting"})))
    assert timeout.outcome == "timeout"
    assert timeout.trajectory.times[-1] == pytest.approx(3.0)
    lost = saying((1.0, {"state": "sensor_lost", "reason": "no scan"}))
    lost = run(scenario(), navigator=lost)
    assert (lost.outcome, lost.reason) == ("sensor_lost", "no scan")
    assert lost.trajectory.times[-1] == pytest.approx(6.1)
    restless = saying((1.0, {"state": "sensor_lost"}), (4.0, {"state": "following"}))
    assert run(scenario(time_limit=8.0), navigator=restless).outcome == "timeout"


def test_a_mover_that_runs_into_a_waiting_robot_touches_it_at_rest():
    mover = Mover(0.4, np.array([0.0, 10.0]), np.array([[15.0, 5.0], [5.0, 5.0]]), "vanish")
    episode = run(scenario(movers=(mover,)), navigator=saying((0.0, {"state": "waiting"})))
    assert (episode.outcome, episode.contact) == ("contact", "resting")
    assert "while standing still" in episode.reason


def test_a_start_that_overlaps_an_obstacle_is_refused():
    post = np.array([[5.0, 5.0], [6.0, 5.0], [6.0, 6.0], [5.0, 6.0]])
    with pytest.raises(StartOccupied, match="overlaps a wall or an obstacle at its start"):
        io.run(scenario(obstacles=(post,)), navigator=Straight)


def test_a_start_in_contact_ends_before_it_begins():
    post = np.array([[4.0, 4.0], [6.0, 4.0], [6.0, 6.0], [4.0, 6.0]])
    episode = run(scenario(obstacles=(post,)), navigator=Straight)
    assert (episode.outcome, episode.contact) == ("contact", "resting")
    assert len(episode.states) == 1
    assert episode.events[-1].kind == "contact"


def test_the_real_navigator_raises_for_a_start_or_goal_that_cannot_be():
    occupied = np.zeros((20, 20), bool)
    occupied[2:9, 2:9] = True
    walled = OccupancyGrid.from_occupied(occupied)
    with pytest.raises(StartOccupied):
        run(scenario(grid=walled))
    with pytest.raises(GoalOccupied):
        run(scenario(grid=walled, start=(15.0, 15.0, None), goals=(Goal(5.0, 5.0),)))
    with pytest.raises(OutOfMap):
        run(scenario(start=(-5.0, 5.0, 0.0)))
    with pytest.raises(ScenarioError, match="expected finite numbers"):
        run(scenario(start=(math.nan, 5.0, 0.0)))


def test_the_real_navigator_crosses_an_empty_room():
    episode = run(scenario(start=(5.0, 5.0, None)))
    assert episode.outcome == "arrived"
    assert len(episode.plans) == 1
    assert episode.clearance.min() > 3.0


def test_a_bad_start_is_raised():
    said = {"state": "blocked", "error": OutOfMap("off the map")}
    with pytest.raises(OutOfMap, match="off the map"):
        run(scenario(), navigator=saying((0.0, said)))


def test_a_start_with_room_for_the_robot_and_not_for_its_margin_is_blocked():
    corridor = np.ones((60, 200), bool)
    corridor[4:16, 1:-1] = False  # 0.6 m wide
    corridor[1:, 160:-1] = False
    grid = OccupancyGrid(corridor, GridFrame(0.05))
    slim = Robot("slim", QUICK.limits, Footprint.disc(0.25))
    wide = {"pose_error": 0.1}
    episode = run(
        scenario(
            grid=grid, robot=slim, start=(5.0, 0.5, 0.0), goals=(Goal(9.0, 1.5),), navigator=wide
        )
    )
    assert episode.outcome == "blocked"
    assert "the start (5, 0.5)" in episode.reason


def test_no_way_is_an_outcome_and_no_goal_is_an_error():
    said = {"state": "blocked", "reason": "nothing connects them", "error": NoPath("no way")}
    assert run(scenario(), navigator=saying((0.0, said))).outcome == "blocked"
    with pytest.raises(ScenarioError, match="no goal"):
        run(scenario(goals=()), navigator=Straight)


def test_plans_and_recoveries_are_written_down_once_each():
    def plan(*points):
        return SimpleNamespace(path=Path(np.array(points, float)))

    first, second = plan((5, 5), (12, 5)), plan((5, 5), (8, 9), (12, 5))
    frame = GridFrame(0.25, 1.0, 2.0, 0.3)
    planning = saying(
        (0.2, {"plan": first, "plan_id": 1, "plan_reason": "new goal"}),
        (1.0, {"plan": second, "plan_id": 2, "plan_reason": "blocked"}),
        (1.0, {"planning_frame": frame, "recoveries": 1, "reason": "turning"}),
    )

    class Exploring(planning):
        @property
        def explored(self):
            return [[1, 2]] if self.status.plan_id == 2 else np.empty((0, 2), np.int32)

    episode = run(scenario(time_limit=2.0), navigator=Exploring)
    assert [record.reason for record in episode.plans] == ["new goal", "blocked"]
    assert [record.stamp for record in episode.plans] == pytest.approx([0.2, 1.0])
    np.testing.assert_array_equal(episode.plans[1].points, [(5, 5), (8, 9), (12, 5)])
    assert episode.plans[0].explored.shape == (0, 2)
    assert episode.plans[1].explored.tolist() == [[1, 2]]
    assert episode.explored_frame == frame
    recoveries = [event for event in episode.events if event.kind == "recovery"]
    assert [(event.stamp, event.detail) for event in recoveries] == [
        (pytest.approx(1.0), "turning")
    ]


def test_a_seed_gives_the_same_mission():
    noisy = scenario(noise=Noise(0.02, 0.03, 0.02), latency=0.15, seed=4)

    def same(a, b):
        return np.array_equal(a.trajectory.poses, b.trajectory.poses) and np.array_equal(
            a.commands, b.commands
        )

    one = run(noisy, navigator=Straight)
    assert one.outcome == "arrived"
    assert same(one, run(noisy, navigator=Straight))
    assert same(one, run(noisy, seed=4, navigator=Straight))
    other = run(noisy, seed=5, navigator=Straight)
    assert not same(one, other)
    assert (one.scenario["seed"], other.scenario["seed"]) == (4, 5)


def test_the_config_knows_the_scenario_and_its_own_overrides():
    config = effective_config(
        scenario(
            noise=Noise(0.05, 0.03, 0.04),
            latency=0.2,
            goal_tolerance=0.5,
            heading_tolerance=0.3,
            unknown="free",
            navigator={"range_error": 0.2, "period": 0.05},
        )
    )
    assert (config.latency, config.goal_tolerance, config.heading_tolerance) == (0.2, 0.5, 0.3)
    assert (config.unknown, config.range_error, config.period) == ("free", 0.2, 0.05)
    assert config.pose_error == pytest.approx(0.03 * math.sqrt(2.0))
    assert config.heading_error == 0.04
    rounded = effective_config(scenario(noise=Noise(0.05), lidar=LidarDriver(rounding=0.02)))
    assert rounded.range_error == pytest.approx(0.06)
    with pytest.raises(ConfigError, match="did you mean 'latency'"):
        effective_config(scenario(navigator={"latencey": 0.1}))


def test_without_a_heading_the_robot_faces_the_first_leg():
    assert start_pose(scenario(start=(5.0, 5.0, 1.0))).theta == 1.0
    towards = start_pose(scenario(start=(5.0, 5.0, None), goals=(Goal(5.0, 15.0),)))
    assert towards.theta == pytest.approx(math.pi / 2)
    occupied = np.zeros((20, 20), bool)
    occupied[4:7, 8] = True
    round_it = start_pose(
        scenario(start=(5.5, 5.5, None), grid=OccupancyGrid.from_occupied(occupied))
    )
    assert 0.1 < abs(round_it.theta) < 1.5
    occupied[:, 8] = True
    walled_off = start_pose(
        scenario(start=(5.0, 5.0, None), grid=OccupancyGrid.from_occupied(occupied))
    )
    assert walled_off.theta == pytest.approx(0.0)


def test_progress_goes_to_stderr_once_a_run_takes_long(capsys, monkeypatch):
    monkeypatch.setattr("dynastar.terminal.EVERY", 0.0)  # s between lines where it is no terminal

    class Slow(Straight):
        def set_goal(self, goals):
            super().set_goal(goals)
            self.waited = False

        def command(self, state, scan):
            if state.stamp > 0.5 and not self.waited:
                time.sleep(0.7)
                self.waited = True
            return super().command(state, scan)

    run(scenario(), progress=True, navigator=Slow)
    shown = capsys.readouterr()
    assert shown.out == ""
    assert "simulated s" in shown.err

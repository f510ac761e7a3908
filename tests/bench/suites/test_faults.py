"""Suite faults: the strikes, the rooms, and how a stop is judged."""

from types import SimpleNamespace

import numpy as np
import pytest

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options
from dynastar.bench.suites import faults
from dynastar.geometry import Pose2D, Twist
from dynastar.grid import GridFrame
from dynastar.planning import plan
from dynastar.robot import ROBOTS
from dynastar.simulation import World
from dynastar.simulation.faults import KINDS

OPTIONS = Options()
ALL = list(faults.missions(OPTIONS))


def number(case, robot="jackal"):
    return next(m for m in ALL if m.spec.case.name == case and m.spec.robot == robot)


class Straight:
    """Drives straight on at 1 m/s; brakes only where ``cautious`` and there is no scan."""

    cautious = True

    def __init__(self, grid, robot, config):
        self.brake = robot.limits.v_brake * config.period
        self.v = 0.0
        self.status = SimpleNamespace(
            state="following", reason="", recoveries=0, plan=None, plan_id=0, plan_reason="",
            planning_frame=GridFrame(1.0), error=None,
        )  # fmt: skip

    def set_goal(self, goals):
        self.goal = goals[-1]

    def command(self, state, scan):
        there = state.pose.x >= self.goal.x - 0.2
        stop = there or (self.cautious and scan is None)
        self.status.state = "arrived" if there else "following"
        self.v = max(0.0, self.v - self.brake) if stop else 1.0
        return Twist(self.v, 0.0)


class Careless(Straight):
    cautious = False


class Raising(Straight):
    def command(self, state, scan):
        raise RuntimeError("no idea")


def flown(monkeypatch, mission, controller, **more):
    monkeypatch.setattr(driven, "controller_named", lambda name: controller)
    monkeypatch.setattr(driven, "time_bound", lambda scenario: None)
    return faults.run_mission(mission, Options(controller="given", **more), 0)


def test_every_case_strikes_both_robots_at_three_times():
    assert [m.number for m in ALL] == list(range(6 * len(faults.CASES)))
    assert len({(s.case.name, s.robot, s.fraction) for s in (m.spec for m in ALL)}) == len(ALL)
    assert {case.fault.get("kind", case.name) for case in faults.CASES} | {
        "map_replaced",
        "obstacle_appears",
        "kidnapped",
    } >= set(KINDS)


@pytest.mark.parametrize("mission", ALL[::3], ids=lambda m: f"{m.spec.case.name}-{m.spec.robot}")
def test_every_fault_can_be_made_and_strikes_under_way(mission):
    scenario = faults.scenario(mission, OPTIONS, 0)
    (fault,) = scenario.faults
    assert 0.0 < fault.start < 20.0
    assert 0.0 < fault.speed < scenario.robot.limits.v_max
    assert (scenario.latency, scenario.noise.range_bound) == (0.05, 0.01)
    assert faults.scenario(mission, Options(ideal=True), 0).latency == 0.0


@pytest.mark.parametrize("name", faults.ROBOT_NAMES)
def test_start_goal_and_elsewhere_are_free_and_there_is_a_detour(name):
    mission = number("kidnapped", name)
    world = World(faults.scenario(mission, OPTIONS, 0), faults.START)
    for pose in (faults.START, Pose2D(*faults.GOAL[:2], 0.0), faults.ELSEWHERE):
        world.place(pose)
        assert world.contact == ""
    radius = ROBOTS[name].footprint.circumscribed + 0.1
    straight = plan(faults.rooms(), faults.START[:2], faults.GOAL[:2], radius=radius)
    detour = plan(faults.rooms(0.05, True), faults.START[:2], faults.GOAL[:2], radius=radius)
    assert straight.path.length == pytest.approx(15.0, abs=0.1)
    assert 16.0 < detour.path.length < 25.0


def test_nothing_but_the_occupied_goal_cannot_be_reached():
    assert [case.name for case in faults.CASES if case.ends == "blocked"] == ["goal_occupied"]


def stop(commands, speeds=None, onset=0.2, over=1.0):
    commands = np.array(commands, float)
    speeds = commands if speeds is None else np.array(speeds, float)
    episode = SimpleNamespace(
        trajectory=SimpleNamespace(
            times=0.1 * np.arange(len(commands)),
            twists=np.column_stack([speeds, np.zeros(len(commands))]),
        ),
        commands=np.column_stack([commands, np.zeros(len(commands))]),
    )
    return faults.stop_begins(episode, onset, over)


@pytest.mark.parametrize(
    ("commands", "begins"),
    [
        ([1, 1, 0.5, 0, 0, 0, 0, 0], 0.0),  # falls at the onset
        ([1, 1, 1, 1, 0.5, 0, 0, 0], 0.2),
        ([1, 1, 0.5, 1, 1, 0.5, 0, 0], 0.3),  # falls, rises, falls to rest
        ([0.5, 1, 1, 1, 1, 1, 0, 0], 0.4),
        ([1, 0.8, 0.6, 0.3, 0, 0, 0, 0], 0.0),  # it was slowing down already
        ([1, 1, 1, 0.7, 0.7, 0.4, 0.4, 0], 0.1),  # level stretches are part of a stop
        ([1, 1, 1, 0.5, 0.5, 0.5, 0.5, 0.5], None),  # slower is no stop
        ([1] * 12 + [0] * 3, None),  # too late: the data are good again
        ([-1, -1, -0.5, 0, 0, 0, 0, 0], 0.0),  # reversing stops, too
        ([0] * 8, 0.0),
    ],
)
def test_a_stop_begins_where_the_commanded_speed_falls_to_rest(commands, begins):
    assert stop(commands) == (None if begins is None else pytest.approx(begins))


def test_a_robot_that_still_rolls_has_not_stopped():
    assert stop([1, 1, 0, 0, 0, 0, 0, 0], [1] * 8) is None


def test_a_controller_that_stops_without_scans_is_right(monkeypatch):
    row = flown(monkeypatch, number("scans_lost"), Straight)
    assert row["struck_speed"] == pytest.approx(1.0)
    assert row["struck_at"] == pytest.approx(1.5)
    assert (row["stop_begins_s"], row["stopped_in_time"]) == (0.0, True)
    assert (row["outcome"], row["goes_on"], row["right"]) == ("arrived", True, True)
    assert (row["group"], row["robot"]) == ("scans_lost", "jackal")


def test_one_that_drives_on_is_not(monkeypatch):
    row = flown(monkeypatch, number("scans_lost"), Careless)
    assert (row["stop_begins_s"], row["stopped_in_time"]) == (None, False)
    assert (row["outcome"], row["goes_on"], row["right"]) == ("arrived", True, False)


def test_where_no_stop_is_required_going_on_is_right(monkeypatch):
    row = flown(monkeypatch, number("twist_glitch_20"), Careless)
    assert (row["stopped_in_time"], row["right"], row["commands_in_limits"]) == (None, True, True)


def test_a_command_beyond_the_limits_is_wrong(monkeypatch):
    class Echo(Careless):
        def command(self, state, scan):
            return super().command(state, scan)._replace(v=max(1.0, state.twist.v))

    row = flown(monkeypatch, number("twist_glitch_20"), Echo)
    assert (row["commands_in_limits"], row["right"]) == (False, False)


def test_driving_into_what_stands_over_the_goal_is_wrong(monkeypatch):
    row = flown(monkeypatch, number("goal_occupied"), Straight)
    assert (row["outcome"], row["right"], row["blocked_rightly"]) == ("contact", False, False)
    assert row["goes_on"] is None


def test_a_controller_that_raises_has_failed_its_case(monkeypatch):
    row = flown(monkeypatch, number("scans_lost"), Raising)
    assert (row["outcome"], row["right"], row["stopped_in_time"]) == ("error", False, False)
    assert "no idea" in row["reason"]
    assert row["group"] == "scans_lost"


def test_a_mission_flies_the_same_twice(monkeypatch):
    mission = Mission(*number("beams_missing"))
    one, two = (flown(monkeypatch, mission, Straight) for _ in range(2))
    for row in (one, two):
        for key in ("command_ms_mean", "command_ms_max", "tick_ms_median", "tick_ms_p99"):
            row.pop(key)
    assert one == two


def test_the_episode_can_be_observed_from_here(monkeypatch):
    seen = []
    row = flown(
        monkeypatch, number("scans_lost"), Straight, observe=lambda *given: seen.append(given)
    )
    ((mission, repeat, episode, observed),) = seen
    assert (mission.number, repeat, observed) == (number("scans_lost").number, 0, row)
    assert episode.outcome == row["outcome"]
    assert "episode" not in row

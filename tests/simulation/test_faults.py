"""Faults: each distorts what it says, when it says, and nothing else."""

import json
import math
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from dynastar.errors import ScenarioError
from dynastar.footprint import Footprint
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.io import load_episode, save_episode
from dynastar.robot import Lidar, Limits, Robot
from dynastar.simulation import Fault, Noise, Scenario, drive

PERIOD = 0.1
ROBOT = Robot("quick", Limits(1.0, 1.0, 5.0, 5.0, 5.0, 5.0), Footprint.disc(0.3), Lidar(90))
GRID = OccupancyGrid.from_occupied(np.zeros((20, 40), bool), 0.5)
BOX = np.array([[12.0, 4.0], [13.0, 4.0], [13.0, 6.0], [12.0, 6.0]])


@pytest.mark.parametrize("kind", ["scans_late", "commands_late"])
def test_nothing_is_late_by_less_than_nothing(kind):
    with pytest.raises(ScenarioError, match=r"size -0\.5: expected 0 or more"):
        Fault(kind, 1.0, size=-0.5)


class Witness:
    """Drives straight on at ``v`` and keeps what it was given."""

    def __init__(self, grid, robot, config, v=0.5):
        self.grid, self.v = grid, v
        self.given, self.maps = [], []
        self.status = SimpleNamespace(
            state="following", reason="", recoveries=0, plan=None, plan_id=0, plan_reason="",
            planning_frame=GridFrame(1.0), error=None,
        )  # fmt: skip

    def set_goal(self, goals):
        pass

    def set_map(self, grid):
        self.maps.append(grid)

    def command(self, state, scan):
        self.given.append((state, scan))
        return Twist(self.v, 0.0)


def under(*faults, witness=Witness, seconds=3.0):
    """The controller's view and the episode of a straight drive under these faults."""
    made = []
    scenario = Scenario(
        "faults", GRID, ROBOT, (2.0, 5.0, 0.0), (Goal(19.0, 5.0),), faults=faults,
        noise=Noise(range_bound=0.01), time_limit=seconds, navigator={"period": PERIOD},
    )  # fmt: skip

    def make(*args):
        made.append(witness(*args))
        return made[0]

    episode = drive(scenario, navigator=make)
    return made[0], episode


def struck(given, start=1.0, duration=1.0):
    """The (state, scan, true time) of the ticks between start and start + duration."""
    return [
        (*pair, i * PERIOD)
        for i, pair in enumerate(given)
        if start - 1e-6 <= i * PERIOD < start + duration - 1e-6
    ]


def untouched(given, clean, start=1.0, duration=1.0):
    """Whether all ticks outside the fault are those of a drive without one."""
    for i, ((state, scan), (true_state, true_scan)) in enumerate(zip(given, clean, strict=True)):
        if not start - 1e-6 <= i * PERIOD < start + duration - 1e-6:
            assert state == true_state
            assert scan.stamp == true_scan.stamp
            assert np.array_equal(scan.ranges, true_scan.ranges)
    return True


@pytest.fixture(scope="module")
def clean():
    return under()[0].given


def test_without_faults_the_senses_are_true(clean):
    assert len(clean) == 31
    assert all(state.stamp == scan.stamp for state, scan in clean)


@pytest.mark.parametrize(
    ("kind", "size", "check"),
    [
        ("scans_lost", 0.0, lambda state, scan, t, true: scan is None),
        ("scans_frozen", 0.0, lambda state, scan, t, true: scan.stamp == pytest.approx(0.9)),
        (
            "scans_repeated",
            0.0,
            lambda state, scan, t, true: (
                scan.stamp == state.stamp and np.array_equal(scan.ranges, true[9][1].ranges)
            ),
        ),
        ("scans_nan", 0.0, lambda state, scan, t, true: np.isnan(scan.ranges).all()),
        ("beams_missing", 0.5, lambda state, scan, t, true: 20 < np.isnan(scan.ranges).sum() < 70),
        ("side_missing", 0.5, lambda state, scan, t, true: np.isnan(scan.ranges[:45]).all()),
        ("scans_late", 0.2, lambda state, scan, t, true: scan.stamp == pytest.approx(t - 0.2)),
        ("scans_ahead", 1e6, lambda state, scan, t, true: scan.stamp == pytest.approx(t + 1e6)),
        (
            "pose_jump",
            1.0,
            lambda state, scan, t, true: (
                state.pose.y == pytest.approx(6.0) and state.stamp == pytest.approx(t)
            ),
        ),
        ("state_frozen", 0.0, lambda state, scan, t, true: state.stamp == pytest.approx(0.9)),
        ("state_nan", 0.0, lambda state, scan, t, true: math.isnan(state.pose.x + state.twist.v)),
        ("twist_glitch", 20.0, lambda state, scan, t, true: state.twist.v == 20.0),
        (
            "clock_back",
            2.0,
            lambda state, scan, t, true: state.stamp == scan.stamp == pytest.approx(t - 2.0),
        ),
    ],
)
def test_a_fault_distorts_its_part_while_it_lasts(kind, size, check, clean):
    witness, episode = under(Fault(kind, 1.0, 1.0, size))
    ticks = struck(witness.given)
    assert len(ticks) == 10
    for state, scan, t in ticks:
        assert check(state, scan, t, clean)
    assert untouched(witness.given, clean)
    begins, ends = (event for event in episode.events if event.kind == "fault")
    assert (begins.stamp, ends.stamp) == (pytest.approx(1.0), pytest.approx(2.0))
    assert kind in begins.detail


def test_a_duration_of_zero_is_one_tick():
    witness, _ = under(Fault("twist_glitch", 1.0, 0.0, 1e4))
    assert [state.twist.v == 1e4 for state, _ in witness.given].count(True) == 1
    assert witness.given[10][0].twist.v == 1e4


def test_a_fault_can_last_for_good():
    witness, _ = under(Fault("clock_back", 1.0, math.inf, 2.0))
    assert all(state.stamp < 1.01 for state, _ in witness.given)


def test_a_fault_waits_until_the_robot_drives():
    witness, episode = under(Fault("scans_lost", 0.0, 1.0, speed=0.45))
    first = next(i for i, (_, scan) in enumerate(witness.given) if scan is None)
    assert episode.trajectory.twists[first, 0] >= 0.45
    assert episode.trajectory.twists[first - 1, 0] < 0.45


def test_late_commands_act_later():
    class Brakes(Witness):
        def command(self, state, scan):
            super().command(state, scan)
            return Twist(0.5 if state.stamp < 1.0 - 1e-6 else 0.0, 0.0)

    def stops(episode):
        times, v = episode.trajectory.times, episode.trajectory.twists[:, 0]
        return times[np.flatnonzero(v > 1e-6)[-1]]

    _, prompt = under(witness=Brakes)
    _, late = under(Fault("commands_late", 0.5, 2.0, 0.3), witness=Brakes)
    assert stops(late) - stops(prompt) == pytest.approx(0.3)
    assert np.array_equal(late.commands, prompt.commands)


def test_the_map_is_replaced_once():
    other = OccupancyGrid.from_occupied(np.zeros((4, 4), bool), 1.0)
    witness, _ = under(Fault("map_replaced", 1.0, grid=other))
    assert witness.maps == [other]


def test_a_controller_without_maps_says_so_in_the_events():
    class Mapless(Witness):
        set_map = None

    _, episode = under(Fault("map_replaced", 1.0, grid=GRID), witness=Mapless)
    assert [e.detail for e in episode.events if e.kind == "fault"] == [
        "map_replaced: the controller takes no other map"
    ]


def test_an_obstacle_appears_is_seen_and_can_be_touched():
    witness, episode = under(Fault("obstacle_appears", 1.0, polygon=BOX), seconds=30.0)
    ahead = [scan.ranges[45] for _, scan in witness.given]
    assert not np.isfinite(ahead[:10]).any()
    near = [r for (s, _), r in zip(witness.given, ahead, strict=True) if 12.0 - s.pose.x < 4.9]
    assert np.isfinite(near).all()
    assert episode.outcome == "contact"
    assert episode.trajectory.poses[-1, 0] == pytest.approx(11.7, abs=0.02)
    assert len(episode.obstacles) == 1


def test_a_kidnapped_robot_is_elsewhere_and_knows_it():
    witness, episode = under(Fault("kidnapped", 1.0, pose=Pose2D(15.0, 2.0, 1.0)))
    state, _ = witness.given[10]
    assert state.pose == Pose2D(15.0, 2.0, 1.0)
    assert tuple(episode.trajectory.poses[10]) == (15.0, 2.0, 1.0)


def test_faults_are_kept_in_a_saved_episode(tmp_path):
    fault = Fault("kidnapped", 1.0, pose=Pose2D(15.0, 2.0, 1.0))
    _, episode = under(fault, Fault("obstacle_appears", 2.0, polygon=BOX))
    save_episode(episode, tmp_path / "e.npz")
    kept = load_episode(tmp_path / "e.npz")
    assert [f["kind"] for f in kept.scenario["faults"]] == ["kidnapped", "obstacle_appears"]
    assert json.dumps(kept.scenario["faults"])
    assert np.array_equal(kept.obstacles[0], BOX)


@pytest.mark.parametrize(
    ("wrong", "words"),
    [
        ({"kind": "scan_lost"}, "did you mean 'scans_lost'"),
        ({"start": -1.0}, "start -1.0"),
        ({"duration": math.nan}, "duration nan"),
        ({"size": math.nan}, "size nan"),
        ({"kind": "beams_missing", "size": 2.0}, "expected 0 to 1"),
        ({"kind": "kidnapped"}, "needs a pose"),
        ({"kind": "map_replaced"}, "needs a grid"),
        ({"kind": "obstacle_appears"}, "needs a polygon"),
    ],
)
def test_wrong_faults_are_refused(wrong, words):
    with pytest.raises(ScenarioError, match=words):
        Fault(**{"kind": "scans_lost", "start": 1.0, **wrong})


def test_an_obstacle_that_is_no_polygon_is_refused():
    with pytest.raises(ScenarioError, match="obstacle 0 has shape"):
        under(Fault("obstacle_appears", 1.0, polygon=BOX[:2]))


def test_a_seed_gives_the_same_faults():
    fault = Fault("beams_missing", 1.0, 1.0, 0.5)
    first, second = (under(fault)[0].given for _ in range(2))
    for (_, a), (_, b) in zip(first, second, strict=True):
        assert np.array_equal(a.ranges, b.ranges, equal_nan=True)
    assert replace(fault, size=0.2).size == 0.2


@pytest.mark.parametrize("kind", ["scans_frozen", "scans_repeated", "state_frozen"])
def test_what_is_frozen_from_the_start_is_the_first_that_is_delivered(kind):
    states, scans = zip(*under(Fault(kind, 0.0, 1.0))[0].given[:9], strict=True)
    poses, ranges = {state.pose for state in states}, {scan.ranges.tobytes() for scan in scans}
    assert len(poses if kind == "state_frozen" else ranges) == 1

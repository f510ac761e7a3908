import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.episode import Episode, EventRecord, PlanRecord
from dynastar.grid import OccupancyGrid
from dynastar.metrics import Metrics, measure
from dynastar.path import Trajectory

PINNED = (
    *("outcome", "reason", "time", "length", "turning_points", "min_clearance"),
    *("contacts_moving", "contacts_resting", "replans", "recoveries"),
    *("command_ms_mean", "command_ms_max"),
)
NO_CELLS = np.empty((0, 2), dtype=np.int32)


def episode(positions: Any, **changed: Any) -> Episode:
    """An arrived mission over ``positions`` (n, 2), a second a tick, straight on."""
    positions = np.array(positions, dtype=float).reshape(-1, 2)
    n = len(positions)
    made = Episode(
        grid=OccupancyGrid.from_occupied(np.zeros((10, 10), dtype=bool)),
        robot="paper",
        radius=0.3,
        footprint=np.empty((0, 2)),
        goals=positions[-1:] if n else np.array([[1.0, 1.0]]),
        goal_tolerance=0.25,
        trajectory=Trajectory(
            10.0 + np.arange(n), np.column_stack([positions, np.zeros(n)]), np.zeros((n, 2))
        ),
        commands=np.zeros((n, 2)),
        clearance=np.full(n, 0.5),
        command_ms=np.full(n, 2.0),
        states=np.array(["following"] * n),
        movers=np.empty((n, 0, 2)),
        mover_radii=np.empty(0),
        obstacles=(),
        plans=(),
        events=(),
        outcome="arrived",
        reason="at the goal",
        contact="",
        explored_frame=(1.0, 0.0, 0.0, 0.0),
    )
    return replace(made, **changed)


def test_fields_of_the_json():
    numbers = measure(episode([(0, 0), (3, 4)]))._asdict()
    assert list(numbers)[: len(PINNED)] == list(PINNED)
    json.dumps(numbers, allow_nan=False)


def test_length_time_and_speed():
    numbers = measure(episode([(0, 0), (3, 4), (3, 8)]))
    assert numbers.length == pytest.approx(9.0)
    assert numbers.time == pytest.approx(2.0)
    assert numbers.mean_speed == pytest.approx(4.5)
    assert numbers.turning_points == 1


def test_time_ends_with_the_first_arrived_but_length_with_rest():
    states = np.array(["following", "arrived", "arrived"])
    numbers = measure(episode([(0, 0), (1, 0), (1.1, 0)], states=states))
    assert numbers.time == pytest.approx(1.0)
    assert numbers.length == pytest.approx(1.1)


def test_time_is_whole_when_it_did_not_arrive():
    states = np.array(["following", "arrived", "arrived"])
    touched = episode([(0, 0), (1, 0), (1.1, 0)], states=states, outcome="contact")
    assert measure(touched).time == pytest.approx(2.0)


@pytest.mark.parametrize(
    ("contact", "counts"), [("", (0, 0)), ("moving", (1, 0)), ("resting", (0, 1))]
)
def test_contacts(contact: str, counts: tuple[int, int]):
    numbers = measure(episode([(0, 0), (1, 0)], contact=contact))
    assert (numbers.contacts_moving, numbers.contacts_resting) == counts


def test_smallest_clearance_is_over_what_is_finite():
    gaps = np.array([np.inf, 0.7, 0.3, np.nan])
    assert measure(episode(np.zeros((4, 2)), clearance=gaps)).min_clearance == pytest.approx(0.3)
    assert measure(episode(np.zeros((4, 2)), clearance=np.full(4, np.inf))).min_clearance is None


def test_replans_and_recoveries():
    plans = tuple(PlanRecord(t, "", np.zeros((1, 2)), NO_CELLS) for t in (0.0, 1.0, 2.0))
    events = (EventRecord(0, "state", ""), EventRecord(1, "recovery", ""))
    numbers = measure(episode([(0, 0), (1, 0)], plans=plans, events=events))
    assert (numbers.replans, numbers.recoveries) == (2, 1)
    assert measure(episode([(0, 0), (1, 0)])).replans == 0


def test_command_times():
    numbers = measure(episode(np.zeros((3, 2)), command_ms=np.array([9.0, 1.0, 2.0])))
    assert numbers.command_ms_mean == pytest.approx(4.0)
    assert numbers.command_ms_max == pytest.approx(9.0)


def test_smoothness_is_that_of_the_driven_trajectory():
    made = episode(np.column_stack([np.arange(3), np.zeros(3)]))
    twists = np.array([[1.0, 0.0], [1.0, 0.4], [1.0, -0.1]])
    numbers = measure(replace(made, trajectory=replace(made.trajectory, twists=twists)))
    assert numbers.smoothness == pytest.approx(0.9 / 2.0)
    assert numbers.angular_acceleration == pytest.approx(np.sqrt((0.4**2 + 0.5**2) / 2.0))
    assert numbers.omega_changes == pytest.approx(0.5)
    assert (numbers.circles, numbers.jerk) == (0, pytest.approx(0.0))


def passing(gap: float, **changed: Any) -> Metrics:
    """A robot at rest in (0, 0) and a disc of 0.2 m that passes at 1 m/s, ``gap`` m beside it."""
    ticks = np.arange(-10.0, 11.0)
    path = np.column_stack([ticks, np.full(len(ticks), 0.3 + 0.2 + gap)])
    still = np.zeros((len(ticks), 2))
    return measure(episode(still, movers=path[:, None], mover_radii=np.array([0.2]), **changed))


def test_nearest_is_the_gap_to_the_footprint_between_ticks_too():
    assert passing(0.1).nearest == pytest.approx(0.1)
    square = np.array([[-0.4, -0.3], [0.4, -0.3], [0.4, 0.3], [-0.4, 0.3]])
    assert passing(0.1, footprint=square).nearest == pytest.approx(0.1)
    assert passing(-0.1).nearest == passing(-0.3, footprint=square).nearest == 0.0
    # At a tick the disc is 1.5 m ahead, half a second later it has come half as near.
    path = np.array([[-0.5, 1.0], [0.5, 1.0]])
    between = episode(np.zeros((2, 2)), movers=path[:, None], mover_radii=np.array([0.2]))
    assert measure(between).nearest == pytest.approx(0.5)


def test_nearest_turns_the_footprint_with_the_robot():
    made = episode(np.zeros((2, 2)), footprint=np.array([[2, -0.1], [2, 0.1], [0, 0.1], [0, -0.1]]))
    made = replace(made, movers=np.full((2, 1, 2), [0.0, 3.0]), mover_radii=np.array([0.2]))
    assert measure(made).nearest == pytest.approx(np.hypot(0.0, 3.0 - 0.1) - 0.2)
    poses = np.array([[0.0, 0.0, np.pi / 2.0]] * 2)
    made = replace(made, trajectory=replace(made.trajectory, poses=poses))
    assert measure(made).nearest == pytest.approx(0.8)


def test_time_within_a_distance_is_a_fraction_of_all():
    numbers = passing(0.1)
    for within, found in ((0.2, numbers.within_0_2), (0.45, numbers.within_0_45)):
        reach = np.sqrt((0.5 + within) ** 2 - (0.5 + 0.1) ** 2)  # of 10 m before and behind
        assert found == pytest.approx(reach / 10.0, abs=0.006)


def test_moving_obstacles_count_while_they_are_there():
    path = np.array([[np.nan, np.nan], [5.0, 0.0], [3.0, 0.0], [np.nan, np.nan]])
    made = episode(np.zeros((4, 2)), movers=path[:, None], mover_radii=np.array([0.2]))
    numbers = measure(made)
    assert (numbers.nearest, numbers.within_0_2) == (pytest.approx(2.5), 0.0)
    gone = measure(replace(made, movers=np.full((4, 1, 2), np.nan)))
    assert gone.nearest is gone.within_0_2 is gone.within_0_45 is None
    assert measure(episode(np.zeros((4, 2)))).nearest is None


def test_a_moving_obstacle_that_jumps_is_nowhere_between():
    path = np.array([[-9.0, 0.0], [-8.0, 0.0], [8.0, 0.0], [7.0, 0.0]])
    made = episode(np.zeros((4, 2)), movers=path[:, None], mover_radii=np.array([0.2]))
    assert measure(made).nearest == pytest.approx(6.5)


def test_a_tick_that_is_told_twice_counts_once():
    path = np.array([[3.0, 0.0], [2.0, 0.0], [1.0, 0.0], [1.0, 0.0]])
    made = episode(np.zeros((4, 2)), movers=path[:, None], mover_radii=np.array([0.2]))
    times = np.array([10.0, 11.0, 12.0, 12.0])
    made = replace(made, trajectory=replace(made.trajectory, times=times))
    assert measure(made).nearest == pytest.approx(0.5)


def test_goals_count_in_order():
    line = [(0, 0), (2, 0), (4, 0)]
    goals = np.array([[2.0, 0.1], [4.0, 0.0], [9.0, 9.0]])
    assert measure(episode(line, goals=goals, outcome="timeout")).goals_reached == 2
    assert measure(episode(line, goals=goals[::-1], outcome="timeout")).goals_reached == 0
    assert measure(episode(line, goals=goals)).goals_reached == 3


def test_a_mission_without_a_tick_has_no_numbers():
    numbers = measure(episode([], outcome="blocked"))
    assert numbers.length == 0.0
    assert numbers.time is numbers.mean_speed is numbers.smoothness is None
    assert numbers.command_ms_mean is numbers.command_ms_max is numbers.min_clearance is None
    assert numbers.nearest is numbers.within_0_2 is numbers.within_0_45 is None


@given(st.lists(st.tuples(*2 * [st.floats(-100, 100)]), min_size=1, max_size=20))
def test_all_numbers_are_finite_or_none(points: list[tuple[float, float]]):
    json.dumps(measure(episode(points))._asdict(), allow_nan=False)

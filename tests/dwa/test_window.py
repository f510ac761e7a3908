import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.clearance import distance_field
from dynastar.dwa import DwaConfig, DynamicWindow, Margins, Surroundings, Wish
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import ROBOTS, slew
from naive import evaluate_window

PERIOD = 0.1
MARGINS = Margins(0.05, 0.15, 0.1)
OPEN = Surroundings(np.full((200, 200), 9.0, np.float32), 0.0, 0.0, 0.05, np.empty((0, 6)))
PATH = np.column_stack([5.0 + 0.1 * np.arange(60), np.full(60, 5.0)])
WISH = Wish((7.5, 5.0), PATH, 0.1, 99.0)
robots = st.sampled_from(sorted(ROBOTS))


def choose(robot, twist, config=DwaConfig(), around=OPEN, wish=WISH, **options):
    window = DynamicWindow(ROBOTS[robot], config, PERIOD)
    return window, window.choose(Pose2D(5.0, 5.0, 0.0), twist, around, wish, MARGINS, **options)


@given(robots, st.floats(0, 1), st.floats(-1, 1), st.booleans())
@settings(max_examples=60, deadline=None)
def test_samples_and_commands_stay_inside_the_window(name, v, omega, may_reverse):
    limits = ROBOTS[name].limits
    twist = Twist(v * limits.v_max, omega * limits.omega_max)
    window, choice = choose(name, twist, may_reverse=may_reverse)
    low = limits.v_min if may_reverse else 0.0
    n = len(choice.samples)
    speeds, rates = choice.samples.T
    ends = [
        slew(twist.v, low, limits.v_accel, limits.v_brake, window.reach),
        slew(twist.v, limits.v_max, limits.v_accel, limits.v_brake, window.reach),
    ]
    assert speeds.min() >= min(low, twist.v) - 1e-9
    assert speeds.max() <= limits.v_max + 1e-9
    for end in ends:
        assert np.isclose(speeds, end).any()
    for sign in (-1, 1):
        end = slew(
            twist.omega,
            sign * limits.omega_max,
            limits.omega_accel,
            limits.omega_brake,
            window.reach,
        )
        assert np.isclose(rates, end).any()
    for values, low_end, high_end in (
        (speeds, min(ends), max(ends)),
        (rates, rates.min(), rates.max()),
    ):
        if low_end < 0.0 < high_end:
            assert (values == 0.0).any()
    for command in window._buffers.commands[:n]:
        assert abs(command[0]) <= limits.v_max + 1e-9
        assert abs(command[1]) <= limits.omega_max + 1e-9
        rate = max(limits.v_accel, limits.v_brake)
        assert abs(command[0] - twist.v) <= rate * PERIOD + 1e-9


def test_at_rest_standing_still_is_a_sample_and_admissible():
    _, choice = choose("paper", Twist(0.0, 0.0))
    still = (choice.samples == 0.0).all(axis=1)
    assert still.any()
    assert (choice.refused[still] == 0).all()


def test_the_full_brake_is_the_last_sample():
    window, choice = choose("paper", Twist(1.0, 0.2))
    stop = max(1.0 / 0.2, 0.2 / 0.3)
    assert choice.samples[-1] == pytest.approx(np.array([1.0, 0.2]) * (1 - window.reach / stop))


def test_a_free_way_is_driven_and_its_shares_add_up():
    _, choice = choose("paper", Twist(0.5, 0.0))
    assert choice.command.v > 0.5
    assert sum(choice.shares.values()) == pytest.approx(choice.score[choice.refused == 0].max())
    assert sum(choice.refusals.values()) == (choice.refused != 0).sum()


def test_a_target_behind_is_turned_to_in_place():
    _, choice = choose("paper", Twist(0.0, 0.0), wish=WISH._replace(target=(2.0, 5.2)))
    assert choice.command.v == 0.0
    assert choice.command.omega > 0.0


def test_samples_by_resolution_as_printed():
    config = DwaConfig(reach=0.0, v_resolution=0.01, omega_resolution=math.radians(1.0))
    window, choice = choose("paper", Twist(0.5, 0.0), config)
    speeds, rates = (np.unique(column) for column in choice.samples[:-1].T)
    assert np.diff(speeds).max() <= 0.01 + 1e-9
    assert np.diff(rates).max() <= math.radians(1.0) + 1e-9
    assert window.reach == PERIOD


@pytest.mark.parametrize("normalisation", ["sum", "range", "window"])
@pytest.mark.parametrize("of_path", [False, True])
@pytest.mark.parametrize("dist", ["smallest", "end"])
@pytest.mark.parametrize("seed", range(6))
def test_the_choice_is_that_of_a_plain_evaluation(normalisation, of_path, dist, seed):
    rng = np.random.default_rng(seed)
    closed = rng.random((200, 200)) < (0.002, 0.0003)[seed % 2]
    closed[85:115, 85:115] = False
    movers = np.array([[7.0, 5.5, -0.3, 0.0, 0.3, 0.3]])[: seed < 2]  # else what stands decides
    around = OPEN._replace(field=distance_field(closed, 0.05), movers=movers)
    config = DwaConfig(
        normalisation=normalisation,
        dist=dist,
        v_samples=7,
        omega_samples=9,
        clearance_of_path=of_path,
    )
    twist = Twist(0.4, 0.1)
    window, choice = choose("paper", twist, config, around)
    best, refused, terms = evaluate_window(
        ROBOTS["paper"],
        config,
        window.reach,
        choice.samples,
        Pose2D(5.0, 5.0, 0.0),
        twist,
        around,
        WISH,
        MARGINS,
    )
    free = (choice.refused == 0) | (refused == 0)
    assert ((choice.refused != 0) >= (refused != 0)).all()  # certified stops refuse more
    np.testing.assert_allclose(
        choice.terms[free & (choice.refused == 0)], terms[free & (choice.refused == 0)], atol=1e-6
    )
    if (choice.refused == refused).all():
        assert choice.sample == pytest.approx(tuple(choice.samples[best]))

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.perception import MovingObstacle, PredictionConfig
from dynastar.perception.prediction import DISCOUNTED, WEIGHTS, Times, contact_probability, predict

CONFIG = PredictionConfig()
CONTINUES, STOPS, TURNS_BACK = range(3)


def positions(moving, m, hypothesis):
    """Where an obstacle is expected under a hypothesis, (steps, 2)."""
    obstacle = moving.obstacles[m]
    velocity = np.array([obstacle["vx"], obstacle["vy"]])
    return (obstacle["x"], obstacle["y"]) + moving.travel[hypothesis][:, None] * velocity


@given(*[st.floats(-2, 2)] * 4, st.floats(0, 0.5), st.sampled_from([0.05, 0.1]))
@settings(deadline=None)
def test_an_obstacle_that_continues_or_turns_back_keeps_its_speed(x, y, vx, vy, begin, step):
    moving = predict([MovingObstacle(x, y, vx, vy, 0.3)], CONFIG, Times(begin, step, 30))
    times = begin + step * np.arange(1, 31)
    for hypothesis, sign in ((CONTINUES, 1.0), (TURNS_BACK, -1.0)):
        expected = np.column_stack([x + sign * vx * times, y + sign * vy * times])
        np.testing.assert_allclose(positions(moving, 0, hypothesis), expected, atol=1e-9)


def test_an_obstacle_that_stops_comes_to_rest_half_a_second_of_way_ahead():
    moving = predict([MovingObstacle(0.0, 0.0, 1.2, -0.6, 0.3)], CONFIG, Times(0.0, 0.1, 60))
    stops = positions(moving, 0, STOPS)
    assert stops[-1] == pytest.approx((0.6, -0.3), abs=1e-3)
    speeds = np.hypot(*np.diff(stops, axis=0).T) / 0.1
    assert (np.diff(speeds) < 0.0).all()
    assert speeds[0] < math.hypot(1.2, 0.6)
    assert np.hypot(*stops[0]) / 0.1 == pytest.approx(math.hypot(1.2, 0.6), rel=0.15)


def test_the_deviation_grows_to_a_limit_and_the_weights_add_up():
    moving = predict([MovingObstacle(0.0, 0.0, 1.0, 0.0, 0.3)], CONFIG, Times(0.2, 0.1, 30))
    ahead = 0.2 + 0.1 * np.arange(1, 31)
    [deviation] = moving.deviation
    assert deviation == pytest.approx(CONFIG.error + CONFIG.spread * (1.0 - np.exp(-ahead)))
    assert WEIGHTS.sum() == pytest.approx(1.0)
    assert len(moving.travel) == len(WEIGHTS)


@pytest.mark.parametrize(("speed", "share"), [(0.0, 0.0), (0.06, 0.5), (0.12, 1.0), (2.0, 1.0)])
def test_the_deviation_of_an_obstacle_at_rest_does_not_grow(speed, share):
    moving = predict([MovingObstacle(0.0, 0.0, 0.0, -speed, 0.3)], CONFIG, Times(0.0, 0.1, 30))
    most = CONFIG.spread * (1.0 - math.exp(-3.0))
    assert moving.deviation[0, -1] == pytest.approx(CONFIG.error + share * most)


@pytest.mark.parametrize("discounted", [DISCOUNTED, 5.0])
def test_risk_is_discounted_from_when_a_command_acts(discounted):
    moving = predict([], CONFIG, Times(0.5, 0.1, 20, discounted))
    assert moving.discount == pytest.approx(np.exp(-0.1 * np.arange(1, 21) / discounted))


def test_the_hard_bound_is_that_of_the_settings():
    moving = predict([], CONFIG._replace(acceleration=2.5), Times(0.0, 0.1, 10))
    assert moving.acceleration == 2.5


def test_without_moving_obstacles_a_prediction_is_empty():
    moving = predict([], CONFIG, Times(0.0, 0.1, 10))
    assert moving.obstacles.shape == (0,)
    assert moving.obstacles.dtype.names == ("x", "y", "vx", "vy", "radius")
    assert moving.travel.shape == (3, 10)


def test_tracks_are_taken_as_they_are():
    tracks = [MovingObstacle(1.0, 2.0, 0.3, 0.4, 0.25), MovingObstacle(5.0, 6.0, 0.0, 0.0, 0.5)]
    moving = predict(tracks, CONFIG, Times(0.0, 0.1, 10))
    assert moving.obstacles.tolist() == [tuple(track) for track in tracks]


@given(st.floats(-1, 1), st.floats(0.05, 1.0))
@settings(deadline=None)
def test_the_probability_of_a_contact_is_nearly_the_normal_tail(gap, deviation):
    tail = 0.5 * math.erfc(gap / deviation / math.sqrt(2.0))
    assert contact_probability(gap, deviation) == pytest.approx(tail, abs=0.01)

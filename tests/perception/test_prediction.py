import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.perception import MovingObstacle, PredictionConfig
from dynastar.perception.prediction import SPEEDS, WEIGHTS, predict

CONFIG = PredictionConfig()


@given(*[st.floats(-2, 2)] * 4, st.floats(0, 0.5), st.sampled_from([0.05, 0.1]))
@settings(deadline=None)
def test_who_goes_on_and_who_turns_back_keeps_its_speed(x, y, vx, vy, begin, step):
    people = predict([MovingObstacle(x, y, vx, vy, 0.3)], CONFIG, begin, step, 30)
    times = begin + step * np.arange(1, 31)
    for hypothesis, sign in ((0, 1.0), (2, -1.0)):
        assert SPEEDS[hypothesis] == sign
        expected = np.column_stack([x + sign * vx * times, y + sign * vy * times])
        np.testing.assert_allclose(people.mean[0, hypothesis], expected, atol=1e-9)


def test_who_stops_comes_to_rest_half_a_second_of_way_ahead():
    people = predict([MovingObstacle(0.0, 0.0, 1.2, -0.6, 0.3)], CONFIG, 0.0, 0.1, 60)
    stops = people.mean[0, 1]
    assert stops[-1] == pytest.approx((0.6, -0.3), abs=1e-3)
    speeds = np.hypot(*np.diff(stops, axis=0).T) / 0.1
    assert (np.diff(speeds) < 0.0).all()
    assert speeds[0] < math.hypot(1.2, 0.6)


def test_the_spread_grows_with_time_and_the_weights_add_up():
    people = predict([MovingObstacle(0.0, 0.0, 1.0, 0.0, 0.3)], CONFIG, 0.2, 0.1, 10)
    assert people.spread == pytest.approx(
        CONFIG.error + CONFIG.spread * (0.2 + 0.1 * np.arange(1, 11))
    )
    assert WEIGHTS.sum() == pytest.approx(1.0)
    assert (people.acceleration, people.memory) == (CONFIG.acceleration, CONFIG.memory)


def test_nobody_is_predicted_as_nobody():
    people = predict([], CONFIG, 0.0, 0.1, 10)
    assert people.now.shape == (0, 6)
    assert people.mean.shape == (0, 3, 10, 2)


def test_tracks_are_taken_as_they_are():
    movers = [MovingObstacle(1.0, 2.0, 0.3, 0.4, 0.25), MovingObstacle(5.0, 6.0, 0.0, 0.0, 0.5)]
    people = predict(movers, CONFIG, 0.0, 0.1, 10)
    assert people.now[:, :5].tolist() == [list(m) for m in movers]
    assert (people.now[:, 5] >= 0.0).all()

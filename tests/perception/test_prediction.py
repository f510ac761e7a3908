import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.clearance import DistanceField, lower_bounds
from dynastar.perception import MovingObstacle, PredictionConfig
from dynastar.perception.prediction import SPEEDS, WEIGHTS, clearance_at, predict

CONFIG = PredictionConfig()


@given(*[st.floats(-2, 2)] * 4, st.floats(0, 0.5), st.sampled_from([0.05, 0.1]))
@settings(deadline=None)
def test_who_goes_on_and_who_turns_back_keeps_its_speed(x, y, vx, vy, begin, step):
    people = predict([MovingObstacle(x, y, vx, vy, 0.3)], CONFIG, (begin, step, 30))
    times = begin + step * np.arange(1, 31)
    for hypothesis, sign in ((0, 1.0), (2, -1.0)):
        assert SPEEDS[hypothesis] == sign
        expected = np.column_stack([x + sign * vx * times, y + sign * vy * times])
        np.testing.assert_allclose(people.mean[0, hypothesis], expected, atol=1e-9)


def test_who_stops_comes_to_rest_half_a_second_of_way_ahead():
    people = predict([MovingObstacle(0.0, 0.0, 1.2, -0.6, 0.3)], CONFIG, (0.0, 0.1, 60))
    stops = people.mean[0, 1]
    assert stops[-1] == pytest.approx((0.6, -0.3), abs=1e-3)
    speeds = np.hypot(*np.diff(stops, axis=0).T) / 0.1
    assert (np.diff(speeds) < 0.0).all()
    assert speeds[0] < math.hypot(1.2, 0.6)


def test_the_spread_grows_to_a_limit_and_the_weights_add_up():
    people = predict([MovingObstacle(0.0, 0.0, 1.0, 0.0, 0.3)], CONFIG, (0.2, 0.1, 10))
    assert people.spread == pytest.approx(
        CONFIG.error + CONFIG.spread * (1.0 - np.exp(-0.2 - 0.1 * np.arange(1, 11)))
    )
    assert WEIGHTS.sum() == pytest.approx(1.0)
    assert (people.acceleration, people.memory) == (CONFIG.acceleration, CONFIG.memory)


def test_nobody_is_predicted_as_nobody():
    people = predict([], CONFIG, (0.0, 0.1, 10))
    assert people.now.shape == (0, 6)
    assert people.mean.shape == (0, 3, 10, 2)


def test_tracks_are_taken_as_they_are():
    movers = [MovingObstacle(1.0, 2.0, 0.3, 0.4, 0.25), MovingObstacle(5.0, 6.0, 0.0, 0.0, 0.5)]
    people = predict(movers, CONFIG, (0.0, 0.1, 10))
    assert people.now[:, :5].tolist() == [list(m) for m in movers]
    assert (people.now[:, 5] >= 0.0).all()


CELL = 0.05


def walls_of(*boxes, side=8.0):
    """Distances to boxes (x0, y0, x1, y1), metres."""
    free = np.ones((round(side / CELL),) * 2, np.uint8)
    for box in boxes:
        x0, y0, x1, y1 = (round(metres / CELL) for metres in box)
        free[y0:y1, x0:x1] = 0
    return DistanceField(lower_bounds(free, CELL), 0.0, 0.0, CELL)


def test_a_wall_that_is_met_head_on_turns_a_walker_back():
    walls = walls_of((5.0, 0.0, 5.2, 8.0))
    people = predict([MovingObstacle(3.0, 4.0, 1.0, 0.0, 0.3)], CONFIG, (0.0, 0.1, 40), walls)
    continues = people.mean[0, 0]
    turn = int(np.argmax(continues[:, 0]))
    assert continues[turn, 0] == pytest.approx(4.7, abs=0.15)
    assert continues[:, 1] == pytest.approx(4.0, abs=0.02)
    assert continues[-1, 0] == pytest.approx(continues[turn, 0] - 0.1 * (39 - turn), abs=0.15)


def test_a_walker_beside_a_wall_and_away_from_it_is_not_turned():
    walls = walls_of((0.0, 3.0, 8.0, 3.2))
    for vy in (0.0, 0.3):
        mover = MovingObstacle(2.0, 3.4, 0.8, vy, 0.3)  # 0.2 m from the wall, less than its radius
        people = predict([mover], CONFIG, (0.0, 0.1, 30), walls)
        times = 0.1 * np.arange(1, 31)
        expected = np.column_stack([2.0 + 0.8 * times, 3.4 + vy * times])
        np.testing.assert_allclose(people.mean[0, 0], expected, atol=0.02)


@given(
    *[st.floats(1.0, 7.0)] * 2, *[st.floats(-1.5, 1.5)] * 2, st.floats(0.2, 0.5),
    st.lists(st.tuples(st.floats(0.5, 6.5), st.floats(0.5, 6.5)), min_size=1, max_size=6),
)  # fmt: skip
@settings(deadline=None)
def test_nobody_is_predicted_inside_an_obstacle(x, y, vx, vy, radius, corners):
    """No nearer than at the start, or than its radius; never faster than the track."""
    walls = walls_of(*((a, b, a + 0.6, b + 0.6) for a, b in corners))
    people = predict([MovingObstacle(x, y, vx, vy, radius)], CONFIG, (0.0, 0.1, 40), walls)
    allowed = min(radius, clearance_at(walls, x, y)) - 1e-6
    for mean in people.mean[0]:
        assert min(clearance_at(walls, *point) for point in mean) >= allowed
        steps = np.diff(np.vstack([[x, y], mean]), axis=0)
        assert np.hypot(*steps.T).max() <= 0.1 * math.hypot(vx, vy) + 1e-9

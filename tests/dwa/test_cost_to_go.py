import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa import CostToGo, marching
from dynastar.dwa import cost_to_go as c
from dynastar.perception import MovingObstacle, PredictionConfig
from dynastar.perception.prediction import predict

A = 0.1
FRAME = (A, 0.0, 0.0)


def march(cost, row, column):
    value = np.empty(cost.shape)
    seed = (row, column, 0.0)
    marching.march(cost, A, seed, (row, column), 1e3, value, marching.queue_for(cost.size))
    return value


def ahead_of(value, filled=None):
    filled = value if filled is None else filled
    slope = np.empty((*value.shape, 2))
    c.descend(value, filled, slope)
    return CostToGo(value, filled, slope, 0.0, 0.0, A)


@given(st.integers(0, 10**6))
@settings(max_examples=30, deadline=None)
def test_the_cost_of_a_metre_rises_towards_obstacles(seed):
    distance = np.random.default_rng(seed).uniform(0.0, 1.2, (20, 24)).astype(np.float32)
    cost = np.empty((10, 12))
    c.travel_cost(distance, 2, 0.35, 0.25, cost)
    clear = distance.reshape(10, 2, 12, 2).max(axis=(1, 3)).astype(float) - 0.35
    expected = 1.0 + c.NEAR_COST * np.maximum(0.0, 1.0 - clear / 0.25) ** 2
    np.testing.assert_allclose(cost, np.where(clear < 0.0, np.inf, expected), rtol=1e-6)


def test_the_middle_of_a_corridor_is_what_descends():
    y = (np.arange(40) + 0.5) * 0.05
    distance = np.tile(np.minimum(y, 2.0 - y)[:, None], (1, 160)).astype(np.float32)
    cost = np.empty((20, 80))
    c.travel_cost(distance, 2, 0.3, 0.6, cost)
    value = march(cost, 10, 78)
    line = np.empty((90, 2))
    n = c.trace(ahead_of(value), 0.5, 0.5, line)
    assert n > 60
    assert line[n - 1, 0] > 7.3
    assert abs(line[20:50, 1] - 1.0).max() < 0.15


def test_between_cells_values_are_interpolated_and_fall_along_the_descent():
    rows, columns = np.mgrid[:30, :30]
    plane = 0.6 * (columns + 0.5) * A - 0.8 * (rows + 0.5) * A + 5.0
    ahead = ahead_of(plane)
    for x, y in np.random.default_rng(1).uniform(0.2, 2.8, (20, 2)):
        assert c.value_at(ahead, x, y) == pytest.approx(0.6 * x - 0.8 * y + 5.0)
        assert c.direction_at(ahead, x, y) == pytest.approx((-0.6, 0.8))


def test_beside_walls_the_descent_leads_along_the_way_and_not_off_them():
    cost = np.full((30, 30), np.inf)
    cost[10:12, 3:27] = 1.0  # a corridor of two cells
    value = march(cost, 10, 25)
    filled = np.empty_like(value)
    marching.extend(value, A, filled)
    ahead = ahead_of(value, filled)
    for x in np.arange(0.45, 2.3, 0.13):
        for y in (1.05, 1.1, 1.15):
            ux, uy = c.direction_at(ahead, x, y)
            assert ux > 0.85
            assert abs(uy) < 0.5
    assert tuple(ahead.slope[10, 25]) == (0.0, 0.0)  # nothing is lower


def test_a_line_that_was_followed_is_favoured_once():
    cost = np.ones((20, 20))
    cost[5, 5] = np.inf
    line = np.array([(0.55, 0.55), (0.56, 0.55), (1.05, 0.55), (-3.0, 9.0)])
    c.favour(cost, FRAME, line, 0.85)
    assert sorted(set(cost.ravel())) == [0.85, 1.0, np.inf]
    assert (cost[4:7, 4:7] != 1.0).all()
    assert (cost[8:] == 1.0).all()


def test_a_mover_costs_where_and_when_it_is_met():
    """It crosses ahead; the robot is there when it is at (3.05, 2), not when it was further down."""
    people = predict([MovingObstacle(3.05, 0.5, 0.0, 0.5, 0.3)], PredictionConfig(), (0.0, 0.1, 40))
    cost = np.ones((40, 60))
    c.add_moving(cost, FRAME, people, (0.0, 0.1), (0.05, 2.0), 0.3, 1.0)
    discount = math.exp(-3.0 / people.memory)
    assert cost[20, 30] > 1.0 + 0.5 * 0.7 * discount * c.MEETING_COST
    assert cost[20, 30] < 1.0 + 1.1 * discount * c.MEETING_COST
    assert cost[20, 10] == 1.0  # before it comes
    assert cost.max() <= 1.0 + c.MEETING_COST + 1e-9
    nobody = np.ones((40, 60))
    alone = predict([], PredictionConfig(), (0.0, 0.1, 40))
    c.add_moving(nobody, FRAME, alone, (0.0, 0.1), (0.05, 2.0), 0.3, 1.0)
    assert (nobody == 1.0).all()


@given(st.integers(0, 10**6))
@settings(max_examples=20, deadline=None)
def test_every_cell_costs_what_meeting_everybody_there_on_arrival_does(seed):
    random = np.random.default_rng(seed)
    movers = [
        MovingObstacle(*random.uniform(-1.0, 4.0, 2), *random.normal(0.0, 0.8, 2), 0.25)
        for _ in range(4)
    ]
    people = predict(movers, PredictionConfig(), (0.05, 0.1, 30))
    robot, speed = (1.5, 1.0), 0.9
    cost = np.ones((20, 30))
    c.add_moving(cost, FRAME, people, (0.05, 0.1), robot, 0.3, speed)
    times = 0.05 + 0.1 * np.arange(1, 31)
    for row, column in np.ndindex(cost.shape):
        cell = np.array([column + 0.5, row + 0.5]) * A
        arrives = math.dist(cell, robot) / speed
        k = int(np.argmin(abs(times - arrives)))
        expected = 1.0
        if abs(times[k] - arrives) <= 0.05:
            gaps = np.hypot(*(people.mean[:, :, k] - cell).T).T - 0.3 - people.now[:, 4:5]
            sure = 1.0 / (1.0 + np.exp(1.702 * gaps / people.spread[k]))
            sure[gaps >= 2.0 * people.spread[k]] = 0.0
            discount = math.exp(-times[k] / people.memory)
            expected += discount * c.MEETING_COST * (sure * people.weights).sum()
        assert cost[row, column] == pytest.approx(expected)

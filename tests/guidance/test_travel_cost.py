import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.field import Field
from dynastar.guidance.travel_cost import (
    ENCOUNTER_COST,
    NEAR_COST,
    Encounter,
    add_encounters,
    travel_cost,
)
from dynastar.perception import MovingObstacle, PredictionConfig
from dynastar.perception.prediction import DISCOUNTED, WEIGHTS, Times, predict

A = 0.1
CONFIG = PredictionConfig()


def cost_of(rows, columns):
    return Field(np.ones((rows, columns)), 0.0, 0.0, A)


@given(st.integers(0, 10**6))
@settings(max_examples=30, deadline=None)
def test_the_cost_of_a_metre_rises_towards_obstacles(seed):
    distance = np.random.default_rng(seed).uniform(0.0, 1.2, (20, 24)).astype(np.float32)
    cost = travel_cost(distance, 2, 0.35, 0.25)
    clear = distance.reshape(10, 2, 12, 2).max(axis=(1, 3)).astype(float) - 0.35
    expected = 1.0 + NEAR_COST * np.maximum(0.0, 1.0 - clear / 0.25) ** 2
    np.testing.assert_allclose(cost, np.where(clear < 0.0, np.inf, expected), rtol=1e-6)


def test_a_moving_obstacle_costs_where_and_when_the_robot_meets_it():
    """It crosses ahead; the robot arrives when it is at (3.05, 2), not when it was before that."""
    moving = predict([MovingObstacle(3.05, 0.5, 0.0, 0.5, 0.3)], CONFIG, Times(0.0, 0.1, 40))
    encounter, cost = Encounter(0.05, 2.0, 1.0, 0.3, 0.1), cost_of(40, 60)
    add_encounters(cost, moving, encounter)
    at_most = math.exp(-3.0 / DISCOUNTED) * ENCOUNTER_COST
    assert cost.values[20, 30] > 1.0 + 0.5 * 0.7 * at_most
    assert cost.values[20, 30] < 1.0 + 1.1 * at_most
    assert cost.values[20, 10] == 1.0  # the robot passes there before it comes
    assert cost.values.max() <= 1.0 + ENCOUNTER_COST + 1e-9
    alone = cost_of(40, 60)
    add_encounters(alone, predict([], CONFIG, Times(0.0, 0.1, 40)), encounter)
    assert (alone.values == 1.0).all()


@given(st.integers(0, 10**6))
@settings(max_examples=20, deadline=None)
def test_every_cell_costs_what_all_encounters_on_arrival_do(seed):
    random = np.random.default_rng(seed)
    obstacles = [
        MovingObstacle(*random.uniform(-1.0, 4.0, 2), *random.normal(0.0, 0.8, 2), 0.25)
        for _ in range(4)
    ]
    latency, step, steps = random.choice([0.0, 0.05, 0.3]), 0.1, 30
    moving = predict(obstacles, CONFIG, Times(latency, step, steps))
    place, speed, cost = (1.5, 1.0), 0.9, cost_of(20, 30)
    add_encounters(cost, moving, Encounter(*place, speed, 0.3, step))
    times = latency + step * np.arange(1, steps + 1)
    for row, column in np.ndindex(cost.values.shape):
        cell = np.array([column + 0.5, row + 0.5]) * A
        arrives = (
            latency + math.dist(cell, place) / speed
        )  # the robot is at the place once a command acts
        k, expected = int(np.argmin(abs(times - arrives))), 1.0
        if abs(times[k] - arrives) <= 0.05:
            for (x, y, vx, vy, radius), deviations in zip(obstacles, moving.deviation, strict=True):
                mean = np.array([x, y]) + moving.travel[:, k, None] * np.array([vx, vy])
                gaps = np.hypot(*(mean - cell).T) - 0.3 - radius
                p = 1.0 / (1.0 + np.exp(1.702 * gaps / deviations[k]))
                p[gaps >= 2.0 * deviations[k]] = 0.0
                discounted = math.exp(-(k + 1) * step / DISCOUNTED) * (p * WEIGHTS).sum()
                expected += ENCOUNTER_COST * discounted
        assert cost.values[row, column] == pytest.approx(expected)

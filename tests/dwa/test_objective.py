import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa import objective as o
from dynastar.perception import MovingObstacle, PredictionConfig
from dynastar.perception.prediction import WEIGHTS, predict

CONFIG = PredictionConfig()


def test_the_terms_are_scaled_to_one():
    assert o.progress(1.0, 2.0) == 0.5
    assert o.progress(-3.0, 2.0) == -1.0
    assert (o.dist(0.1, 0.4), o.dist(9.0, 0.4), o.dist(-0.2, 0.4)) == pytest.approx(
        (0.25, 1.0, -0.5)
    )
    assert o.vel(0.5, 2.0) == 0.25
    assert (o.simi(0.0, 0.5), o.simi(0.25, 0.5), o.simi(2.0, 0.5)) == (1.0, 0.5, 0.0)


@given(st.floats(0.1, 50), st.floats(0.01, 50), st.floats(0.1, 10))
@settings(deadline=None)
def test_more_progress_always_scores_more(gained, more, scale):
    assert o.progress(gained + more, scale) > o.progress(gained, scale)


@given(
    st.lists(st.floats(0, 10), min_size=5, max_size=5),
    st.lists(st.floats(-1, 1), min_size=5, max_size=5),
)
@settings(deadline=None)
def test_the_objective_is_the_weighted_sum_less_the_risk(weights, terms):
    signs = (1, 1, 1, 1, -1)
    expected = sum(s * w * t for s, w, t in zip(signs, weights, terms, strict=True))
    assert o.objective(tuple(weights), np.array(terms)) == pytest.approx(expected, abs=1e-9)


@given(st.floats(-1, 1), st.floats(0.05, 1.0))
@settings(deadline=None)
def test_the_probability_of_a_contact_is_nearly_the_normal_tail(gap, spread):
    tail = 0.5 * math.erfc(gap / spread / math.sqrt(2.0))
    assert o.contact_probability(gap, spread) == pytest.approx(tail, abs=0.01)


@given(st.integers(0, 10**6))
@settings(max_examples=50, deadline=None)
def test_risk_is_the_worst_discounted_probability_of_each_hypothesis(seed):
    random = np.random.default_rng(seed)
    movers = [
        MovingObstacle(
            *random.uniform(-2, 2, 2), *random.uniform(-1, 1, 2), random.uniform(0.2, 0.5)
        )
        for _ in range(3)
    ]
    people = predict(movers, CONFIG, (0.2, 0.1, 30))
    worst = np.zeros((3, 3))
    track = np.column_stack([np.linspace(-2, 2, 30), random.uniform(-0.3, 0.3, 30)])
    for k, (x, y) in enumerate(track):
        o.note_risk(people, k, 0.1 * (k + 1), x, y, 0.3, worst)
    expected = 0.0
    for m, mover in enumerate(movers):
        for h, weight in enumerate(WEIGHTS):
            gaps = np.hypot(*(people.mean[m, h] - track).T) - 0.3 - mover.radius
            t = 0.1 * np.arange(1, 31)
            p = np.exp(-t / CONFIG.memory) / (1.0 + np.exp(1.702 * gaps / people.spread))
            expected += weight * p.max()
    assert o.risk(people, worst) == pytest.approx(expected, abs=0.03)  # a tail is cut off
    assert o.risk(people, np.zeros((3, 3))) == 0.0

"""Every term of Eq. 9 against a slow version in numpy, on random rows of a roll-out."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa import DwaConfig, Weights
from dynastar.dwa import terms as t
from dynastar.dwa.motion import state_at
from dynastar.dwa.rollout import ROW
from dynastar.dwa.scene import FOLLOW, Manoeuvre
from dynastar.footprint import Footprint
from dynastar.guidance.cost_to_go import turn_to_descent, value_at
from dynastar.perception import MovingObstacle, PredictionConfig
from dynastar.perception.prediction import DISCOUNTED, WEIGHTS, Times, predict
from dynastar.perception.tracking_kernels import REST_SPEED
from dynastar.robot import ROBOTS, Limits, Robot, slew
from scenes import STEP, STEPS, boxed, empty, field_of, rules_for, scene_of, start_of

LIMITS = Limits(1.0, 1.5, 0.8, 2.0, 0.8, 2.0, v_min=-0.3)
RULES = rules_for(Robot("box", LIMITS, ROBOTS["jackal"].footprint))
SCHEDULE = RULES.schedule
SCENE = scene_of(boxed((3.5, 2.5, 3.7, 5.5)), goal=(6.0, 4.0))
MANOEUVRE = Manoeuvre(0.6, 0.2, 0.5, FOLLOW)
seeds = st.integers(0, 10**6)


def random_rows(random):
    """Rows with any poses, of which the last few may be off the map."""
    rows = np.zeros(len(SCHEDULE.step), ROW)
    rows["x"], rows["y"] = random.uniform(0.5, 7.5, (2, len(rows)))
    theta = random.uniform(-4.0, 4.0, len(rows))
    rows["cos"], rows["sin"] = np.cos(theta), np.sin(theta)
    rows["v"] = random.uniform(LIMITS.v_min, LIMITS.v_max, len(rows))
    rows["gap"] = random.uniform(-0.1, 0.5, len(rows))
    rows["on_map"] = np.arange(len(rows)) < random.integers(1, 2 * len(rows))
    return rows


def random_start(random):
    v = random.uniform(LIMITS.v_min, LIMITS.v_max)
    state = state_at(*random.uniform(1.0, 7.0, 2), 0.3, v, 0.1)
    return start_of(RULES, state, random.uniform(-0.1, 0.5), random.uniform(0.0, 8.0))


def random_obstacles(random, count=3):
    return [
        MovingObstacle(
            *random.uniform(0.5, 7.5, 2), *random.uniform(-1.2, 1.2, 2), random.uniform(0.2, 0.5)
        )
        for _ in range(count)
    ]


# -- progress -------------------------------------------------------------------------------------


def slow_value(row):
    """The cost-to-go of a row by its definition."""
    left = value_at(SCENE.cost_to_go, row.x, row.y)
    off = abs(turn_to_descent(SCENE.cost_to_go, row, 0.0))
    radius = LIMITS.v_max / LIMITS.omega_max
    curve = radius * off - radius * math.sin(off)
    turn = curve if curve < left else 2.0 * left - left**2 / max(curve, 1e-12)
    return left + turn + max(0.0, row.v**2 / (2.0 * LIMITS.v_brake) - left - 0.25)


@given(seeds)
@settings(deadline=None)
def test_the_cost_to_go_of_a_state_counts_its_curve_and_its_overshooting(seed):
    for row in random_rows(np.random.default_rng(seed)).view(np.recarray)[:5]:
        found = t.state_value(SCENE.cost_to_go, LIMITS, row, row.v)
        assert found == pytest.approx(slow_value(row), abs=1e-9)
        assert found >= value_at(SCENE.cost_to_go, row.x, row.y)


@given(seeds)
@settings(deadline=None)
def test_progress_is_the_mean_decrease_of_the_cost_to_go_over_what_is_possible(seed):
    random = np.random.default_rng(seed)
    rows, start = random_rows(random), random_start(random)
    values, fell = [start.cost_to_go], 0.0
    for row in rows.view(np.recarray)[SCHEDULE.lookups]:
        if row.on_map:
            fell = values[-1] - slow_value(row)
        values.append(values[-1] - fell)
    mean = start.cost_to_go - np.mean(values[1:])
    expected = max(mean / start.most, -1.0)
    found = t.progress(SCENE.cost_to_go, RULES, start, rows)
    assert found == pytest.approx(expected, abs=1e-9)


@given(seeds, st.floats(0.01, 50.0))
@settings(deadline=None)
def test_more_progress_always_scores_more(seed, more):
    """There is no upper bound, only a lower one."""
    random = np.random.default_rng(seed)
    rows, start = random_rows(random), random_start(random)
    rows["on_map"] = True
    found = t.progress(SCENE.cost_to_go, RULES, start, rows)
    farther = start._replace(cost_to_go=start.cost_to_go + more)
    beyond = t.progress(SCENE.cost_to_go, RULES, farther, rows)
    if found > -1.0:
        assert beyond == pytest.approx(found + more / start.most)
    assert beyond > -1.0 if found > -1.0 else beyond >= -1.0
    far = start._replace(cost_to_go=100.0)
    assert t.progress(SCENE.cost_to_go, RULES, far, rows) > 5.0


def slow_farthest(v, duration, parts=2000):
    """Metres of a ramp to the highest speed, step by step."""
    h, total = duration / parts, 0.0
    for _ in range(parts):
        after = slew(v, LIMITS.v_max, LIMITS.v_accel, LIMITS.v_brake, h)
        total += 0.5 * (v + after) * h
        v = after
    return total


@given(st.floats(0.0, 1.0), st.floats(0.0, 10.0))
@settings(deadline=None, max_examples=10)
def test_the_most_progress_is_that_of_full_acceleration_on_free_ground(v, cost_to_go):
    times = 0.1 * SCHEDULE.step[-1] / t.LOOKUPS * np.arange(1, t.LOOKUPS + 1)
    driven = [slow_farthest(v, float(time)) for time in times]
    expected = max(np.minimum(driven, cost_to_go).mean(), 0.1)
    assert t.most_progress(RULES, v, cost_to_go) == pytest.approx(expected, abs=1e-3)
    assert t.most_progress(RULES, -0.3, 5.0) == t.most_progress(RULES, 0.0, 5.0)


# -- dist, vel, simi ------------------------------------------------------------------------------


@given(seeds)
@settings(deadline=None)
def test_dist_is_the_least_clearance_while_held_over_comfort(seed):
    random = np.random.default_rng(seed)
    rows, start = random_rows(random), random_start(random)
    gaps = [start.gap, *rows["gap"][: SCHEDULE.held]]
    expected = min(1.0, min(gaps) / RULES.config.comfort)
    assert t.dist(RULES, start, rows) == pytest.approx(expected)


def test_vel_is_the_held_speed_over_the_highest():
    assert t.vel(RULES, MANOEUVRE) == pytest.approx(0.6)
    assert t.vel(RULES, MANOEUVRE._replace(v=LIMITS.v_min)) == pytest.approx(-0.3)


@given(seeds)
@settings(deadline=None)
def test_simi_is_one_less_the_mean_distance_from_the_path(seed):
    rows = random_rows(np.random.default_rng(seed))
    off_path = np.ones((160, 160), bool)
    off_path[100] = False  # a path along y = 5.025 m
    found = t.simi(field_of(~off_path), RULES, rows)
    distances = np.minimum(np.abs(rows["y"][SCHEDULE.lookups] - 5.025), 1.0)
    assert found == pytest.approx(1.0 - distances.mean(), abs=0.03)
    assert 0.0 <= found <= 1.0


@pytest.mark.parametrize(
    ("setting", "given_path", "weight"), [(0.0, 0.0, 0.0), (0.5, 0.0, 0.5), (0.5, 3.0, 3.0)]
)
def test_sigma_is_at_least_the_weight_of_a_path_given_by_the_user(setting, given_path, weight):
    rules = RULES._replace(config=DwaConfig(Weights(simi=setting)))
    scene = SCENE._replace(path_weight=given_path)
    assert t.sigma(scene, rules) == weight
    rows, start = random_rows(np.random.default_rng(1)), random_start(np.random.default_rng(2))
    terms = t.evaluate(scene, rules, start, MANOEUVRE, rows)
    expected = t.simi(scene.distance_to_path, rules, rows) if weight > 0.0 else 1.0
    assert terms.simi == expected


# -- moving obstacles -----------------------------------------------------------------------------


@given(seeds)
@settings(max_examples=50, deadline=None)
def test_risk_is_the_worst_discounted_probability_of_each_hypothesis(seed):
    random = np.random.default_rng(seed)
    obstacles, rows = random_obstacles(random), random_rows(random)
    config, latency = PredictionConfig(), 0.2
    moving = predict(obstacles, config, Times(latency, STEP, STEPS))
    places = np.column_stack([rows["x"], rows["y"]])
    after = STEP * SCHEDULE.step
    ahead = latency + after
    travels = ahead, (1.0 - np.exp(-2.0 * ahead)) / 2.0, -ahead  # continue, stop, turn back
    expected = 0.0
    for x, y, vx, vy, radius in obstacles:
        spread = config.spread * min(math.hypot(vx, vy) / REST_SPEED, 1.0)
        deviation = config.error + spread * (1.0 - np.exp(-ahead))
        for weight, travel in zip(WEIGHTS, travels, strict=True):
            mean = np.array([x, y]) + travel[:, None] * np.array([vx, vy])
            gaps = np.hypot(*(mean - places).T) - RULES.risk_radius - radius
            p = np.exp(-after / DISCOUNTED) / (1.0 + np.exp(1.702 * gaps / deviation))
            expected += weight * np.where(gaps < 3.0 * deviation, p, 0.0).max()
    assert t.risk(moving, RULES, rows) == pytest.approx(expected, abs=1e-9)
    assert t.risk(predict([], config, Times(0.0, STEP, STEPS)), RULES, rows) == 0.0


@given(seeds, st.floats(0.0, 6.0))
@settings(max_examples=100, deadline=None)
def test_a_manoeuvre_passes_clear_if_no_obstacle_at_its_velocity_touches_for_so_long(seed, wanted):
    random = np.random.default_rng(seed)
    obstacles, rows = random_obstacles(random, 2), random_rows(random)
    rows["x"], rows["y"] = np.linspace(1.0, 4.0, len(rows)), 4.0
    latency, times = 0.1, STEP * SCHEDULE.step
    moving = predict(obstacles, PredictionConfig(), Times(latency, STEP, STEPS))
    clear, until = True, next((time for time in times if time >= wanted), math.inf)
    for time, row in zip(times, rows.view(np.recarray), strict=True):
        for x, y, vx, vy, radius in obstacles:
            at = x + (latency + time) * vx, y + (latency + time) * vy
            near = RULES.body.circumscribed + radius + 0.05  # the error of a tracked position
            clear &= time > until or math.dist(at, (row.x, row.y)) >= near
    assert t.passes_clear(moving, RULES, rows, wanted) == clear


@given(seeds)
@settings(max_examples=50, deadline=None)
def test_nearness_is_the_largest_discounted_part_of_the_personal_space(seed):
    random = np.random.default_rng(seed)
    obstacles, rows = random_obstacles(random), random_rows(random)
    latency, after = 0.2, STEP * SCHEDULE.step
    moving = predict(obstacles, PredictionConfig(), Times(latency, STEP, STEPS))
    space, expected = RULES.config.personal_space, 0.0
    for x, y, vx, vy, radius in obstacles:
        mean = np.array([x, y]) + (latency + after)[:, None] * np.array([vx, vy])
        gaps = (
            np.hypot(*(mean - np.column_stack([rows["x"], rows["y"]])).T)
            - RULES.risk_radius
            - radius
        )
        expected += (np.exp(-after / DISCOUNTED) * np.clip(1.0 - gaps / space, 0.0, 1.0)).max()
    assert t.nearness(moving, RULES, rows) == pytest.approx(expected, abs=1e-9)


# -- Eq. 9 ----------------------------------------------------------------------------------------


@given(
    st.lists(st.floats(0, 10), min_size=6, max_size=6),
    st.lists(st.floats(-1, 1), min_size=6, max_size=6),
)
@settings(deadline=None)
def test_the_objective_is_the_weighted_sum_less_risk_and_nearness(weights, terms):
    rules = RULES._replace(config=DwaConfig(Weights(*weights)))
    signs = (1, 1, 1, 1, -1, -1)
    expected = sum(s * w * term for s, w, term in zip(signs, weights, terms, strict=True))
    assert t.objective(SCENE, rules, t.Terms(*terms)) == pytest.approx(expected, abs=1e-9)


def test_the_terms_of_a_manoeuvre_are_those_of_its_rows():
    random = np.random.default_rng(3)
    rules = rules_for(Robot("round", LIMITS, Footprint.disc(0.3)), DwaConfig(Weights(simi=1.0)))
    scene = scene_of(empty(), moving=random_obstacles(random))
    rows, start = random_rows(random), random_start(random)
    assert t.evaluate(scene, rules, start, MANOEUVRE, rows) == t.Terms(
        heading=t.progress(scene.cost_to_go, rules, start, rows),
        dist=t.dist(rules, start, rows),
        vel=t.vel(rules, MANOEUVRE),
        simi=t.simi(scene.distance_to_path, rules, rows),
        risk=t.risk(scene.around.moving, rules, rows),
        nearness=t.nearness(scene.around.moving, rules, rows),
    )

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa import body_of
from dynastar.dwa.clearance import (
    EXACT_WITHIN,
    Closed,
    body_distance,
    clearance_slack,
    distance_at,
    kept_margin,
    least_clearance,
    polygon_distance,
)
from dynastar.dwa.dwa import SAMPLED
from dynastar.dwa.motion import Pose
from dynastar.footprint import Footprint
from dynastar.perception.local_map_kernels import BOX
from dynastar.robot import ROBOTS, Robot
from naive import footprint_gaps, signed_distance, slack_of_constraint
from scenes import (
    CELL,
    boxed,
    boxes_of,
    centres_of,
    closed_space,
    empty,
    field_of,
    scattered,
)

FOOTPRINTS = {
    "disc": Footprint.disc(0.3),
    "box": ROBOTS["jackal"].footprint,
    "off-centre": Footprint.polygon([(0.5, -0.1), (0.5, 0.2), (-0.1, 0.25), (-0.2, -0.2)]),
}
footprints = st.sampled_from(sorted(FOOTPRINTS))
MARGIN = 0.06


def body(name):
    return body_of(Robot(name, ROBOTS["paper"].limits, FOOTPRINTS[name]))


def at(x, y, theta=0.0):
    return Pose(x, y, math.cos(theta), math.sin(theta))


@given(st.integers(0, 10**6))
@settings(max_examples=20, deadline=None)
def test_the_distance_at_a_point_is_a_lower_bound_and_a_tight_one(seed):
    random = np.random.default_rng(seed)
    closed = scattered(random, random.uniform(0.0001, 0.02))
    field, centres = field_of(closed), centres_of(closed)
    for x, y in random.uniform(-0.5, 8.5, (50, 2)):
        found = distance_at(field, x, y)
        true = np.hypot(*(centres - (x, y)).T).min()
        assert 0.0 <= found <= true + 1e-6
        if min(x, y) > 0.1 and max(x, y) < 7.9:
            assert found > 0.96 * true - CELL


@given(footprints, *[st.floats(-1.5, 1.5)] * 2, st.floats(-4, 4))
@settings(deadline=None)
def test_the_distance_to_a_footprint(name, x, y, theta):
    import shapely

    shape = FOOTPRINTS[name]
    if shape.is_disc:
        expected = math.hypot(x, y) - shape.circumscribed
    else:
        cos, sin = math.cos(theta), math.sin(theta)
        turned = shape.vertices @ np.array([[cos, sin], [-sin, cos]])
        expected = signed_distance(shapely.Polygon(turned), shapely.Point(x, y))
        assert polygon_distance(shape.vertices, x, y) == pytest.approx(
            signed_distance(shapely.Polygon(shape.vertices), shapely.Point(x, y)), abs=1e-9
        )
    assert body_distance(body(name), at(0.0, 0.0, theta), x, y) == pytest.approx(expected, abs=1e-9)


@given(footprints, st.integers(0, 10**6))
@settings(max_examples=60, deadline=None)
def test_the_least_clearance_is_that_to_the_nearest_cell_where_it_is_small(name, seed):
    random = np.random.default_rng(seed)
    closed = scattered(random, random.choice([0.0005, 0.004]))
    field, centres, shape = field_of(closed), centres_of(closed), body(name)
    pose = at(*random.uniform(0.5, 7.5, 2), random.uniform(-4, 4))
    found = least_clearance(field, shape, pose)
    true = footprint_gaps(centres, FOOTPRINTS[name], pose).min()
    if distance_at(field, pose.x, pose.y) - shape.circumscribed > EXACT_WITHIN:
        assert found <= true + 1e-6
    else:
        assert found <= max(true, 0.0) + shape.probe_error + 1e-6
        assert found >= true - CELL or true == 0.0


@pytest.mark.parametrize("length", [0.5, 2.0, 4.5])
@pytest.mark.parametrize("behind", [0.2, 1.0])
def test_the_error_of_the_probes_is_the_most_that_a_point_inside_is_away_from_them(length, behind):
    back = -behind * length
    shape = Footprint.polygon([(length, -0.3), (length, 0.3), (back, 0.3), (back, -0.3)])
    found = body_of(Robot("long", ROBOTS["paper"].limits, shape))
    points = np.random.default_rng(0).uniform((back, -0.3), (length, 0.3), (20000, 2))
    away = np.hypot(*points.T) - shape.inscribed
    for probe in found.probes:
        away = np.minimum(away, np.hypot(*(points - probe).T))
    assert away.max() <= found.probe_error <= away.max() + 1.1 * shape.circumscribed / SAMPLED


def random_space(random):
    """Closed cells of which some are occupied, with boxes of hits in them."""
    closed = scattered(random, random.choice([0.0005, 0.004, 0.03]))
    row, column = random.integers(0, len(closed) - 30, 2)
    closed[row : row + 30, column : column + random.integers(1, 30)] = True
    hits = np.zeros(closed.shape, BOX)
    for low, high in (("low_x", "high_x"), ("low_y", "high_y")):
        ends = np.sort(random.uniform(-0.5 * CELL, 0.5 * CELL, (2, *closed.shape)), axis=0)
        hits[low], hits[high] = ends
    occupied = closed & (random.random(closed.shape) < 0.7)
    return Closed(field_of(closed), occupied, hits)


@given(footprints, st.integers(0, 10**6))
@settings(max_examples=60, deadline=None)
def test_the_slack_is_that_of_the_constraint_cell_by_cell(name, seed):
    random = np.random.default_rng(seed)
    closed = random_space(random)
    boxes = boxes_of(closed)
    start = at(*random.uniform(0.3, 7.7, 2), random.uniform(-4, 4))
    for _ in range(6):
        pose = at(*random.normal((start.x, start.y), 0.15), random.uniform(-4, 4))
        found = clearance_slack(closed, body(name), MARGIN, start, pose)
        true = slack_of_constraint(boxes, FOOTPRINTS[name], MARGIN, start, pose)
        assert (found < -1e-6) == (true < -1e-6)
        assert found >= true - 1e-6 if true < 0.0 else found <= true + 1e-5
        if 0.0 <= true < CELL and found < CELL - 1e-9:  # near zero it is exact
            near = distance_at(closed.distance, pose.x, pose.y) - body(name).circumscribed
            assert found == pytest.approx(true, abs=1e-6) or near >= MARGIN


@pytest.mark.parametrize("name", sorted(FOOTPRINTS))
def test_a_cell_that_was_nearer_at_the_start_may_stay_as_near_but_not_come_nearer(name):
    front = 0.3 if name == "disc" else FOOTPRINTS[name].vertices[:, 0].max()
    closed = boxed((4.0, 3.9, 4.05, 4.1))  # its centres are at x = 4.025
    start = at(4.025 - front - 0.03, 4.0)
    space = closed_space(closed)
    assert clearance_slack(space, body(name), MARGIN, start, start) == pytest.approx(0.0, abs=1e-5)
    assert clearance_slack(space, body(name), MARGIN, start, at(start.x - 0.01, 4.0)) >= 0.0
    assert clearance_slack(space, body(name), MARGIN, start, at(start.x + 0.01, 4.0)) < -0.005
    far = at(start.x - 0.5, 4.0)  # from farther away the whole margin counts
    assert clearance_slack(space, body(name), MARGIN, far, start) == pytest.approx(-0.03, abs=0.01)


@pytest.mark.parametrize("name", sorted(FOOTPRINTS))
def test_nothing_is_driven_into_and_a_hit_at_the_edge_no_deeper(name):
    front = 0.3 if name == "disc" else FOOTPRINTS[name].vertices[:, 0].max()
    space = closed_space(boxed((4.0, 3.9, 4.05, 4.1)))
    away, inside = at(4.025 - front - 0.2, 4.0), at(4.025 - front + 0.05, 4.0)
    back, deeper = at(inside.x - 0.02, 4.0), at(inside.x + 0.02, 4.0)
    for margin in (0.0, MARGIN):
        assert clearance_slack(space, body(name), margin, away, inside) < -0.02
        assert clearance_slack(space, body(name), margin, inside, back) >= 0.0
    assert clearance_slack(space, body(name), MARGIN, inside, deeper) < -1e-3
    # By more than the declared errors, or without a hit, it is nothing that the robot stands in.
    assert clearance_slack(space, body(name), 0.0, inside, deeper) >= 0.0
    unseen = space._replace(occupied=np.zeros_like(space.occupied))
    assert clearance_slack(unseen, body(name), MARGIN, inside, deeper) >= 0.0


@pytest.mark.parametrize("name", sorted(FOOTPRINTS))
def test_a_closed_cell_inside_the_footprint_does_not_void_the_check_of_others(name):
    closed = boxed((4.0, 4.0, 4.05, 4.05), (4.8, 3.0, 4.9, 5.0))
    start = at(4.0, 4.0)
    space = closed_space(closed)
    assert clearance_slack(space, body(name), MARGIN, start, start) >= 0.0
    assert clearance_slack(space, body(name), MARGIN, start, at(4.05, 4.0)) >= -1e-9
    assert clearance_slack(space, body(name), MARGIN, start, at(4.6, 4.0)) < -1e-3


def test_space_outside_the_field_counts_as_closed():
    assert distance_at(field_of(empty()), -1.0, 4.0) == 0.0
    assert (
        clearance_slack(closed_space(empty()), body("disc"), MARGIN, at(4.0, 4.0), at(0.2, 4.0))
        < 0.0
    )


@given(footprints, st.floats(0.0, 0.3), st.floats(0.0, 0.3))
@settings(max_examples=200, deadline=None)
def test_the_margin_kept_is_at_most_the_gap_but_half_of_the_margin_at_least(name, margin, gap):
    closed = empty()
    closed[80, 80] = True
    shape, (x, y) = body(name), ((80 + 0.5) * CELL, (80 + 0.5) * CELL)
    kept = kept_margin(closed_space(closed), shape, margin, at(x - reach_ahead(shape) - gap, y))
    assert 0.5 * margin <= kept <= min(margin, max(0.5 * margin, gap)) + 1e-6
    if name == "disc" and gap > margin + CELL:
        assert kept == margin


def test_an_obstacle_may_be_half_a_diagonal_from_the_centre_of_a_cell_without_hits():
    closed = empty()
    closed[80, 80] = True
    space = closed_space(closed)._replace(occupied=np.zeros(closed.shape, bool))
    x, pose = (80 + 0.5) * CELL, at((80 + 0.5) * CELL - 0.3 - 0.05, (80 + 0.5) * CELL)
    far = at(pose.x - 1.0, pose.y)
    assert clearance_slack(space, body("disc"), 0.01, far, pose) == pytest.approx(
        x - CELL / math.sqrt(2.0) - pose.x - 0.3 - 0.01, abs=1e-6
    )


def reach_ahead(shape):
    """How far a footprint reaches ahead of its centre along its own x axis (m)."""
    if len(shape.vertices) == 0:
        return shape.circumscribed
    crossings = []
    ends = np.roll(shape.vertices, -1, axis=0)
    for (ax, ay), (bx, by) in zip(shape.vertices, ends, strict=True):
        if (ay <= 0.0) != (by <= 0.0):
            crossings.append(ax + (bx - ax) * ay / (ay - by))
    return max(crossings)

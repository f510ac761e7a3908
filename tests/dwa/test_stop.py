import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.clearance import distance_field
from dynastar.dwa import Surroundings, stop_kernels
from dynastar.dwa.clearance_kernels import (
    centre_clearance,
    covered_clearance,
    footprint_clearance,
    polygon_distance,
)
from dynastar.dwa.dwa import Body, Margins
from dynastar.robot import Footprint, Limits, box, slew

RESOLUTION, SIDE = 0.05, 80
DISC, BOX = Footprint.disc(0.3), box(0.5, 0.4)
LIMITS = Limits(1.5, 1.5, 1.0, 1.5, 1.0, 1.5, -0.5)
NOBODY = np.empty((0, 6))


def body_of(footprint):
    return Body(footprint.vertices, footprint.discs, footprint.inscribed, footprint.circumscribed)


def round_about(field, movers=NOBODY):
    return Surroundings(field, 0.0, 0.0, RESOLUTION, movers)


def world(seed, share=0.01):
    closed = np.random.default_rng(seed).random((SIDE, SIDE)) < share
    closed[[0, -1]] = closed[:, [0, -1]] = True
    closed[30:50, 30:50] = False
    rows, columns = np.nonzero(closed)
    centres = np.column_stack([(columns + 0.5) * RESOLUTION, (rows + 0.5) * RESOLUTION])
    return distance_field(closed, RESOLUTION), centres


def true_clearance(centres, footprint, x, y, theta):
    """Distance from the footprint to the nearest closed cell's centre, the slow way."""
    if footprint.is_disc:
        return np.hypot(*(centres - (x, y)).T).min() - footprint.circumscribed
    shapely = pytest.importorskip("shapely")
    cos, sin = math.cos(theta), math.sin(theta)
    corners = footprint.vertices @ np.array([[cos, sin], [-sin, cos]]) + (x, y)
    return shapely.distance(shapely.Polygon(corners), shapely.points(centres)).min()


@given(st.integers(0, 10**6), st.floats(1.2, 2.8), st.floats(1.2, 2.8), st.floats(-3, 3))
@settings(max_examples=150, deadline=None)
@pytest.mark.parametrize("footprint", [DISC, BOX], ids=["disc", "box"])
def test_clearance_is_a_close_lower_bound(footprint, seed, x, y, theta):
    field, centres = world(seed)
    found = footprint_clearance(
        round_about(field), body_of(footprint), 0.3, x, y, math.cos(theta), math.sin(theta)
    )
    covered = covered_clearance(
        round_about(field), body_of(footprint), x, y, math.cos(theta), math.sin(theta)
    )
    assert covered <= max(found, 0.0) + 1e-9 or found >= 0.3 - 1e-9
    truth = true_clearance(centres, footprint, x, y, theta)
    if footprint.is_disc or truth > 0.0:
        assert found <= truth + 1e-6
    if footprint.is_disc or 0.0 < truth < 0.25:
        assert found >= truth - RESOLUTION / math.sqrt(2.0)
    else:
        assert (found > 0.05) == (truth > 0.05) or truth > 0.2


def test_clearance_off_the_window_is_none():
    field, _ = world(1)
    assert centre_clearance(field, 0.0, 0.0, RESOLUTION, -1.0, 2.0) == 0.0
    assert centre_clearance(field, 0.0, 0.0, RESOLUTION, 2.0, 99.0) == 0.0


@given(
    st.integers(0, 10**6),
    st.floats(-3, 3),
    st.floats(-1.2, 1.2),
    st.floats(-2, 2),
    st.sampled_from([DISC, BOX]),
)
@settings(max_examples=300, deadline=None)
def test_a_clear_arc_is_clear_everywhere(seed, theta, length, angle, footprint):
    field, centres = world(seed, 0.004)
    margin = 0.05
    around, body = round_about(field), body_of(footprint)
    cos, sin = math.cos(theta), math.sin(theta)
    spare = footprint_clearance(around, body, 0.5, 2.0, 2.0, cos, sin) - margin
    left = stop_kernels.spare_after(spare, around, body, margin, 2.0, 2.0, cos, sin, length, angle)
    clear = left >= 0.0
    along = [
        true_clearance(
            centres,
            footprint,
            *stop_kernels.arc(2.0, 2.0, theta, share * length, share * angle),
        )
        for share in np.linspace(0.0, 1.0, 60)
    ]
    if clear:
        assert min(along) >= margin - 0.25 * RESOLUTION
        assert along[-1] >= margin + left - 1e-6
    else:
        assert min(along) <= margin + RESOLUTION


@given(
    st.integers(0, 10**6),
    st.floats(-3, 3),
    st.tuples(st.floats(-0.5, 1.5), st.floats(-1.5, 1.5)),
    st.tuples(st.floats(-0.5, 1.5), st.floats(-1.5, 1.5)),
    st.sampled_from([DISC, BOX]),
)
@settings(max_examples=300, deadline=None)
def test_a_certified_command_keeps_its_clearance_all_the_way(seed, theta, now, wanted, footprint):
    field, centres = world(seed, 0.004)
    margins, period = Margins(0.05, 0.1, 0.1), 0.2
    around, body = round_about(field), body_of(footprint)
    allowed = footprint_clearance(around, body, 0.5, 2.0, 2.0, math.cos(theta), math.sin(theta))
    (a_v, a_w), (b_v, b_w) = (
        (LIMITS.v_accel, LIMITS.omega_accel),
        (LIMITS.v_brake, LIMITS.omega_brake),
    )
    v, omega = slew(now[0], wanted[0], a_v, b_v, period), slew(now[1], wanted[1], a_w, b_w, period)
    state = (2.0, 2.0, theta, *now)
    code = stop_kernels.certify(
        around, body, margins, allowed, 0.0, state, v, omega, LIMITS, period
    )
    if code != stop_kernels.ADMISSIBLE:
        return
    pose, speeds = (2.0, 2.0, theta), now
    half = 0.5 * period
    pieces = []
    for _ in range(2):
        later = slew(speeds[0], v, a_v, b_v, half), slew(speeds[1], omega, a_w, b_w, half)
        pieces.append((0.5 * half * (speeds[0] + later[0]), 0.5 * half * (speeds[1] + later[1])))
        speeds = later
    stop = max(abs(speeds[0]) / b_v, abs(speeds[1]) / b_w)
    pieces.append((0.5 * stop * speeds[0], 0.5 * stop * speeds[1]))
    for length, angle in pieces:
        for share in np.linspace(0.0, 1.0, 15):
            at = stop_kernels.arc(*pose, share * length, share * angle)
            least = true_clearance(centres, footprint, *at)
            assert least >= min(0.05, allowed) - 0.25 * RESOLUTION
        pose = stop_kernels.arc(*pose, length, angle)


def certify(field, movers, v0, omega0, v, omega, period=0.1, linger=0.0):
    margins = Margins(standing=0.05, movers=0.1, spread=0.1, linger=linger)
    state = (2.0, 2.0, 0.0, v0, omega0)
    around, body = round_about(field, movers), body_of(DISC)
    allowed = footprint_clearance(around, body, 0.5, 2.0, 2.0, 1.0, 0.0)
    return stop_kernels.certify(
        around, body, margins, allowed, 0.0, state, v, omega, LIMITS, period
    )


def test_a_wall_ahead_forbids_what_could_not_stop():
    closed = np.zeros((SIDE, SIDE), bool)
    closed[:, 56:] = True  # its first centres at x = 2.825
    field = distance_field(closed, RESOLUTION)
    free = 2.825 - 2.0 - 0.3 - 0.05
    fast = math.sqrt(2.0 * LIMITS.v_brake * free)
    assert certify(field, NOBODY, 0.9 * fast, 0.0, 0.8 * fast, 0.0) == stop_kernels.ADMISSIBLE
    assert certify(field, NOBODY, 1.05 * fast, 0.0, 1.05 * fast, 0.0) == stop_kernels.NO_STOP
    assert certify(field, NOBODY, 0.0, 0.0, 0.0, 1.0) == stop_kernels.ADMISSIBLE


def test_a_mover_forbids_what_would_meet_it():
    field = np.full((SIDE, SIDE), 9.0, np.float32)
    coming = np.array([[3.2, 2.0, -1.0, 0.0, 0.3, 1.0]])
    beside = np.array([[2.0, 3.8, 0.0, 0.2, 0.3, 0.2]])
    assert certify(field, coming, 0.8, 0.0, 0.8, 0.0) == stop_kernels.MOVER
    assert certify(field, beside, 0.8, 0.0, 0.8, 0.0) == stop_kernels.ADMISSIBLE


def test_where_a_mover_arrives_soon_after_is_no_place_to_rest():
    field = np.full((SIDE, SIDE), 9.0, np.float32)
    coming = np.array([[5.5, 2.0, -0.5, 0.0, 0.3, 0.5]])
    leaving = coming * [1, 1, -1, 1, 1, 1]
    assert certify(field, coming, 0.3, 0.0, 0.3, 0.0, linger=0.0) == stop_kernels.ADMISSIBLE
    assert certify(field, coming, 0.3, 0.0, 0.3, 0.0, linger=6.0) == stop_kernels.RUN_OVER
    assert certify(field, leaving, 0.3, 0.0, 0.3, 0.0, linger=6.0) == stop_kernels.RUN_OVER


@given(
    st.floats(-3, 3),
    st.floats(-3, 3),
    st.floats(-1, 1),
    st.floats(-1, 1),
    st.floats(0, 1.2),
    st.floats(-1, 1),
)
@settings(max_examples=200, deadline=None)
def test_movers_are_kept_clear_of_in_every_way_they_may_go(x, y, vx, vy, v, omega):
    radius, spread, ramp = 0.4, 0.1, 0.1
    stop = max(abs(v) / LIMITS.v_brake, abs(omega) / LIMITS.omega_brake)
    mover = np.array([[x, y, vx, vy, 0.3, 0.0]])
    state = (0.0, 0.0, 0.3, v, omega)
    touch = stop_kernels.first_touch(
        mover, spread, radius, state, v, omega, ramp, stop, ramp + stop, 0.0
    )
    nearest = math.inf
    poses = stop_kernels.stop_from(state, v, omega, ramp)
    for way in (1.0, 0.0, -1.0):
        for t in np.linspace(0.0, ramp + stop, 400):
            px, py = stop_kernels.position_on_stop(poses, state, v, omega, ramp, stop, t)
            gap = math.hypot(x + way * vx * t - px, y + way * vy * t - py)
            nearest = min(nearest, gap - radius - 0.3 - spread * t)
    if nearest > 0.02:
        assert touch == math.inf
    if nearest < -0.1 and math.hypot(x, y) > radius + 0.3 + 0.2:
        assert touch <= ramp + stop + 1e-9


@given(*[st.floats(-3, 3)] * 4, st.floats(0.01, 2), st.floats(0, 2), st.floats(0, 6))
@settings(max_examples=300, deadline=None)
def test_when_a_point_enters_a_disc(x, y, vx, vy, reach, begin, span):
    at = stop_kernels.enters(x, y, vx, vy, reach, begin, begin + span)
    times = np.linspace(begin, begin + span, 2001)
    inside = np.hypot(x + vx * times, y + vy * times) < reach
    if at < math.inf:
        assert begin <= at <= begin + span
        assert math.hypot(x + vx * at, y + vy * at) < reach + 1e-6
        assert not inside[times < at - 1e-6].any()
    else:
        assert not inside[
            (times > begin) & (np.hypot(x + vx * times, y + vy * times) < reach - 1e-6)
        ].any()


@given(st.floats(-2, 2))
@settings(deadline=None)
def test_half_turns(half):
    cos, sin, sinc = stop_kernels.half_turn(half)
    assert cos == pytest.approx(math.cos(half), abs=1e-12)
    assert sin == pytest.approx(math.sin(half), abs=1e-12)
    assert sinc == pytest.approx(math.sin(half) / half if half else 1.0, abs=1e-12)


@pytest.mark.parametrize(
    "footprint", [BOX, Footprint.polygon([(-0.2, -0.3), (0.5, 0.0), (-0.2, 0.3)])]
)
def test_the_discs_cover_a_polygon(footprint):
    low, high = footprint.vertices.min(axis=0), footprint.vertices.max(axis=0)
    rng = np.random.default_rng(0)
    points = rng.uniform(low, high, (3000, 2))
    inside = np.array([polygon_distance(footprint.vertices, *point) == 0.0 for point in points])
    discs = footprint.discs
    gaps = np.hypot(*(points[:, None] - discs[None, :, :2]).T).T - discs[:, 2]
    assert inside.any()
    assert (gaps.min(axis=1)[inside] <= 1e-9).all()
    assert discs[:, 2].max() < footprint.circumscribed

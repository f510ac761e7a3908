import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.clearance import distance_field
from dynastar.dwa import Surroundings
from dynastar.geometry import Pose2D
from dynastar.navigator.target import (
    AWAY,
    BEHIND,
    NEAREST,
    at_bearing,
    farthest_visible,
    leading_away,
    local_target,
    on_one_side,
)
from dynastar.path import Path

A = 0.05


def around(*boxes, side=120):
    """A window of 6 x 6 m in which boxes (x0, y0, x1, y1) are closed."""
    closed = np.zeros((side, side), bool)
    closed[[0, -1]] = closed[:, [0, -1]] = True
    for box in boxes:
        x0, y0, x1, y1 = (round(metres / A) for metres in box)
        closed[y0:y1, x0:x1] = True
    return Surroundings(distance_field(closed, A), 0.0, 0.0, A, np.empty((0, 6)))


@given(st.integers(0, 10**6))
@settings(max_examples=60, deadline=None)
def test_the_farthest_visible_is_that_of_a_plain_look(seed):
    rng = np.random.default_rng(seed)
    field = distance_field(rng.random((60, 60)) < 0.004, A)
    points, (x, y) = rng.uniform(-0.2, 3.2, (12, 2)), rng.uniform(0.5, 2.5, 2)

    def least(point):
        along = np.linspace((x, y), point, 2000)
        cells = np.floor(along / A).astype(int)
        if (cells < 0).any() or (cells >= 60).any():
            return 0.0
        return field[cells[:, 1], cells[:, 0]].min()

    found = farthest_visible(field, 0.0, 0.0, A, 0.3, x, y, points)
    assert found == -1 or least(points[found]) >= 0.3 - A
    assert all(least(point) < 0.3 for point in points[found + 1 :])


ROUND = Path(np.array([(1.0, 1.0), (4.0, 1.0), (4.0, 5.0)]))


def test_in_the_open_it_lies_the_lookahead_on():
    target, seen = local_target(ROUND, 0.5, (1.5, 1.0), 1.5, (0.3,), around())
    assert seen
    assert target == pytest.approx((3.0, 1.0))


def test_it_does_not_lie_behind_a_corner():
    block = around((1.0, 2.0, 3.5, 5.0))
    target, seen = local_target(ROUND, 0.0, (1.0, 1.0), 99.0, (0.3,), block)
    assert seen
    assert target[0] == pytest.approx(4.0, abs=0.06)
    assert 1.0 < target[1] < 2.5
    assert local_target(ROUND, 0.0, (1.0, 1.0), 99.0, (0.3,), around())[0] == (4.0, 5.0)


def test_the_widest_clearance_that_any_point_allows_is_kept():
    gate = around((2.5, 0.0, 2.6, 0.65), (2.5, 1.35, 2.6, 6.0))  # 0.7 m wide
    wide, seen = local_target(ROUND, 0.0, (1.0, 1.0), 2.9, (0.5, 0.3), gate)
    assert seen
    assert wide[0] < 2.1  # the near side keeps 0.5 m
    tight, seen = local_target(ROUND, 0.0, (1.0, 1.0), 2.9, (0.3,), gate)
    assert seen
    assert tight == pytest.approx((3.9, 1.0))


def test_out_of_sight_the_path_just_ahead_is_steered_by():
    walled = around((1.2, 0.0, 1.3, 6.0))
    target, seen = local_target(ROUND, 0.5, (0.8, 3.0), 1.5, (0.3,), walled)
    assert not seen
    assert target == ROUND.at(0.5 + NEAREST)


def test_the_end_is_a_target_however_near():
    target, seen = local_target(ROUND, 6.9, (4.0, 4.9), 1.5, (0.3,), around())
    assert seen
    assert target == (4.0, 5.0)


@pytest.mark.parametrize("bearing", np.linspace(-3.0, 3.0, 13))
def test_leading_away_gains_clearance_towards_the_target(bearing):
    wall = around((0.0, 0.0, 6.0, 2.0))
    here = (3.0, 2.3)
    target = here[0] + 2.0 * math.cos(bearing), here[1] + 2.0 * math.sin(bearing)
    x, y = leading_away(target, here, wall)
    assert math.dist((x, y), here) == pytest.approx(NEAREST)
    heading = math.atan2(y - here[1], x - here[0])
    assert abs(heading - math.pi / 2) <= AWAY + 1e-3
    if abs(bearing - math.pi / 2) < AWAY:
        assert heading == pytest.approx(bearing, abs=1e-3)


def test_between_two_walls_as_near_the_target_stays():
    lane = around((0.0, 0.0, 6.0, 2.0), (0.0, 2.5, 6.0, 6.0))
    assert leading_away((5.0, 2.25), (3.0, 2.25), lane) == (5.0, 2.25)


@pytest.mark.parametrize(("omega", "side"), [(0.3, 1.0), (-0.3, -1.0), (0.0, 1.0)])
def test_what_lies_behind_is_turned_to_on_the_side_that_the_robot_turns_to(omega, side):
    pose = Pose2D(1.0, 2.0, 0.5)
    for off in (3.0, -3.0):
        target, bearing = on_one_side(at_bearing(pose, off), pose, omega)
        assert bearing == side * BEHIND
        assert target == pytest.approx(at_bearing(pose, bearing))
    for off in (2.0, -2.0):
        ahead = at_bearing(pose, off)
        assert on_one_side(ahead, pose, omega) == (ahead, pytest.approx(off))

import math

import numpy as np
import pytest

from dynastar.obstacles.corner_kernels import JUMP, blind_corners, nearest_corner

DEGREE = math.radians(1.0)


def corners(ranges, x=0.0, y=0.0, theta=0.0, start=-math.pi):
    ranges = np.array(ranges, np.float32)
    return blind_corners(ranges, 0.1, 5.0, start, math.tau / len(ranges), x, y, theta)


def test_a_doorway_has_two_corners_at_its_posts():
    ranges = np.full(360, 2.0)
    ranges[170:191] = 4.5  # from -10 to +10 degrees
    found = corners(ranges, 1.0, 2.0, 0.5)
    expected = [
        (1.0 + 2.0 * math.cos(0.5 + off), 2.0 + 2.0 * math.sin(0.5 + off))
        for off in (-11.0 * DEGREE, 11.0 * DEGREE)
    ]
    assert found == pytest.approx(np.array(expected), abs=1e-6)


def test_the_jump_across_the_ends_of_a_full_circle_counts():
    ranges = np.full(360, 2.0)
    ranges[:90] = 4.0
    assert len(corners(ranges)) == 2


def test_the_ends_of_less_than_a_circle_do_not_meet():
    ranges = np.full(270, 2.0, np.float32)
    ranges[:90] = 4.0
    found = blind_corners(ranges, 0.1, 5.0, -0.75 * math.pi, DEGREE, 0.0, 0.0, 0.0)
    assert len(found) == 1


def test_a_wall_seen_aslant_has_none():
    angles = np.radians(np.arange(-60.0, 61.0))
    ranges = np.full(360, np.nan)
    ranges[120:241] = 1.0 / np.cos(angles)
    assert len(corners(ranges)) == 0
    ranges[240] += JUMP
    assert len(corners(ranges)) == 1


def test_nothing_in_range_counts_as_its_end_and_no_reading_as_nothing():
    ranges = np.full(360, 3.0)
    ranges[100:110] = np.inf
    assert len(corners(ranges)) == 2
    ranges[99], ranges[110] = np.nan, 0.05
    assert len(corners(ranges)) == 0
    assert len(corners(np.where(np.isinf(ranges), np.inf, 4.8))) == 0


@pytest.mark.parametrize("theta", [0.0, 3.0, -3.0, 9.0])
def test_the_nearest_is_looked_for_round_the_heading(theta):
    at = np.array(
        [
            (length * math.cos(theta + off), length * math.sin(theta + off))
            for length, off in ((1.0, 2.0), (2.0, -1.0), (3.0, 0.1))
        ]
    ) + (4.0, -2.0)
    for within, expected in ((0.05, math.inf), (0.5, 3.0), (1.1, 2.0), (3.2, 1.0)):
        assert nearest_corner(at, 4.0, -2.0, theta, within) == pytest.approx(expected)
    assert nearest_corner(at[:0], 4.0, -2.0, theta, 3.2) == math.inf

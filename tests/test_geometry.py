"""Poses in the plane."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.geometry import Pose2D, compose, interpolate, inverse, wrap_angle

angles = st.floats(-1e3, 1e3)
metres = st.floats(-1e3, 1e3)
poses = st.builds(Pose2D, metres, metres, angles)


def same(a: Pose2D, b: Pose2D) -> bool:
    return math.dist(a[:2], b[:2]) < 1e-6 and abs(wrap_angle(a.theta - b.theta)) < 1e-6


@given(angles)
def test_a_wrapped_angle_is_the_same_direction(angle):
    wrapped = wrap_angle(angle)
    assert -math.pi < wrapped <= math.pi
    assert math.cos(wrapped) == pytest.approx(math.cos(angle), abs=1e-9)
    assert math.sin(wrapped) == pytest.approx(math.sin(angle), abs=1e-9)


@pytest.mark.parametrize("turns", [-3, -1, 1, 3])
def test_half_a_turn_is_always_plus_pi(turns):
    assert wrap_angle(turns * math.pi) == math.pi


@given(poses, poses, poses)
def test_composing_is_associative_and_has_an_inverse(a, b, c):
    assert same(compose(compose(a, b), c), compose(a, compose(b, c)))
    assert same(compose(a, inverse(a)), Pose2D(0, 0, 0))
    assert same(compose(inverse(a), a), Pose2D(0, 0, 0))


def test_a_pose_in_a_turned_frame():
    assert same(compose(Pose2D(1, 2, math.pi / 2), Pose2D(1, 0, 0)), Pose2D(1, 3, math.pi / 2))


@given(poses, poses)
def test_interpolation_meets_both_ends(a, b):
    assert same(interpolate(a, b, 0.0), a)
    assert same(interpolate(a, b, 1.0), b)


def test_the_heading_turns_the_short_way():
    middle = interpolate(Pose2D(0, 0, math.radians(170)), Pose2D(2, 0, math.radians(-170)), 0.5)
    assert same(middle, Pose2D(1, 0, math.pi))

"""The footprint's measures."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.errors import ConfigError
from dynastar.robot import Footprint

TURNS = np.linspace(0.0, np.pi, 3601)


@given(
    st.lists(st.integers(0, 59), min_size=3, max_size=9, unique=True),
    st.floats(-0.9, 0.9),
)
def test_the_half_width_is_half_of_the_least_extent_in_any_direction(sixtieths, ahead):
    angles = np.array(sorted(sixtieths)) * np.pi / 30.0
    corners = np.column_stack([np.cos(angles), np.sin(angles)])
    corners[:, 0] += ahead
    try:
        footprint = Footprint.polygon(corners)
    except ConfigError:  # the corners do not surround the centre
        return
    directions = np.column_stack([np.cos(TURNS), np.sin(TURNS)])
    extents = np.ptp(footprint.vertices @ directions.T, axis=0)
    assert footprint.half_width == pytest.approx(0.5 * extents.min(), abs=2e-3)
    assert footprint.half_width >= footprint.inscribed - 1e-12


def test_a_cart_that_turns_about_its_rear_axle_is_as_wide_as_its_body():
    cart = Footprint.polygon([(1.0, -0.3), (1.0, 0.3), (-0.05, 0.3), (-0.05, -0.3)])
    assert cart.inscribed == pytest.approx(0.05)
    assert cart.half_width == pytest.approx(0.3)
    assert Footprint.disc(0.2).half_width == 0.2

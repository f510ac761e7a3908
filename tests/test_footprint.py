"""The footprint's measures."""

import pytest

from dynastar.errors import InputError
from dynastar.footprint import Footprint


@pytest.mark.parametrize(
    ("front", "back", "right", "left", "half_width", "inscribed"),
    [
        (1.0, -0.05, -0.3, 0.3, 0.3, 0.05),  # a cart that turns about its rear axle
        (0.1, -0.1, -0.3, 0.3, 0.3, 0.1),  # wider than long: it cannot drive sideways
        (0.4, -0.4, -0.1, 0.3, 0.3, 0.1),  # its axle is off the middle
    ],
)
def test_the_half_width_is_across_the_driving_direction(
    front, back, right, left, half_width, inscribed
):
    shape = Footprint.polygon([(front, right), (front, left), (back, left), (back, right)])
    assert shape.half_width == pytest.approx(half_width)
    assert shape.inscribed == pytest.approx(inscribed)


def test_a_disc_is_as_wide_as_its_radius_says():
    assert Footprint.disc(0.2).half_width == 0.2


@pytest.mark.parametrize("radius", [10**400, "0.2", None, -0.1, float("nan")])
def test_a_radius_that_is_no_length_is_refused(radius):
    with pytest.raises(InputError, match="radius"):
        Footprint.disc(radius)


def test_a_polygon_beyond_all_robots_is_refused():
    with pytest.raises(InputError, match="beyond 1e\\+06 m"):
        Footprint.polygon([(1e300, 1e300), (-1e300, 1e300), (0.0, -1e300)])

import math

import numpy as np
import pytest

from dynastar.scan import LaserScan


@pytest.mark.parametrize(
    ("beams", "angle", "expected"),
    [
        (360, math.tau, True),
        (360, -math.tau, True),
        (360, math.tau * 359.4 / 360, False),  # 0.6 of a beam is missing
        (360, math.tau * 359.6 / 360, True),
        (2, math.pi, False),
    ],
)
def test_a_full_circle_lacks_less_than_half_a_beam(beams, angle, expected):
    scan = LaserScan(0.0, np.ones(beams), 0.0, angle / beams, 0.1, 10.0)
    assert scan.full_circle is expected

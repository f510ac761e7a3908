"""What a robot is made of."""

import pytest

from dynastar.errors import ConfigError
from dynastar.footprint import Footprint
from dynastar.robot import ROBOTS, Robot

LIMITS, DISC = ROBOTS["jackal"].limits, Footprint.disc(0.2)


@pytest.mark.parametrize(
    ("parts", "words"),
    [
        (("x", LIMITS, 0.2), "a robot's footprint: got 0.2, expected Footprint, as Footprint.disc"),
        (("x", {"v_max": 1}, DISC), "a robot's limits: got {'v_max': 1}, expected Limits"),
        (("x", LIMITS, DISC, 5.0), "a robot's lidar: got 5.0, expected Lidar"),
        ((LIMITS, LIMITS, DISC), "a robot's name: got Limits"),
    ],
)
def test_a_part_of_a_wrong_type_is_refused(parts, words):
    with pytest.raises(ConfigError, match=words):
        Robot(*parts)

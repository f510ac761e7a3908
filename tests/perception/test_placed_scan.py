import math

import numpy as np
import pytest

from dynastar.geometry import Pose2D
from dynastar.perception.placed_scan import placed
from dynastar.scan import LaserScan


def test_points_are_where_the_beams_of_the_placed_sensor_end():
    scan = LaserScan(3.0, [2.0, np.inf, 1.0, np.nan], 0.0, math.pi / 2, 0.1, 5.0)
    view = placed(scan, Pose2D(10.0, 20.0, math.pi / 2), (0.0, 0.0), 100.0)
    assert view.points == pytest.approx(np.array([(10.0, 22.0), (10.0, 19.0)]))
    assert view.beams.tolist() == [0, 2]
    assert view.sensor.full_circle
    assert (view.sensor.stamp, view.sensor.beams) == (3.0, 4)


def test_free_ranges_lack_the_error_and_end_where_an_obstacle_fits_between_beams():
    step = 0.01
    scan = LaserScan(0.0, [1.0, 2.0, 9.0, 9.0], 0.0, step, 0.1, 10.0)
    free = placed(scan, Pose2D(0.0, 0.0, 0.0), (0.05, 0.0), 0.04).free
    half = 0.5 * step  # a corner may stand out that far between two beams
    assert free == pytest.approx([1.0 - half - 0.05, 2.0 - 2.0 * half - 0.05, 0.04 / step, 0.0])


@pytest.mark.parametrize("reading", [5.6, 5.605, np.inf])
def test_a_beam_without_a_hit_is_free_up_to_range_max_and_ends_at_no_point(reading):
    scan = LaserScan(0.0, np.full(9, reading), 0.0, 0.01, 0.1, 5.6)
    view = placed(scan, Pose2D(0.0, 0.0, 0.0), (0.05, 0.0), 0.1)
    assert len(view.points) == 0
    assert view.free[:-1] == pytest.approx(5.6 - 0.05 - 0.5 * 5.6 * 0.01)

import math

import numpy as np
import pytest

from dynastar.errors import InputError
from dynastar.geometry import Pose2D
from dynastar.scan import LaserScan, as_scans


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


@pytest.mark.parametrize("range_max", [3.5, 5.6, 8.1, 29.99])
def test_a_reading_is_a_hit_or_nothing_up_to_range_max_or_no_information(range_max):
    given = [1.0, 0.12, range_max, 1.0009 * range_max, np.inf]
    given += [0.0, -1.0, -np.inf, np.nan, 0.1, 65.5]
    readings = LaserScan(0.0, given, 0.0, 0.1, 0.12, range_max).readings()
    hit, nothing, unknown = np.isfinite(readings), np.isinf(readings), np.isnan(readings)
    assert hit.tolist() == [True] * 2 + [False] * 9
    assert nothing.tolist() == [False] * 2 + [True] * 3 + [False] * 6
    assert unknown.tolist() == [False] * 5 + [True] * 6
    assert readings[:2] == pytest.approx([1.0, 0.12])


def test_without_a_largest_range_every_positive_reading_is_a_hit():
    readings = LaserScan(0.0, [1e30, np.inf, 0.0], 0.0, 0.1, 0.0, math.inf).readings()
    assert np.isfinite(readings[0])
    assert readings[1] == np.inf
    assert np.isnan(readings[2])


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"mount": Pose2D(1e4, 0.0, 0.0)}, "within 1000 m"),
        ({"mount": Pose2D(0.0, 0.0, 1e5)}, "within 1000 m and rad"),
        ({"angle_min": -1e9}, "within 1000 m and rad"),
        ({"range_min": 10.0}, "ranges run from 10 to 10 m"),
        ({"range_min": math.inf, "range_max": math.inf}, "ranges run from inf"),
        ({"range_max": math.nan}, "to nan m"),
        ({"range_max": math.inf}, None),
    ],
)
def test_a_scan_that_cannot_be_used_says_why(changes, words):
    fields = {"angle_min": 0.0, "range_min": 0.1, "range_max": 10.0} | changes
    fault = LaserScan(stamp=0.0, ranges=np.ones(9), angle_increment=0.1, **fields).fault()
    assert (fault is None) if words is None else words in fault


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"stamp": "now"}, "stamp of a scan: got 'now'"),
        ({"mount": ("left", 0.0)}, "mount of a scan"),
        ({"ranges": ["near", "far"]}, "ranges of a scan"),
        ({"ranges": np.ones((9, 2))}, r"got the shape \(9, 2\), expected \(n,\)"),
        ({"ranges": 1.0}, r"got the shape \(\), expected \(n,\)"),
        ({"frame": ["front"]}, "frame of a scan"),
        ({"frame": None}, "frame of a scan"),
    ],
)
def test_a_scan_that_is_none_is_refused_when_it_is_made(changes, words):
    fields = {"stamp": 0.0, "ranges": np.ones(9), "angle_min": 0.0, "angle_increment": 0.1}
    with pytest.raises(InputError, match=words):
        LaserScan(**fields | {"range_min": 0.1, "range_max": 10.0} | changes)


def test_scans_are_those_of_any_sequence_and_the_rest_is_one_that_is_wrong():
    scan = LaserScan(0.0, np.ones(9), 0.0, 0.1, 0.1, 10.0)
    assert as_scans(None) == []
    assert as_scans(scan) == [scan]
    assert as_scans((scan, None)) == [scan, None]
    for wrong in ("scan", 3, np.array(1.0)):
        assert as_scans(wrong) == [wrong]

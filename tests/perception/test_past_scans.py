import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit

from dynastar.geometry import Pose2D
from dynastar.perception.past_scans import CLOSEST, GROWTH, MEMORY, PastScans, seen_free_at
from dynastar.perception.placed_scan import placed
from dynastar.scan import LaserScan

HERE = Pose2D(0.0, 0.0, 0.0)


def scan(stamp, ranges, angle_min=-math.pi, angle=math.tau, pose=HERE, mount=HERE):
    step = angle / len(ranges)
    taken = LaserScan(stamp, np.array(ranges, float), angle_min, step, 0.05, 10.0, mount)
    return placed(taken, pose, (0.0, 0.0), 0.1)


@njit
def is_free(x, y, space, since=-math.inf):
    return seen_free_at(x, y, space) > since


def ahead(stamp, distance):
    return scan(stamp, [distance] * 720)


@given(
    st.lists(st.floats(0.2, 10.0), min_size=180, max_size=180),
    st.tuples(st.floats(-3.0, 3.0), st.floats(-3.0, 3.0), st.floats(-7.0, 7.0)),
    st.tuples(st.floats(-8.0, 8.0), st.floats(-8.0, 8.0)),
    st.sampled_from([math.tau, 4.0, -math.tau]),
)
@settings(deadline=None, max_examples=300)
def test_a_point_is_seen_free_where_both_neighbouring_beams_pass_it(ranges, pose, point, angle):
    """Against the beams' angles, one by one; not at the verge of two gaps."""
    past, step = PastScans(), angle / len(ranges)
    past.add(scan(1.0, ranges, -2.0, angle, Pose2D(*pose)))
    far = math.dist(point, pose[:2])
    bearing = math.atan2(point[1] - pose[1], point[0] - pose[0]) - pose[2]
    angles = -2.0 + step * np.arange(len(ranges))
    offs = (bearing - angles + math.pi) % math.tau - math.pi
    step = abs(step)
    beside = np.flatnonzero(np.abs(offs) < step)
    if np.abs(offs).min() < 1e-6 or np.abs(np.abs(offs) - step).min() < 1e-6:
        return
    reach = min((ranges[i] for i in beside), default=0.0) * (1.0 - 0.5 * step)
    reach = min(reach, 0.1 / step) if len(beside) == 2 else 0.0
    if abs(far - reach) > 1e-3:  # ranges are float32
        assert is_free(*point, past.space()) == (far < reach)


def test_what_was_seen_long_ago_counts_until_it_is_forgotten():
    past = PastScans()
    past.add(ahead(0.0, 5.0))
    for k in range(1, 400):
        past.add(ahead(0.05 * k, 2.0))
    assert is_free(3.0, 0.01, past.space())
    assert not is_free(3.0, 0.01, past.space(), 0.5)
    assert is_free(1.9, 0.01, past.space(), 19.9)


def test_few_scans_are_kept_the_older_the_further_apart():
    past = PastScans()
    for k in range(2000):
        past.add(ahead(0.05 * k, 5.0))
        ages = 0.05 * k - past.space().sensors["stamp"]
        assert ages[0] == 0.0
        assert ages[-1] <= MEMORY
        assert len(ages) < 30
        apart = np.diff(ages)
        assert (apart <= np.maximum(CLOSEST, 2.0 * GROWTH * ages[:-1]) + 0.11).all()
    assert ages[-1] > 0.5 * MEMORY


def test_scans_of_two_lidars_with_different_beams_are_kept_together():
    past = PastScans()
    past.add(scan(0.0, [4.0] * 720))
    past.add(scan(0.2, [2.0] * 360, -1.0, 2.0, Pose2D(0.0, 0.0, math.pi)))
    assert is_free(3.0, 0.0, past.space(), -1.0)
    assert is_free(-3.0, 0.0, past.space(), -1.0)
    assert not is_free(-3.0, 0.0, past.space(), 0.1)
    assert is_free(-1.9, 0.0, past.space(), 0.1)


def test_each_of_two_lidars_keeps_its_own_scans_though_their_stamps_are_the_same():
    past, behind = PastScans(), Pose2D(0.0, 0.0, math.pi)
    for k in range(200):
        past.add(scan(0.05 * k, [4.0] * 360, -1.0, 2.0))
        past.add(scan(0.05 * k, [4.0] * 360, -1.0, 2.0, behind, behind))
    newest = 0.05 * 199
    assert is_free(3.0, 0.0, past.space(), newest - 1e-9)
    assert is_free(-3.0, 0.0, past.space(), newest - 1e-9)
    stamps = past.space().sensors["stamp"]
    assert (np.diff(stamps) <= 0.0).all()
    assert len(stamps) < 60

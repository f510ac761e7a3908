"""Frames: chains of transforms, tilted and upside-down mounts, ages."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.errors import InputError
from dynastar.geometry import Pose2D, compose
from dynastar.ros.bag import make
from dynastar.ros.incoming import scan_of
from dynastar.ros.outgoing import Messages
from dynastar.ros.transforms import Transforms

OUT = Messages(make)
poses = st.builds(Pose2D, st.floats(-9, 9), st.floats(-9, 9), st.floats(-3.1, 3.1))


def turned(parent, child, roll, yaw=0.0, x=0.0):
    """A transform with a roll about x after a yaw about z."""
    message = OUT.transforms([(parent, child, Pose2D(x, 0.0, 0.0))], 0.0)
    c, s = math.cos(roll / 2), math.sin(roll / 2)
    cz, sz = math.cos(yaw / 2), math.sin(yaw / 2)
    message.transforms[0].transform.rotation = make(
        "geometry_msgs/msg/Quaternion", x=cz * s, y=sz * s, z=sz * c, w=cz * c
    )
    return message


@given(poses, poses, poses)
def test_chains_are_composed(a, b, c):
    found = Transforms()
    found.add(OUT.transforms([("map", "odom", a), ("odom", "base", b)], 1.0), static=False)
    found.add(OUT.transforms([("base", "laser", c)], 0.0), static=True)
    expected = compose(compose(a, b), c)
    pose, upside_down = found.planar("map", "laser")
    assert not upside_down
    assert pose[:2] == pytest.approx(expected[:2], abs=1e-9)
    assert math.remainder(pose.theta - expected.theta, math.tau) == pytest.approx(0.0, abs=1e-9)
    assert found.planar("base", "odom") is None  # only downwards
    assert found.planar("odom", "odom").pose == Pose2D(0.0, 0.0, 0.0)


def test_the_newest_counts_and_what_is_static_stays():
    found = Transforms()
    for x, time, newest in ((1.0, 5.0, 1.0), (2.0, 4.8, 1.0), (3.0, 6.0, 3.0)):
        found.add(OUT.transforms([("map", "odom", Pose2D(x, 0.0, 0.0))], time), static=False)
        assert found.planar("map", "odom").pose.x == newest
    assert found.ages("map", "odom", 6.5) == pytest.approx([0.5])
    found.add(OUT.transforms([("base", "laser", Pose2D(0.1, 0.0, 0.0))], 0.0), static=True)
    assert found.ages("base", "laser", 1e9) == []
    found.add(OUT.transforms([("base", "laser", Pose2D(0.2, 0.0, 0.0))], 7.0), static=False)
    assert found.planar("base", "laser").pose.x == 0.1
    found.clear()
    assert found.planar("map", "odom") is None
    assert found.planar("base", "laser").pose.x == 0.1


def test_each_transform_of_a_chain_has_its_age():
    found = Transforms()
    still = Pose2D(0.0, 0.0, 0.0)
    found.add(OUT.transforms([("map", "earth", still)], 1.0), static=False)
    found.add(OUT.transforms([("earth", "odom", still)], 0.0), static=True)
    found.add(OUT.transforms([("odom", "base", still)], 3.0), static=False)
    assert found.ages("map", "base", 4.0) == pytest.approx([1.0, 3.0])
    assert found.ages("nowhere", "base", 4.0) == pytest.approx([1.0, 3.0])
    assert found.ages("base", "base", 4.0) == []


def test_a_clock_that_is_set_back_does_not_keep_an_old_transform():
    found = Transforms()
    for x, time in ((1.0, 5000.0), (2.0, 10.0)):
        found.add(OUT.transforms([("map", "odom", Pose2D(x, 0.0, 0.0))], time), static=False)
    assert found.planar("map", "odom").pose.x == 2.0


def test_a_bad_transform_does_not_drop_those_beside_it():
    found = Transforms()
    bad, good = (
        ("base", "wheel", Pose2D(math.nan, 0.0, 0.0)),
        ("base", "laser", Pose2D(0.1, 0.0, 0.0)),
    )
    with pytest.raises(InputError, match="'wheel' is not finite"):
        found.add(OUT.transforms([bad, good], 0.0), static=True)
    assert found.planar("base", "laser").pose.x == 0.1


def test_a_lidar_that_hangs_upside_down_sees_the_same_points():
    found = Transforms()
    found.add(turned("base", "laser", math.pi, yaw=0.4, x=0.2), static=True)
    mount = found.planar("base", "laser")
    assert mount.upside_down
    ranges = np.array([1.0, 2.0, 3.0], np.float32)
    scan = {"angle_min": -0.5, "angle_increment": 0.5, "range_max": 9.0, "ranges": ranges}
    message = make("sensor_msgs/msg/LaserScan", header=OUT.header("laser", 0.0), **scan)
    seen = scan_of(message, mount)
    assert seen.fault() is None
    directions = seen.angles + mount.pose.theta
    assert directions == pytest.approx([0.9, 0.4, -0.1])  # y of the sensor points right


@pytest.mark.parametrize("turn", [0.0, math.pi])
def test_frames_that_are_tilted_by_up_to_5_degrees_are_used(turn):
    found = Transforms()
    for tilt in (-5.0, 4.0):
        found.add(turned("base", "laser", turn + math.radians(tilt), yaw=0.4, x=0.2), static=True)
        mount = found.planar("base", "laser")
        assert mount.pose == pytest.approx((0.2, 0.0, 0.4))
        assert mount.upside_down == (turn > 0.0)
    found.add(turned("base", "laser", turn + math.radians(5.2)), static=True)
    with pytest.raises(InputError, match=r"tilted by 5\.2 degrees"):
        found.planar("base", "laser")


def test_what_cannot_be():
    found = Transforms()
    found.add(turned("base", "tilted", 0.5), static=True)
    with pytest.raises(
        InputError, match=r"from 'base', is tilted by 28\.6 degrees: expected at most 5"
    ):
        found.planar("base", "tilted")
    bad = OUT.transforms([("base", "bad", Pose2D(math.nan, 0.0, 0.0))], 0.0)
    with pytest.raises(InputError, match="not finite"):
        found.add(bad, static=True)
    still = Pose2D(0.0, 0.0, 0.0)
    found.add(OUT.transforms([("a", "b", still), ("b", "a", still)], 0.0), static=False)
    with pytest.raises(InputError, match="loop"):
        found.planar("map", "a")

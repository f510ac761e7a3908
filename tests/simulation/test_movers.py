import math

import numpy as np
import pytest
import shapely
import shapely.affinity
from hypothesis import given
from hypothesis import strategies as st

from dynastar.errors import ScenarioError
from dynastar.footprint import Footprint, box
from dynastar.geometry import Pose2D
from dynastar.simulation.movers import Movers
from dynastar.simulation.scenario import Mover

TIMES = np.array([1.0, 3.0, 5.0])
POINTS = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 4.0]])
NOWHERE = (math.nan, math.nan)


def where(after, time):
    return Movers([Mover(0.3, TIMES, POINTS, after)]).at(time)[0]


@pytest.mark.parametrize(
    ("after", "time", "expected"),
    [
        ("loop", 0.0, (0, 0)),
        ("loop", 2.0, (1, 0)),
        ("loop", 4.0, (2, 2)),
        ("loop", 4.999, (2, 3.998)),
        ("loop", 5.0, (0, 0)),
        ("loop", 6.0, (1, 0)),
        ("loop", 12.0, (2, 2)),
        ("back_and_forth", 0.0, (0, 0)),
        ("back_and_forth", 5.0, (2, 4)),
        ("back_and_forth", 6.0, (2, 2)),
        ("back_and_forth", 8.0, (1, 0)),
        ("back_and_forth", 9.0, (0, 0)),
        ("back_and_forth", 10.0, (1, 0)),
        ("stay", 0.5, (0, 0)),
        ("stay", 4.0, (2, 2)),
        ("stay", 500.0, (2, 4)),
        ("vanish", 0.5, NOWHERE),
        ("vanish", 1.0, (0, 0)),
        ("vanish", 5.0, (2, 4)),
        ("vanish", 5.01, NOWHERE),
    ],
)
def test_a_mover_is_where_its_keys_say(after, time, expected):
    np.testing.assert_allclose(where(after, time), expected, atol=1e-12)


@pytest.mark.parametrize("after", ["loop", "back_and_forth", "stay"])
def test_a_single_key_stands(after):
    movers = Movers([Mover(0.3, np.array([2.0]), np.array([[1.0, 2.0]]), after)])
    for time in (0.0, 2.0, 7.0):
        np.testing.assert_array_equal(movers.at(time), [[1.0, 2.0]])


@given(time=st.floats(0.0, 100.0), keys=st.integers(2, 6), seed=st.integers(0, 1000))
def test_between_keys_it_is_linear(time, keys, seed):
    random = np.random.default_rng(seed)
    times = np.cumsum(random.uniform(0.1, 2.0, keys))
    points = random.uniform(-5.0, 5.0, (keys, 2))
    other = Mover(0.1, TIMES, POINTS, "loop")
    at = Movers([other, Mover(0.3, times, points, "stay"), other]).at(time)[1]
    expected = [np.interp(time, times, points[:, axis]) for axis in (0, 1)]
    np.testing.assert_allclose(at, expected, atol=1e-9)


@pytest.mark.parametrize("footprint", [Footprint.disc(0.4), box(0.8, 0.5)])
def test_the_gap_is_shapelys(footprint):
    random = np.random.default_rng(3)
    for _ in range(300):
        pose = Pose2D(*random.uniform(-2.0, 2.0, 2), random.uniform(-4.0, 4.0))
        centre, radius = random.uniform(-2.0, 2.0, 2), random.uniform(0.1, 0.5)
        movers = Movers([Mover(radius, np.array([0.0]), centre[None], "stay")])
        if footprint.is_disc:
            expected = math.dist(pose[:2], centre) - 0.4
        else:
            shape = shapely.affinity.rotate(
                shapely.Polygon(footprint.vertices), pose.theta, (0, 0), use_radians=True
            )
            shape = shapely.affinity.translate(shape, pose.x, pose.y)
            expected = shape.distance(shapely.Point(centre))
        assert movers.gap(0.0, pose, footprint) == pytest.approx(expected - radius, abs=1e-9)


def test_who_is_not_there_touches_nobody():
    movers = Movers([Mover(0.3, TIMES, POINTS, "vanish")])
    assert movers.gap(0.0, Pose2D(0.0, 0.0), Footprint.disc(0.3)) == math.inf
    assert movers.gap(1.0, Pose2D(0.0, 0.0), Footprint.disc(0.3)) < 0.0
    assert Movers([]).at(0.0).shape == (0, 2)


@pytest.mark.parametrize(
    ("mover", "message"),
    [
        (Mover(0.3, TIMES[:2], POINTS), "mover 0 has times of shape"),
        (Mover(0.3, TIMES[::-1], POINTS), "do not rise"),
        (Mover(0.3, TIMES, POINTS * math.nan), "not finite"),
        (Mover(0.0, TIMES, POINTS), "radius of 0.0 m: expected more than 0"),
        (Mover(0.3, TIMES, POINTS, "lop"), "did you mean 'loop'"),
    ],
)
def test_a_malformed_mover_is_refused(mover, message):
    with pytest.raises(ScenarioError, match=message):
        Movers([mover])

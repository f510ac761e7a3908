import numpy as np
import pytest

from dynastar.simulation.legs import APART, LEG_RADIUS, STEP, Legs


def walk(speed=1.2, seconds=4.0, period=0.05):
    """Feet (k, 2, 2) and places (k, 2) of a person who walks along y."""
    legs, places = Legs(1), [np.array([[1.0, speed * t]]) for t in np.arange(0.0, seconds, period)]
    discs = np.array([legs.discs(place) for place in places])
    assert (discs[..., 2] == LEG_RADIUS).all()
    return discs[1:, :, :2], np.array(places)[1:, 0]


def test_the_middle_of_the_two_feet_is_where_the_person_is():
    feet, places = walk()
    assert feet.mean(axis=1) == pytest.approx(places)
    assert feet[:, 0, 0] - feet[:, 1, 0] == pytest.approx(APART)


def test_one_foot_stands_while_the_other_swings_past_it_by_a_step():
    feet, _ = walk(speed=1.2)
    speeds = np.diff(feet[:, :, 1], axis=0) / 0.05
    slow, fast = np.sort(speeds, axis=1)[:-1].T
    assert np.median(slow) == pytest.approx(0.0, abs=1e-6)
    assert np.median(fast) == pytest.approx(2.4)
    assert np.abs(np.diff(feet[:, :, 1], axis=1)).max() == pytest.approx(STEP, abs=0.1)


def test_a_person_who_stands_keeps_the_feet_still():
    legs = Legs(2)
    here = np.array([[0.0, 0.0], [np.nan, np.nan]])
    legs.discs(here)
    first, again = legs.discs(here + [0.3, 0.0]), legs.discs(here + [0.3, 0.0])
    assert np.array_equal(first, again, equal_nan=True)
    assert np.isnan(first[[1, 3], 0]).all()

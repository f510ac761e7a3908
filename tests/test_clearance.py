import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from dynastar.clearance import FAR, WIDE, distance_field, inflate
from naive import clearance, distances


@given(st.integers(0, 10**6), st.floats(0.01, 0.5), st.sampled_from([0.05, 1.0]))
def test_distance_field_is_exact(seed, density, resolution):
    rng = np.random.default_rng(seed)
    blocked = rng.random(rng.integers(1, 30, 2)) < density
    field = distance_field(blocked, resolution)
    assert field.dtype == np.float32
    if blocked.any():
        np.testing.assert_allclose(field, distances(blocked) * resolution, rtol=1e-6)
    else:
        assert (field == np.float32(FAR)).all()


def test_distance_field_is_exact_far_away():
    blocked = np.zeros((700, 900), dtype=bool)
    blocked[3, 5] = True
    field = distance_field(blocked, 1.0)
    assert field[699, 899] == pytest.approx(math.hypot(696, 894), rel=1e-6)


@pytest.mark.parametrize("radius", [0.0, 0.3, 0.5, 0.51, 0.8, 1.5, 2.0, 3.7])
@pytest.mark.parametrize("outside", [True, False])
@pytest.mark.parametrize("wide", [0, WIDE])
def test_inflation_is_exact(radius, outside, wide, monkeypatch):
    monkeypatch.setattr("dynastar.clearance.WIDE", wide)
    rng = np.random.default_rng(7)
    for _ in range(3):
        blocked = rng.random((14, 11)) < 0.05
        inflated = inflate(blocked, radius, outside)
        for r, c in np.ndindex(blocked.shape):
            near = clearance(blocked, [(r + 0.5, c + 0.5)], outside) < radius
            assert inflated[r, c] == (near or blocked[r, c])


def test_inflation_leaves_its_argument_alone():
    blocked = np.eye(4, dtype=bool)
    for radius in (0.0, 1.5):
        inflate(blocked, radius)[:] = True
    assert (blocked == np.eye(4)).all()


def test_a_radius_far_beyond_the_map_takes_no_room():
    blocked = np.zeros((20, 30), bool)
    assert inflate(blocked, 1e5).all()
    assert not inflate(blocked, 1e5, outside_blocked=False).any()
    blocked[3, 4] = True
    assert inflate(blocked, 1e5, outside_blocked=False).all()

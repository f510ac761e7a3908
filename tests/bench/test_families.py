import numpy as np
import pytest

from dynastar.bench.families import KINDS, draw


@pytest.mark.parametrize("size", [20, 40, 128])
@pytest.mark.parametrize("kind", KINDS)
def test_maps_are_drawn_alike_and_differ_by_number_and_seed(kind, size):
    drawn = [draw(kind, number, 3, size) for number in range(30)]
    kept = [made for made in drawn if made is not None]
    assert len(kept) >= 10
    for made in kept:
        assert made.occupied.shape == (size, size)
        assert not made.occupied[made.start]
        assert not made.occupied[made.goal]
        assert max(made.start) <= size / 6
        assert min(made.goal) >= size - 1 - size / 6
        assert 0.05 < made.occupied.mean() < 0.7
    again = draw(kind, kept[0].number, 3, size)
    assert (again.occupied == kept[0].occupied).all()
    other = draw(kind, kept[0].number, 4, size)
    assert other is None or (other.occupied != kept[0].occupied).any()
    assert (kept[0].occupied != kept[1].occupied).any()


def test_random_maps_are_as_dense_as_they_say():
    density = [made.occupied.mean() for n in range(100) if (made := draw("random", n)) is not None]
    assert 0.08 < min(density) < 0.14
    assert max(density) < 0.38
    assert np.std(density) > 0.03

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.planning.neighbours import components
from dynastar.planning.parts import find_parts
from dynastar.planning.search import SearchGrid


@given(st.integers(0, 10**9))
@settings(max_examples=200, deadline=None)
def test_parts_are_the_connected_components(seed):
    rng = np.random.default_rng(seed)
    rows, columns = rng.integers(1, 40, 2)
    blocked = rng.random((rows, columns)) < rng.choice([0.02, 0.2, 0.4, 0.6, 1.0])
    parts = find_parts(SearchGrid(blocked).near)
    numbers = parts.at(np.arange(rows)[:, None], np.arange(columns))
    expected = components(~blocked)
    pairs = np.unique(np.stack([numbers.ravel(), expected.ravel()]), axis=1)
    assert ((numbers == 0) == blocked).all()
    assert len(set(pairs[0])) == len(set(pairs[1])) == pairs.shape[1]
    cells = rng.integers((0, 0), (rows, columns), (5, 2))
    assert (parts.at(*cells.T) == numbers[tuple(cells.T)]).all()


def test_a_spiral_is_one_part():
    blocked = np.zeros((101, 101), bool)
    for ring in range(1, 50, 2):
        blocked[ring, ring:-ring] = blocked[-ring - 1, ring:-ring] = True
        blocked[ring:-ring, ring] = blocked[ring:-ring, -ring - 1] = True
    shut = find_parts(SearchGrid(blocked).near)
    assert shut.number.max() == 26
    blocked[1:-1:2, 50] = False
    assert find_parts(SearchGrid(blocked).near).number.max() == 1

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

import naive
from dynastar.planning.neighbours import components


@given(st.integers(0, 10**9))
@settings(max_examples=100, deadline=None)
def test_components_are_what_legal_steps_connect(seed):
    rng = np.random.default_rng(seed)
    blocked = rng.random(rng.integers(1, 15, 2)) < rng.choice([0.2, 0.4, 0.6])
    parts = components(~blocked)
    assert ((parts == 0) == blocked).all()
    for cell in np.argwhere(~blocked)[:5]:
        reached = naive.shortest(blocked, tuple(map(int, cell)))
        assert {tuple(c) for c in np.argwhere(parts == parts[tuple(cell)])} == set(reached)

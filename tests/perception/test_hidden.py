import math

import numpy as np
import pytest

from dynastar.clearance import FAR
from dynastar.perception.hidden import COARSENING, HIDDEN_RADIUS, HiddenSpace

N, CELL, SPEED = 120, 0.05, 0.5  # 6 x 6 m
NONE = np.zeros((N, N), bool)


def box(x0, y0, x1, y1):
    mask = NONE.copy()
    mask[round(y0 / CELL) : round(y1 / CELL), round(x0 / CELL) : round(x1 / CELL)] = True
    return mask


def space(speed=SPEED):
    return HiddenSpace(N, CELL, speed)


def distance_at(hidden, x, y):
    field = hidden.distance
    row, column = int((y - field.y0) / field.resolution), int((x - field.x0) / field.resolution)
    return float(field.values[row, column])


def test_what_is_seen_now_is_cleared_and_all_that_is_unseen_may_hold_a_person():
    hidden = space().update((0, 0), box(0.0, 0.0, 3.0, 6.0), NONE, 0.0)
    assert distance_at(hidden, 4.5, 3.0) == 0.0
    for x in (0.5, 1.5, 2.5):
        assert distance_at(hidden, x, 3.0) == pytest.approx(3.0 - x + HIDDEN_RADIUS, abs=0.15)


def test_where_all_is_seen_there_is_no_hidden_person():
    hidden = space().update((0, 0), ~NONE, NONE, 0.0)
    assert (hidden.distance.values == np.float32(FAR)).all()


def test_the_distance_is_that_to_the_nearest_body_that_fits():
    """Against all pairs of cells, on random scenes."""
    random = np.random.default_rng(5)
    for _ in range(4):
        seen, solid = ~NONE, NONE.copy()
        for mask, value in ((seen, False), (seen, False), (solid, True)):
            r, c = random.integers(0, 90, 2)
            mask[r : r + random.integers(6, 50), c : c + random.integers(6, 50)] = value
        seen &= ~solid
        hidden = space().update((0, 0), seen, solid, 0.0)
        blocks = seen.reshape(60, 2, 60, 2).transpose(0, 2, 1, 3).reshape(60, 60, 4)
        clear = np.argwhere(blocks.all(axis=2))
        hard = np.argwhere(solid.reshape(60, 2, 60, 2).any(axis=(1, 3)))
        bodies = []
        for cell in np.ndindex(60, 60):
            to_clear = np.hypot(*(clear - cell).T).min() * 0.1
            to_hard = np.hypot(*(hard - cell).T).min(initial=math.inf) * 0.1
            if min(to_clear, to_hard) >= HIDDEN_RADIUS + 0.03 and to_clear <= to_hard:
                bodies.append(cell)
        for cell in bodies:  # a person certainly fits there
            assert hidden.distance.values[cell] <= 0.15


def test_behind_a_wall_a_person_is_only_where_a_body_fits():
    wall = box(3.0, 0.0, 3.1, 6.0)
    narrow = box(3.1, 0.0, 3.5, 6.0)  # 0.4 m unseen behind it, then seen again
    hidden = space().update((0, 0), ~wall & ~narrow, wall, 0.0)
    assert (hidden.distance.values == np.float32(FAR)).all()
    wide = box(3.1, 2.0, 4.1, 4.0)
    hidden = space().update((0, 0), ~wall & ~wide, wall, 0.0)
    assert distance_at(hidden, 3.6, 3.0) <= 0.15
    assert distance_at(hidden, 5.0, 3.0) == pytest.approx(5.0 - 4.1 + HIDDEN_RADIUS, abs=0.2)


@pytest.mark.parametrize("speed", [0.3, 0.5, 1.0])
def test_a_cell_stays_cleared_as_long_as_a_person_needs_to_get_there(speed):
    hiding, left = space(speed), box(0.0, 0.0, 4.0, 6.0)
    hiding.update((0, 0), left, NONE, 0.0)  # a person may stand beyond x = 4
    x = 2.0
    free_for = (4.0 - x) / speed
    for now in np.arange(0.1, free_for + 1.0, 0.1):
        hidden = hiding.update((0, 0), NONE, NONE, float(now))
        near = distance_at(hidden, x, 3.0)
        if now < free_for - 0.5:
            assert near > 0.0
        if now > free_for + 0.3 / speed:
            assert near < HIDDEN_RADIUS + 0.15
    assert near < HIDDEN_RADIUS + 0.15


def test_a_person_comes_no_nearer_than_by_walking_when_nothing_more_is_seen():
    hiding = space()
    before = hiding.update((0, 0), box(0.0, 0.0, 4.0, 6.0), NONE, 0.0).distance.values.copy()
    after = hiding.update((0, 0), NONE, NONE, 2.0).distance.values
    assert (after >= before - SPEED * 2.0 - 0.25).all()
    assert (after <= before + 1e-6).all()


def test_it_moves_along_with_the_local_map():
    hiding = space()
    hiding.update((0, 0), box(0.0, 0.0, 3.0, 6.0), NONE, 0.0)
    hidden = hiding.update((20, -40), NONE, NONE, 0.1)
    assert (hidden.distance.x0, hidden.distance.y0) == pytest.approx((-2.0, 1.0))
    assert hidden.distance.resolution == pytest.approx(CELL * COARSENING)
    assert distance_at(hidden, 1.5, 3.0) > 0.8
    assert distance_at(hidden, -1.0, 3.0) == 0.0  # has come in unseen


def test_after_forgetting_nothing_is_cleared():
    hiding = space()
    hiding.update((0, 0), ~NONE, NONE, 0.0)
    hiding.forget()
    assert (hiding.update((0, 0), NONE, NONE, 0.1).distance.values == 0.0).all()

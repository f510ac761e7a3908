"""Walkers who are put in, and movers that go on from now."""

import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from dynastar.geometry import Pose2D
from dynastar.grid import OccupancyGrid
from dynastar.play.walkers import from_now, gone, walker
from dynastar.robot import ROBOTS
from dynastar.simulation import Mover, Scenario, World
from dynastar.simulation.movers import Movers

GRID, START = OccupancyGrid(np.zeros((12, 12), np.int8), 0.5), Pose2D(0.5, 0.5, 0.0)
ROOM = World(Scenario("room", GRID, ROBOTS["pioneer3dx"], START, ()), START)  # 6 m x 6 m


@given(
    st.floats(0.4, 5.6), st.floats(0.4, 5.6), st.floats(-1.5, 1.5), st.floats(-1.5, 1.5),
    st.floats(0.0, 100.0),
)  # fmt: skip
def test_they_begin_where_they_are_put_and_never_touch_a_wall(x, y, vx, vy, now):
    made = walker(np.array([x, y]), np.array([vx, vy]), 0.25, now, ROOM.gaps)
    movers = Movers([made])
    assert movers.at(now)[0] == pytest.approx((x, y), abs=1e-9)
    speed = np.hypot(vx, vy)
    last = None
    for time in now + np.linspace(0.0, 30.0, 301):
        place = movers.at(time)[0]
        assert (place >= 0.25 - 1e-6).all()
        assert (place <= 5.75 + 1e-6).all()
        if last is not None:
            assert np.hypot(*(place - last)) <= 0.1 * speed + 1e-6
        last = place


def test_they_walk_as_they_were_sent_and_come_back():
    made = walker(np.array([3.0, 3.0]), np.array([0.5, 0.0]), 0.25, 2.0, ROOM.gaps)
    movers = Movers([made])
    assert movers.at(4.0)[0] == pytest.approx((4.0, 3.0))
    xs = [movers.at(2.0 + t)[0][0] for t in np.linspace(0.0, 60.0, 601)]
    assert max(xs) == pytest.approx(5.75, abs=0.12)
    assert min(xs) == pytest.approx(0.25, abs=0.12)


@pytest.mark.parametrize("velocity", [(0.0, 0.0), (1.0, 0.0)])
def test_without_room_or_speed_they_stand(velocity):
    gaps = ROOM.gaps if velocity == (0.0, 0.0) else lambda points: np.zeros(len(points))
    made = walker(np.array([3.0, 3.0]), np.array(velocity), 0.25, 0.0, gaps)
    assert Movers([made]).at(100.0)[0].tolist() == [3.0, 3.0]


def test_gone_is_nowhere():
    assert np.isnan(Movers([gone(0.3)]).at(5.0)).all()
    assert from_now(gone(0.3), 5.0, 100.0) is None


@given(
    st.lists(st.floats(0.1, 5.0), min_size=1, max_size=5),
    st.floats(0.0, 3.0),
    st.sampled_from(["loop", "back_and_forth", "stay", "vanish"]),
    st.floats(0.0, 40.0),
    st.integers(0, 1000),
)
@example([0.1], 0.0, "loop", 1.0, 0)  # now is at a jump, up to rounding
def test_a_mover_goes_on_from_now_as_it_would_have(steps, begin, after, now, seed):
    times = begin + np.cumsum([0.0, *steps])
    points = np.random.default_rng(seed).uniform(-5.0, 5.0, (len(times), 2))
    mover = Mover(0.3, times, points, after)
    later = from_now(mover, now, 30.0)
    for t in np.linspace(0.013, 29.9, 97):
        expected = Movers([mover]).at(now + t)[0]
        if later is None:
            assert np.isnan(expected).all()
            continue
        found = Movers([later]).at(t)[0]
        spans = times[-1] - times[0]
        near_jump = after == "loop" and abs((now + t - begin) % spans) < 0.01
        near_jump |= after == "loop" and spans - abs((now + t - begin) % spans) < 0.01
        if not near_jump:
            assert found == pytest.approx(expected, abs=1e-4, nan_ok=True)

"""Who may step out of hiding, and how fast the robot goes for it."""

import math
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from dynastar.grid import OccupancyGrid
from dynastar.navigator import lookout_kernels
from dynastar.navigator.chart import Chart
from dynastar.navigator.config import NavigatorConfig
from dynastar.navigator.lookout import COME, EVERY, NEAR, RADIUS, SLOW, Lookout, View
from dynastar.navigator.lookout_kernels import careful, lanes, lanes_of, shut_discs, touches
from dynastar.obstacles import ObstacleLayer, Tracker
from dynastar.path import Path
from dynastar.robot import ROBOTS

N, CELL = 160, 0.05
ROBOT = ROBOTS["paper"]
NOW = 10.0
PATH = np.column_stack([0.2 * np.arange(1, 16), np.full(15, 4.0)])  # along y = 4 in 8 x 8 m


def view(hidden=(), solid=()):
    """All seen free just now, but for rectangles (x0, y0, x1, y1)."""
    free_at, solids = np.full((N, N), NOW), np.zeros((N, N), bool)
    for x0, y0, x1, y1 in hidden:
        free_at[round(y0 / CELL) : round(y1 / CELL), round(x0 / CELL) : round(x1 / CELL)] = -np.inf
    for x0, y0, x1, y1 in solid:
        solids[round(y0 / CELL) : round(y1 / CELL), round(x0 / CELL) : round(x1 / CELL)] = True
    return View(free_at, solids, 0.0, 0.0, CELL, NOW - 0.35)


def test_nobody_hides_where_all_is_seen_free():
    assert len(lanes(PATH, view(), RADIUS, COME, NEAR)) == 0


def test_somebody_may_come_out_of_a_side_street():
    """It is 1 m wide, from y = 5, and hidden from y = 5.5."""
    walls = [(0.0, 5.0, 1.5, 8.0), (2.5, 5.0, 8.0, 8.0)]
    found = lanes(PATH, view([(1.5, 5.5, 2.5, 8.0)], walls), RADIUS, COME, NEAR)
    assert len(found)
    x, y, ux, uy = found.T
    assert ((x > 1.5 + RADIUS - CELL) & (x < 2.5 - RADIUS + CELL)).all()
    assert (y >= 5.5 + RADIUS - CELL).all()
    assert y.min() < 5.5 + RADIUS + 0.15
    assert (uy < -0.7).all()  # straight or almost, for the walls leave no more
    assert np.hypot(ux, uy) == pytest.approx(1.0)


@pytest.mark.parametrize(
    ("hidden", "solid"),
    [
        pytest.param([(1.5, 5.5, 2.5, 6.5)], [(1.5, 6.5, 2.5, 8.0)], id="too short to come along"),
        pytest.param([(1.8, 5.5, 2.3, 8.0)], [], id="too narrow to hide in"),
        pytest.param([(1.5, 5.5, 2.5, 8.0)], [(0.0, 5.0, 8.0, 5.3)], id="behind a wall"),
        pytest.param([(1.5, 7.3, 2.5, 8.0)], [], id="too far away"),
    ],
)
def test_nobody_is_expected_from_where_nobody_can_come(hidden, solid):
    walls = [(0.0, 5.0, 1.5, 8.0), (2.5, 5.0, 8.0, 8.0), *solid]
    assert len(lanes(PATH, view(hidden, walls), RADIUS, COME, NEAR)) == 0


@given(st.integers(0, 10**6))
@settings(max_examples=30, deadline=None)
def test_every_lane_leads_out_of_hiding_through_open_space_onto_the_path(seed):
    rng = np.random.default_rng(seed)
    boxes = rng.uniform(0.5, 7.5, (8, 2))
    solid = [(x, y, x + 0.5, y + 0.5) for x, y in boxes if abs(y - 3.75) > 0.7]
    sight = view([(x, y, x + 1.5, y + 1.5) for x, y in rng.uniform(0.0, 6.4, (6, 2))], solid)
    found = lanes(PATH, sight, RADIUS, COME, NEAR)
    assume(len(found) > 0)
    for x, y, ux, uy in found:
        back = np.arange(-COME + 0.05, NEAR, 0.1)
        t = (4.0 - y) / uy if abs(uy) > 1e-6 else (PATH[:, 0] - x) / ux
        t = np.atleast_1d(t)[np.atleast_1d(t) > 0.0].min()
        assert t <= NEAR + 0.11
        rows, columns = (
            np.floor((start + back[back < t] * u) / CELL).astype(int)
            for start, u in ((y, uy), (x, ux))
        )
        assert not sight.solid[rows, columns].any()
        assert sight.free_at[int(y / CELL), int(x / CELL)] < sight.since


@pytest.mark.parametrize("phase", np.linspace(0.0, 0.2, 9)[:-1])
def test_a_gap_a_little_wider_than_somebody_is_not_missed(phase):
    """0.67 m between two corners, at 45 degrees to the path, wherever on it the robot is."""
    blocks = [(3.45, 4.5, 5.5, 5.5), (1.0, 6.0, 3.0, 8.0)]
    x = np.arange(phase, 3.0, EVERY)
    path = np.column_stack([x, np.full_like(x, 4.0)])
    found = lanes(path, view([(3.0, 5.7, 8.0, 8.0)], blocks), RADIUS, COME, NEAR)
    assert np.isclose(found[:, 2:], -math.sqrt(0.5)).all(axis=1).any()


def test_it_looks_ahead_until_whoever_is_near_has_come():
    for pace in (0.25, 0.5):
        slow = NavigatorConfig()._replace(hidden_speed=pace)
        assert Lookout(ROBOT, slow).look * pace == pytest.approx(NEAR)


def test_nobody_comes_through_what_is_known_to_move():
    walls = [(0.0, 5.0, 1.5, 8.0), (2.5, 5.0, 8.0, 8.0)]
    street = view([(1.5, 5.5, 2.5, 8.0)], walls)
    shut_discs(np.array([[2.0, 5.2, 0.55]]), street)
    assert street.solid[round(5.2 / CELL), round(2.0 / CELL)]
    assert not street.solid[round(4.4 / CELL), round(2.0 / CELL)]
    assert len(lanes(PATH, street, RADIUS, COME, NEAR)) == 0
    shut_discs(np.array([[-3.0, 4.0, 0.5], [8.1, 20.0, 0.5]]), street)  # off the view


def test_who_has_just_come_into_view_may_come_onto_the_path_from_there():
    walls = [(0.0, 5.0, 1.5, 8.0), (2.5, 5.0, 8.0, 8.0)]
    face = (1.75, 5.6, 2.25, 5.7)  # all that is seen of whoever stands at (2, 5.85)
    street = view([(1.5, 5.7, 2.5, 8.0)], [*walls, face])
    assert len(lanes(PATH, street, RADIUS, COME, NEAR)) == 0
    found = lanes_of(np.array([[2.0, 5.85, 0.25]]), PATH, street, RADIUS, NEAR)
    assert len(found)
    assert (found[:, :2] == (2.0, 5.85)).all()
    for x, y, ux, uy in found:
        onto = x + ux * (4.0 - y) / uy
        assert np.abs(PATH[:, 0] - onto).min() < 1e-9
        assert 1.0 < onto < 3.0  # the walls leave no more
    wide = (1.5, 5.22, 2.5, 5.35)  # of whoever is as wide as the street
    broad = view([(1.5, 5.35, 2.5, 8.0)], [*walls, wide])
    assert len(lanes_of(np.array([[2.0, 5.85, 0.25]]), PATH, broad, RADIUS, NEAR)) == 0
    assert len(lanes_of(np.array([[2.0, 5.85, 0.55]]), PATH, broad, RADIUS, NEAR))
    behind = view([], [*walls, face, (1.0, 4.3, 3.0, 4.5)])
    assert len(lanes_of(np.array([[2.0, 5.85, 0.25]]), PATH, behind, RADIUS, NEAR)) == 0
    assert (
        len(lanes_of(np.array([[2.0, 7.5, 0.25]]), PATH, street, RADIUS, NEAR)) == 0
    )  # too far away


AHEAD = np.column_stack([0.1 * np.arange(60), np.zeros(60)])
RATES, REACTION = (0.2, 0.2), 0.4
WHO = (0.75, RATES, REACTION, 0.0, 0.5, 4.0)  # within 0.75 m, comes at 0.5 m/s


def touches_slowly(lane, v, aim, last, apart, rates, reaction, tail, speed, seconds):
    """The same in steps of a millisecond and for many behind each other; by how much they miss."""
    s, gap = 0.0, math.inf
    for t in np.arange(0.001, seconds, 0.001):
        to = aim if t <= reaction else last
        v += min(max(to - v, -rates[0] * 0.001), rates[1] * 0.001)
        if v == last == 0.0:
            break
        s += v * 0.001
        if s >= 0.1 * (len(AHEAD) - 1):
            break
        for back in np.linspace(0.0, tail, 20):
            on = speed * t - back
            gap = min(gap, math.hypot(s - lane[0] - on * lane[2], lane[1] + on * lane[3]))
    return gap - apart


@given(
    st.floats(0.1, 1.0),
    st.floats(-0.2, 0.2),
    st.sampled_from([-0.5, 0.0, 0.8]),
    st.floats(0.5, 3.0),
    st.floats(0.5, 3.0),
    st.floats(0.0, math.tau),
    st.sampled_from([0.0, 1.2]),
)
@settings(max_examples=60, deadline=None)
def test_who_touches_whom_is_as_in_small_steps(v, more, last, onto, away, angle, tail):
    ux, uy = math.cos(angle), math.sin(angle)
    lane = np.array([onto - away * ux, -away * uy, ux, uy])
    aim = max(v + more, 0.05)
    last = max(last, aim) if last > 0.0 else last
    who = (*WHO[:3], tail, *WHO[4:])
    exact = touches_slowly(lane, v, aim, last, *who)
    found = touches(lane, AHEAD, 0.1, v, aim, last, *who)
    assert found == (exact < 0.0) or abs(exact) < 0.1


def choice(lane, v, speeds, back=0.0, top=0.8, spare=0.0):
    apart, *rest = WHO
    return careful(np.array(lane), AHEAD, 0.1, v, np.array(speeds), back, top, apart, spare, *rest)


def can_be(lane, v, back=0.0, top=0.8):
    """Whether the robot can go on at ``v`` and stop in time, or be past."""
    return choice(lane, v, [v, 9.0], back, top) == v


CROSSING = [[1.5, 1.6, 0.0, -1.0]]  # comes within 0.75 m of the path after 1.7 s


def test_the_robot_goes_so_slowly_that_it_could_stop_or_so_fast_that_it_is_past():
    assert can_be(CROSSING, 0.4)
    assert not can_be(CROSSING, 0.5)  # stops after 0.2 + 0.625 m
    assert not can_be(CROSSING, 0.8)
    assert can_be(CROSSING, 1.6)
    assert can_be([[1.5, 7.6, 0.0, -1.0]], 0.5)  # far away
    assert can_be(np.empty((0, 4)), 0.5)


def test_going_on_takes_more_room_than_standing():
    later = [[1.5, 2.0, 0.0, -1.0]]
    for v, room in ((0.5, 0.5), (0.8, 9.0)):  # stops in time; would be past, not by 0.3 m
        assert choice(later, v, [v, 9.0]) == v
        assert choice(later, v, [v, 9.0], spare=0.3) == room


def test_a_speed_counts_from_when_the_robot_can_have_it():
    """At 0.2 m/s2, from 0.5 m/s it has 0.42 m/s at the soonest after the reaction."""
    assert 0.4 < choice(CROSSING, 0.5, np.arange(0.6, 0.3, -0.01)) < 0.48
    assert choice(CROSSING, 0.6, np.arange(0.7, 0.3, -0.01)) == pytest.approx(0.31)  # too fast
    assert choice(CROSSING, 0.4, [1.6, 0.4]) == 0.4  # would be past if it were so fast already


def test_who_cannot_be_avoided_at_one_speed_is_not_forgotten_at_the_next():
    both = [[1.5, 8.0, 0.0, -1.0], *CROSSING, [0.5, 0.8, 0.0, -1.0]]
    assert choice(both[:2], 0.5, [0.5, 0.45, 0.3]) == choice(CROSSING, 0.5, [0.5, 0.45, 0.3])
    assert choice(both, 0.5, [0.5, 0.3, 0.1]) == 0.1  # the last of them, at any speed


def test_who_comes_a_little_later_counts_as_well():
    """The first would be past before the robot is there, and those behind them come as it is."""
    lane = np.array([1.7, 0.9, 0.0, -1.0])
    first, all_of_them = (
        touches(lane, AHEAD, 0.1, 0.6, 0.6, 0.0, 0.75, RATES, REACTION, tail, 0.8, 6.0)
        for tail in (0.0, 1.2)
    )
    assert not first
    assert all_of_them


def test_who_would_be_at_the_robots_back_already_does_not_hold_it_up():
    assert can_be([[-0.7, 0.0, 1.0, 0.0]], 0.6)
    assert not can_be([[0.8, 0.0, -1.0, 0.0]], 0.6)


def test_who_may_back_out_of_the_way_does_not_wait_in_it():
    late = [[1.2, 1.8, 0.0, -1.0]]
    stays, backs = (
        max(v for v in np.arange(0.04, 0.6, 0.02) if can_be(late, v, back, top=0.0))
        for back in (0.0, 0.5)
    )
    assert backs < stays  # where it would rest it would be run over
    assert abs(1.2 - REACTION * stays - stays**2 / 0.4) < 0.75
    assert not touches(np.array(late[0]), AHEAD, 0.1, backs, backs, -0.5, *WHO)


GRID = OccupancyGrid.from_text(
    "\n".join(["....#.....", "....#.....", "....#....."] + ["." * 10] * 3)
)


def speed_at_a_corner(v, config=NavigatorConfig(), robot=ROBOT):
    """Along the lower half of a map whose upper half was never seen, right of a wall."""
    layer, chart = ObstacleLayer(), Chart(GRID, config, 0.4, 0.4)
    layer.follow(3.0, 1.5)
    x0, y0 = layer.origin
    a = layer.config.resolution
    rows, columns = np.mgrid[: len(layer.free_at), : len(layer.free_at)]
    seen = (y0 + (rows + 0.5) * a < 2.6) | (x0 + (columns + 0.5) * a < 4.0)
    layer.free_at[seen] = NOW
    layer.update(NOW)
    path = Path(np.array([(3.5, 1.8), (9.5, 1.8)]))
    return Lookout(robot, config).speed(NOW, v, 1.0, path, 0.0, layer, chart, Tracker())


def test_a_robot_slows_down_where_the_map_leaves_room_to_come_out_of():
    assert speed_at_a_corner(0.8) < 0.8
    assert speed_at_a_corner(SLOW) >= SLOW
    assert speed_at_a_corner(0.0) >= SLOW
    assert speed_at_a_corner(0.8, NavigatorConfig(hidden_speed=0.0)) == 1.0


def test_who_can_back_looks_out_for_where_it_would_stand():
    ahead, both = (
        replace(ROBOT, limits=ROBOT.limits._replace(v_accel=0.2, v_brake=0.2, v_min=v_min))
        for v_min in (0.0, -0.5)
    )
    speeds = np.arange(0.1, 1.0, 0.05)
    of_ahead, of_both = (
        np.array([speed_at_a_corner(v, robot=robot) for v in speeds]) for robot in (ahead, both)
    )
    assert (of_both <= of_ahead).all()
    assert (of_both < of_ahead).any()


class Seen:
    """A tracker with newcomers (n, 3): x, y, radius, and nobody who walks."""

    def __init__(self, *discs):
        self.discs = np.array(discs, float).reshape(-1, 3)

    def newcomers(self):
        return self.discs

    def in_sight(self):
        return self.discs[:0]


def test_for_who_is_in_sight_the_robot_goes_as_slowly_as_it_takes():
    config, slow = NavigatorConfig(), replace(ROBOT, limits=ROBOT.limits._replace(v_accel=0.2))
    layer, chart = ObstacleLayer(), Chart(GRID, config, 0.4, 0.4)
    layer.follow(3.0, 1.5)
    layer.free_at[:] = NOW
    layer.update(NOW)
    path = Path(np.array([(3.5, 1.8), (9.5, 1.8)]))
    look = Lookout(slow, config)

    def speed(tracker):
        return look.speed(NOW, SLOW, 1.0, path, 0.0, layer, chart, tracker)

    assert speed(Seen()) > SLOW
    assert speed(Seen((4.6, 1.8, 0.25))) < SLOW  # would come towards it
    assert speed(Seen((9.0, 1.8, 0.25))) > SLOW


def test_a_longer_latency_is_a_longer_reaction():
    late = Lookout(ROBOT, NavigatorConfig()._replace(latency=0.3))
    assert late.reaction == pytest.approx(Lookout(ROBOT, NavigatorConfig()).reaction + 0.3)
    big = replace(ROBOT, footprint=ROBOTS["jackal"].footprint)
    assert Lookout(big, NavigatorConfig()).apart > late.apart
    assert late.spare == pytest.approx(0.15 + 1.5 * 0.1)  # margin, and what movers may stray


def test_who_hides_may_be_further_back_and_who_is_in_sight_is_where_they_are(monkeypatch):
    tails = []

    def spy(*given):
        tails.append(given[-3])
        return careful(*given)

    monkeypatch.setattr(lookout_kernels, "careful", spy)
    layer, chart = ObstacleLayer(), Chart(GRID, NavigatorConfig(), 0.4, 0.4)
    layer.follow(3.0, 1.5)
    layer.free_at[:] = NOW
    layer.update(NOW)
    path = Path(np.array([(3.5, 1.8), (9.5, 1.8)]))
    seen = Seen((4.6, 1.8, 0.25))
    Lookout(ROBOT, NavigatorConfig()).speed(NOW, 0.5, 1.0, path, 0.0, layer, chart, seen)
    assert tails == [COME, 0.0]

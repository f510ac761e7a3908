"""Random static worlds: seeded, a way exists or none does, and narrow ways are as wide as the rule says."""

from itertools import islice
from types import SimpleNamespace

import numpy as np
import pytest
import shapely

from dynastar.bench.missions import Options
from dynastar.bench.suites import random_worlds as suite
from dynastar.bench.suites.random_kinds import KINDS
from dynastar.bench.suites.random_layout import CAREFUL, CELL, SPARE, Layout, StaticWorld, narrow
from dynastar.bench.suites.random_truth import TrueSpace
from dynastar.footprint import Footprint, box
from dynastar.geometry import Pose2D
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.robot import ROBOTS
from dynastar.simulation.contact import Solids

NUMBERS = range(18)
LEFT_OUT = {1: "no way with room for a careful robot"}  # of seed 0


def test_a_seed_and_a_number_give_the_same_world_and_another_seed_another():
    for number in (0, 5, 17):
        (a, robot, kind), (b, *_) = suite.drawn(3, number), suite.drawn(3, number)
        other = suite.drawn(4, number)[0]
        assert (a.grid.values == b.grid.values).all()
        assert all((x == y).all() for x, y in zip(a.obstacles, b.obstacles, strict=True))
        assert (a.start, a.goal) == (b.start, b.goal)
        assert a.goal != other.goal
        assert suite.drawn(4, number)[1:] == (robot, kind)


def test_numbers_go_through_all_robots_and_kinds():
    found = {suite.drawn(0, number)[2:] + (suite.drawn(0, number)[1].name,) for number in NUMBERS}
    assert found == {(kind, name) for kind in KINDS for name in suite.ROBOT_NAMES}
    assert [m.number for m in islice(suite.missions(Options()), 3)] == [0, 1, 2]


def test_what_nothing_careful_could_drive_is_left_out_and_no_more():
    reasons = {
        m.number: suite.leave_out(m, Options()) for m in islice(suite.missions(Options()), 18)
    }
    assert {number: reason for number, reason in reasons.items() if reason} == LEFT_OUT


@pytest.mark.parametrize("number", sorted(set(NUMBERS) - set(LEFT_OUT)))
def test_missions_can_be_run(number):
    mission = next(islice(suite.missions(Options()), number, None))
    made = suite.scenario(mission, Options(), 0)
    footprint, solids = made.robot.footprint, Solids(made.grid, made.obstacles)
    assert solids.gap(Pose2D(*made.start), footprint) >= suite.START_ROOM
    assert 60.0 < made.time_limit < 400.0
    assert made.noise.range_bound == 0.01
    disc = Footprint.disc(0.9 * footprint.inscribed)
    assert solids.gap(Pose2D(made.goals[0].x, made.goals[0].y), disc) > 0.0


def corridor(gap, length=1.0, board=False, reachable=True, height=4.0):
    """Two rooms with a way of a width between them, which a board may close."""
    layout = Layout(8.0, height, np.random.default_rng(0))
    layout.wall(3.5, 0.0, 3.5 + length, height)
    layout.room(3.5, 2.0, 3.5 + length, 2.0 + np.ceil(gap / CELL - 1e-9) * CELL)
    surplus = np.ceil(gap / CELL - 1e-9) * CELL - gap
    if surplus > 1e-9:
        layout.board(3.5, 2.0, 3.5 + length, 2.0 + surplus)
    if board:
        layout.board(3.8, 1.9, 3.9, 2.1 + gap)
    return layout.finished((1.5, 2.1, 0.0), (6.5, 2.1), reachable)


@pytest.mark.parametrize("name", suite.ROBOT_NAMES)
def test_ways_of_the_rules_width_are_ways_and_narrower_ones_are_left_out(name):
    robot = ROBOTS[name]
    width = 2.0 * robot.footprint.inscribed
    least = width + 0.04 + SPARE[0]
    assert least >= width + 2 * CAREFUL
    assert not isinstance(suite.check(corridor(least), robot), str)
    assert "room for a careful robot" in suite.check(corridor(width + 0.05), robot)
    assert suite.check(corridor(width - 0.05), robot) == "no way"


def test_narrow_ways_are_drawn_between_the_rules_limits():
    random = np.random.default_rng(1)
    widths = [narrow(ROBOTS["jackal"].footprint, random) for _ in range(200)]
    assert min(widths) >= 0.43 + 0.04 + 0.1
    assert max(widths) <= 0.43 + 0.04 + 0.3


@pytest.mark.parametrize("name", suite.ROBOT_NAMES)
def test_unreachable_means_closed_for_good(name):
    robot = ROBOTS[name]
    gap = 2.0 * robot.footprint.inscribed + 0.3
    assert not isinstance(suite.check(corridor(gap, board=True, reachable=False), robot), str)
    assert suite.check(corridor(gap, reachable=False), robot) == "the goal may be reached"
    nearly = corridor(2.0 * robot.footprint.inscribed - 0.03, reachable=False)
    assert suite.check(nearly, robot) in ("the goal may be reached", "no way on the map")


def test_a_goal_within_reach_of_the_outside_is_not_unreachable():
    layout = Layout(6.0, 4.0, np.random.default_rng(0))
    for x in (3.8, 4.1):
        layout.board(x, 1.7, x + 0.1, 2.3)
    for y in (1.7, 2.2):
        layout.board(3.8, y, 4.2, y + 0.1)
    world = layout.finished((1.0, 2.0, None), (4.0, 2.0), reachable=False)
    assert suite.check(world, ROBOTS["turtlebot3_burger"]) == "the goal may be reached"


def test_a_polygon_needs_room_to_turn_that_a_disc_of_its_width_does_not():
    """A bend with room to turn for a short box: the inscribed disc gets round, a long box does not."""
    layout = Layout(6.0, 6.0, np.random.default_rng(0))
    layout.occupied[:] = True
    layout.room(0.5, 0.5, 1.2, 5.5)
    layout.room(0.5, 4.8, 5.5, 5.5)
    layout.room(0.4, 4.6, 1.5, 5.6)
    world = layout.finished((0.85, 1.5, None), (4.5, 5.15))
    space, long_box = TrueSpace(world), box(1.2, 0.5)
    start = (0.85, 1.5, np.pi / 2)
    assert space.careful(Footprint.disc(long_box.inscribed), start, world.goal)
    assert not space.careful(long_box, start, world.goal)
    assert space.careful(box(0.55, 0.5), start, world.goal)


def test_a_careful_way_of_a_polygon_starts_with_its_heading():
    layout = Layout(6.0, 2.0, np.random.default_rng(0))
    layout.occupied[:] = True
    layout.room(0.5, 0.6, 5.5, 1.3)
    world = layout.finished((1.2, 0.95, None), (4.5, 0.95))
    space, long_box = TrueSpace(world), box(1.2, 0.5)
    assert space.careful(long_box, (1.2, 0.95, 0.0), world.goal)
    assert space.careful(long_box, (1.2, 0.95, np.pi), world.goal)
    assert not space.careful(long_box, (1.2, 0.95, np.pi / 2), world.goal)


def test_gaps_of_the_true_space_agree_with_the_contact_check():
    world = suite.drawn(0, 1)[0]
    space, solids = TrueSpace(world), Solids(world.grid, world.obstacles)
    random = np.random.default_rng(0)
    for _ in range(300):
        row, column = (int(random.integers(n)) for n in space.gaps.shape)
        x, y = (column + 0.5) * space.cell, (row + 0.5) * space.cell
        exact = solids.gap(Pose2D(x, y), Footprint.disc(0.0))
        assert abs(max(exact, 0.0) - space.gaps[row, column]) <= space.cell


def test_unmapped_things_are_not_on_the_map():
    for number in range(9, 12):
        world = suite.drawn(0, number)[0]
        occupied = np.argwhere(world.grid.occupied)[:, ::-1] * CELL + CELL / 2
        assert world.obstacles
        for ring in world.obstacles:
            inside = shapely.contains_xy(shapely.Polygon(ring).buffer(-CELL), *occupied.T)
            assert inside.mean() < 0.02


def episode(outcome, state):
    return SimpleNamespace(outcome=outcome, states=np.array(["following", state]))


def test_blocked_is_right_only_where_there_is_no_way_and_the_robot_says_so():
    def outcome(reachable, *ended):
        return suite.verdict(episode(*ended), reachable).get("outcome")

    assert outcome(False, "blocked", "blocked") == "blocked_rightly"
    assert outcome(True, "blocked", "blocked") is None
    assert outcome(False, "blocked", "arrived") is None  # it says that it arrived, elsewhere
    assert outcome(False, "timeout", "following") is None
    assert outcome(False, "contact", "blocked") is None


def test_rows_count_blocked_rightly(monkeypatch):
    def run_mission(scenario, options, mission, repeat, *, group, extra, **more):
        return {"outcome": "blocked", "group": group, **extra(episode("blocked", "blocked"))}

    monkeypatch.setattr(suite.driven, "run_mission", run_mission)
    missions = list(islice(suite.missions(Options()), 18))
    kept = [m for m in missions if not suite.leave_out(m, Options())]
    rows = [suite.run_mission(m, Options(), 0) for m in kept]
    for row in rows:
        right = row["group"] == "unreachable"
        assert (row["outcome"] == "blocked_rightly") is right
        assert row["reachable"] is not right
    assert {row["group"] for row in rows} == set(KINDS)


def test_a_world_left_out_cannot_be_run(monkeypatch):
    from dynastar.errors import DataError

    wall = StaticWorld(
        OccupancyGrid(np.eye(60, dtype=bool), GridFrame(CELL)), (), (0.5, 2.0, None), (2.5, 0.5)
    )
    monkeypatch.setattr(suite, "drawn", lambda *_: (wall, ROBOTS["pioneer3dx"], "clutter"))
    suite.make.cache_clear()
    mission = next(iter(suite.missions(Options())))
    assert suite.leave_out(mission, Options()) == "no way"
    with pytest.raises(DataError, match="random 0: no way"):
        suite.scenario(mission, Options(ideal=True), 0)
    suite.make.cache_clear()

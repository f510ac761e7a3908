"""People: the same world for a seed, off the walls, and never without a robot that could avoid them."""

from itertools import islice

import numpy as np
import pytest
import shapely

from dynastar.bench.missions import Options
from dynastar.bench.suites import people as suite
from dynastar.bench.suites import people_crowd, people_routes, people_scripts, people_witness
from dynastar.bench.suites.people_sites import SITES, Site
from dynastar.errors import DataError
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D
from dynastar.grid import OccupancyGrid
from dynastar.path import Path
from dynastar.robot import ROBOTS
from dynastar.simulation import Mover
from dynastar.simulation.contact import Solids, placed_footprint
from dynastar.simulation.crowd import jupedsim_installed
from dynastar.simulation.movers import Movers
from scripted import Still

WALKED_INTO = 1  # a world in which somebody walks into a robot that stays at its start
needs_jupedsim = pytest.mark.skipif(not jupedsim_installed(), reason="needs jupedsim")
NUMBERS = (0, 2, 5, 8, 12, 17, 26, 37)
PIONEER = ROBOTS["pioneer3dx"]


def mission(number):
    return next(islice(suite.missions(Options()), number, None))


def same(a, b):
    walkers = zip(a.walkers, b.walkers, strict=True)
    crowd = zip(a.crowd, b.crowd, strict=True)
    return (
        (a.site.grid.values == b.site.grid.values).all()
        and a.site.start == b.site.start
        and all((p.points == q.points).all() and p.radius == q.radius for p, q in walkers)
        and all((p.waypoints == q.waypoints).all() and p.speed == q.speed for p, q in crowd)
    )


@pytest.mark.parametrize("number", [1, 3, 18])
def test_a_seed_and_a_number_give_the_same_world_and_another_seed_another(number):
    a = suite.make(5, number)
    suite.make.cache_clear()
    assert same(a, suite.make(5, number))
    assert a.site.start != suite.make(6, number).site.start


def test_numbers_go_through_places_robots_and_modes():
    made = [suite.make(0, n) for n in range(20)]
    assert {m.site.kind for m in made} == set(SITES)
    assert {m.robot.name for m in made} == {r.name for r in suite.SUITE_ROBOTS}
    for number, m in enumerate(made):
        assert bool(m.crowd) is (number % 4 == 3) is (suite.mode(number) == "reactive")
        assert 1 <= len(m.walkers or m.crowd) <= 10


@pytest.mark.parametrize("number", NUMBERS)
def test_walkers_keep_clear_of_walls_and_of_the_start(number):
    made = suite.make(0, number)
    solids, movers = Solids(made.site.grid), Movers(made.walkers)
    start = Pose2D(*made.site.start, made.heading)
    for time in np.arange(0.0, made.seconds, 0.35):
        for (x, y), radius in zip(movers.at(time), movers.radii, strict=True):
            assert solids.gap(Pose2D(x, y), Footprint.disc(radius)) > 0.0
        if time <= 3.0:
            assert movers.gap(time, start, made.robot.footprint) >= 0.5


@pytest.mark.parametrize("number", NUMBERS)
def test_walkers_keep_their_speeds_and_sizes(number):
    for walker in suite.make(0, number).walkers:
        speed = np.hypot(*np.diff(walker.points, axis=0).T) / np.diff(walker.times)
        assert speed.max() <= 1.6 + 1e-6
        assert 0.2 <= walker.radius <= 0.5
        assert walker.times[-1] > suite.make(0, number).seconds


def walks(manner, seed=0):
    route = people_routes.Route(np.array([(0.0, 0.0), (20.0, 0.0)]), 1.0)
    random = np.random.default_rng(seed)
    return np.diff(people_scripts.progress(20.0, route, manner, random, 60.0)) / people_scripts.STEP


def test_manners_do_what_they_say():
    steady, pausing, reversing, varying = map(walks, ("steady", "pausing", "reversing", "varying"))
    assert steady[5:190] == pytest.approx(1.0)
    assert steady.min() < -0.9  # turned back at the end
    assert (np.abs(pausing[20:180]) < 1e-9).sum() > 10
    turns = np.flatnonzero(np.diff(np.sign(reversing)) < 0)
    assert len(turns) > 0
    assert reversing[turns[0] + 12] < -0.9  # within about a second
    assert len(set(np.round(varying[np.abs(np.diff(varying, prepend=0.0)) < 1e-9], 3))) > 4
    for speeds in (steady, pausing, reversing, varying):
        assert np.abs(np.diff(speeds)).max() <= 3.0 * people_scripts.STEP + 1e-6


def test_roles_walk_where_they_say():
    made = suite.make(0, 4)
    random = np.random.default_rng(0)
    scene = people_routes.Scene(made.site, made.robot, random, 0.25, made.site.planner(0.33))
    start, goal = np.array(made.site.start), np.array(made.site.goal)

    def ends(role):
        points = people_routes.ROLES[role](scene).points
        return points[0], points[-1]

    begin, end = ends("oncoming")
    assert np.hypot(*(begin - goal)) < np.hypot(*(begin - start))
    assert np.hypot(*(end - start)) < np.hypot(*(end - goal))
    assert people_routes.overtaking(scene).speed > made.robot.limits.v_max
    assert people_routes.slow_ahead(scene).speed < made.robot.limits.v_max
    crossing = people_routes.crossing(scene)
    assert (
        shapely.LineString(crossing.points).distance(shapely.LineString(made.site.way.points)) < 0.3
    )


# The witness.


def independent_check(made, witness):
    """Smallest gaps of a witness to walkers and walls, and that it keeps the robot's limits."""
    limits, step = made.robot.limits, 0.01
    times, poses = people_witness.sampled(witness, made.robot, step)
    walkers, walls = Movers(made.walkers), Solids(made.site.grid)
    to_walkers, to_walls = np.inf, np.inf
    for time, pose in zip(times[::3], poses[::3], strict=True):
        shape = placed_footprint(Pose2D(*pose), made.robot.footprint)
        round_robot = made.robot.footprint.circumscribed if made.robot.footprint.is_disc else 0.0
        away = shapely.distance(shape, shapely.points(walkers.at(time))) - walkers.radii
        to_walkers = min(to_walkers, float(away.min()) - round_robot)
    for pose in poses[::10]:
        to_walls = min(to_walls, walls.gap(Pose2D(*pose), made.robot.footprint))
    delta = np.diff(poses, axis=0) / step
    v = delta[:, 0] * np.cos(poses[1:, 2]) + delta[:, 1] * np.sin(poses[1:, 2])
    omega = delta[:, 2]
    aside = -delta[:, 0] * np.sin(poses[1:, 2]) + delta[:, 1] * np.cos(poses[1:, 2])
    assert np.abs(aside).max() < 1e-6
    assert limits.v_min - 1e-6 <= v.min() <= v.max() <= limits.v_max + 1e-6
    assert np.abs(omega).max() <= limits.omega_max + 1e-6
    assert np.abs(np.diff(v)).max() <= max(limits.v_accel, limits.v_brake) * step + 1e-6
    assert np.abs(np.diff(omega)).max() <= max(limits.omega_accel, limits.omega_brake) * step + 1e-6
    assert np.abs(delta[:30]).max() == 0.0  # at rest while the first command is on its way
    assert np.hypot(*(poses[-1, :2] - made.site.goal)) <= suite.GOAL_TOLERANCE
    assert times[-1] <= made.seconds
    return to_walkers, to_walls


def witness_of(made):
    ends = made.site.start, made.site.goal
    return people_witness.find_witness(
        made.site.grid, made.robot, made.walkers, ends, made.heading, made.seconds
    )


@pytest.mark.parametrize("number", NUMBERS)
def test_witnesses_are_touched_by_nobody_and_nothing(number):
    made = suite.make(0, number)
    witness = witness_of(made)
    assert witness is not None
    to_walkers, to_walls = independent_check(made, witness)
    assert to_walkers >= 0.1
    assert to_walls >= 0.03


def corridor_site(width=2.0, length=14.0, side=()):
    """A corridor along x with its middle at y = 2, and free boxes (x0, y0, x1, y1) beside it."""
    solid = np.ones((120, round(length / 0.05)), bool)
    for x0, y0, x1, y1 in ((0.2, 2 - width / 2, length - 0.2, 2 + width / 2), *side):
        solid[round(y0 / 0.05) : round(y1 / 0.05), round(x0 / 0.05) : round(x1 / 0.05)] = False
    grid = OccupancyGrid.from_occupied(solid, 0.05)
    start, goal = (3.0, 2.0), (length - 2.0, 2.0)
    return Site("corridor", grid, start, goal, Path(np.array([start, goal])))


def walker(radius, *keys):
    keys = np.array(keys, dtype=np.float64)
    return Mover(radius, keys[:, 0], keys[:, 1:], "stay")


def judged(site, *walkers, robot=PIONEER):
    return suite.judged(suite.Made(site, robot, 0.0, 90.0, walkers))


def test_a_walker_whom_no_robot_can_avoid_is_left_out():
    site = corridor_site(width=1.3)
    sweep = walker(0.5, (0.0, 13.0, 2.0), (10.0, 13.0, 2.0), (40.0, 0.9, 2.0))
    assert judged(site, sweep).startswith("no witness")
    assert judged(corridor_site(width=3.0), sweep) == ""  # room to let it pass
    refuge = corridor_site(width=1.3, side=((5.0, 2.6, 6.5, 4.0),))
    assert judged(refuge, sweep) == ""  # a place to step aside


def test_somebody_who_stands_in_the_way_for_good_is_left_out():
    assert judged(corridor_site(1.3), walker(0.4, (0.0, 8.0, 2.0))).startswith("no witness")


def test_a_witness_does_not_drive_past_a_corner_that_somebody_is_about_to_step_out_of():
    """It would pass in front of somebody hidden, who could not be seen in time."""
    site = corridor_site(1.4, side=((7.0, 2.7, 8.2, 5.8),))
    steps_out = walker(0.3, (0.0, 7.6, 5.0), (9.0, 7.6, 5.0), (12.0, 7.6, 2.0), (15.0, 7.6, 5.0))
    made = suite.Made(site, PIONEER, 0.0, 90.0, (steps_out,))
    times, poses = people_witness.sampled(witness_of(made), PIONEER, 0.05)
    movers, moving = Movers(made.walkers), np.hypot(*np.diff(poses[:, :2], axis=0).T) > 1e-6
    stop = 0.5 * 0.55 + 0.55**2 / 5.0
    for time, pose, drives in zip(times[1:], poses[1:], moving, strict=True):
        here = shapely.LineString([pose[:2], movers.at(time)[0]])
        if drives and here.intersects(site.outline):
            gap = here.length - 0.3 - 0.25
            assert gap >= 0.18 or gap >= stop  # short moves are slow, and stop sooner


def test_hidden_people_count_only_for_a_robot_that_drives(monkeypatch):
    """Somebody rests behind a thin wall for good: a robot that has to react may not drive past."""
    hidden = corridor_site(1.2, side=((6.0, 2.65, 9.0, 3.6),))
    rests = [walker(0.4, (0.0, x, 3.1)) for x in (6.5, 7.5, 8.5)]
    monkeypatch.setattr(people_witness, "REACT", 3.0)
    assert judged(hidden, *rests).startswith("no witness")
    monkeypatch.setattr(people_witness, "REACT", 0.0)
    assert judged(hidden, *rests) == ""


def test_left_out_worlds_are_few_and_say_why():
    reasons = [suite.judge(0, n) for n in range(24) if n % 4 != 3]
    assert sum(bool(reason) for reason in reasons) <= 5
    assert all(reason == "" or reason.startswith("no witness") for reason in reasons)


# The reactive ones.


def test_without_jupedsim_reactive_numbers_are_left_out_with_a_word(monkeypatch):
    monkeypatch.setattr(suite, "jupedsim_installed", lambda: False)
    assert "pip install '.[pedestrians]'" in suite.leave_out(mission(3), Options())
    monkeypatch.setattr(suite, "judge", lambda *_: "")
    assert suite.leave_out(mission(4), Options()) == ""


@needs_jupedsim
@pytest.mark.parametrize("number", [3, 11, 47])
def test_pedestrians_start_apart_and_let_a_standing_robot_be(number):
    made = suite.make(0, number)
    for i, person in enumerate(made.crowd):
        gap = np.hypot(*np.subtract(person.start, made.site.start)) - person.radius
        assert gap >= made.robot.footprint.circumscribed + 1.0 - 1e-9
        assert 0.3 <= person.speed <= 1.6
        for other in made.crowd[:i]:
            apart = np.hypot(*np.subtract(person.start, other.start))
            assert apart > person.radius + other.radius
    assert people_crowd.stands(made.site, made.robot, made.crowd, made.heading, 0)


@needs_jupedsim
def test_a_simple_robot_gets_through_reactive_people():
    assert suite.judge(0, 3) == ""
    made = suite.make(0, 3)
    assert not people_crowd.gets_through(made.site, made.robot, made.crowd, 0, 10.0)  # no time


def test_the_simple_robot_keeps_the_limits():
    made = suite.make(0, 9)
    driver = people_crowd._SimpleDriver(made.site, made.robot)
    nobody, step = (np.empty((0, 2)), np.empty(0)), people_crowd.STEP
    poses = [driver.pose]
    while not driver.there:
        driver.step(*nobody)
        poses.append(driver.pose)
    v = np.hypot(*np.diff(np.array(poses)[:, :2], axis=0).T) / step
    omega = np.abs(np.diff(np.unwrap(np.array(poses)[:, 2]))) / step
    limits = made.robot.limits
    assert v.max() <= limits.v_max + 1e-6
    assert omega.max() <= limits.omega_max + 1e-6
    assert np.diff(v).max() <= limits.v_accel * step + 1e-6


def test_the_scenario_of_a_number(monkeypatch):
    made, scenario = suite.make(0, 2), suite.scenario(mission(2), Options(), 0)
    assert scenario.movers == made.walkers
    assert scenario.noise.range_bound == 0.01
    bound = (scenario.time_limit - 60.0) / 3.0
    assert bound == pytest.approx(made.site.way.length / made.robot.limits.v_max, rel=0.2)
    monkeypatch.setattr(suite, "make", lambda *_: "no place")
    with pytest.raises(DataError, match="people 2: no place"):
        suite.scenario(mission(2), Options(), 0)


def test_walkers_are_late_unless_the_options_ask_for_none(monkeypatch):
    monkeypatch.setattr(suite.driven, "controller_named", lambda name: Still)
    late, none = (
        suite.run_mission(mission(WALKED_INTO), Options(attention=attention), 0)
        for attention in (None, "none")
    )
    assert (late["outcome"], late["contacts_resting"]) == ("timeout", 0)
    assert late["stops"] >= 1
    assert (none["outcome"], none["contacts_resting"], none["stops"]) == ("contact", 1, 0)


def test_rows_say_the_mode(monkeypatch):
    monkeypatch.setattr(suite.driven, "run_mission", lambda *a, group, **more: {"group": group})
    assert suite.run_mission(mission(2), Options(), 0) == {"group": "indifferent"}
    assert suite.run_mission(mission(3), Options(), 0) == {"group": "reactive"}

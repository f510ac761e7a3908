"""People of whom the lidar sees the legs, and what only looks like legs."""

import math

import numpy as np
import pytest

from dynastar.geometry import Pose2D
from dynastar.robot import Lidar
from dynastar.simulation import legs
from dynastar.simulation.legs import Legs
from watching import Watcher

COARSE = Lidar(360, math.tau, 0.05, 8.0)


def legs_of(*walks):
    """The discs over time of people who walk from (x, y) on at (vx, vy) and are seen by their legs."""
    legs, walks = Legs(len(walks)), np.array(walks, float)
    return lambda t: legs.discs(walks[:, :2] + t * walks[:, 2:])


@pytest.mark.parametrize(
    "walk", [(2.0, -3.0, 0.0, 1.2), (-4.0, 1.5, 1.0, 0.0), (6.0, 1.0, -1.4, 0.0)]
)
def test_a_person_whose_legs_are_seen_is_one_obstacle_with_the_velocity_of_the_person(walk):
    watcher = Watcher()
    watcher.watch(legs_of(walk), 3.0)
    (track,) = watcher.confirmed
    place, velocity = np.array(walk[:2]) + 3.0 * np.array(walk[2:]), walk[2:]
    assert (track.x, track.y) == pytest.approx(tuple(place), abs=0.2)
    assert (track.vx, track.vy) == pytest.approx(velocity, abs=0.35)
    assert track.radius == pytest.approx(0.3)


def test_two_people_who_pass_each_other_are_two_obstacles_by_their_legs_too():
    watcher = Watcher()
    watcher.watch(legs_of((2.0, -3.0, 0.0, 1.2), (3.4, 3.0, 0.0, -1.0)), 4.0)
    one, other = sorted(watcher.confirmed, key=lambda track: track.vy)
    assert (one.vy, other.vy) == pytest.approx((-1.0, 1.2), abs=0.35)


def test_posts_as_narrow_as_legs_are_no_obstacles_that_move():
    posts = [(2.0, 0.2 * k - 1.0, 0.05) for k in range(10)]
    watcher = Watcher()
    watcher.watch(lambda t: posts, 4.0, lambda t: Pose2D(0.2 * t, 0.3 * t, 0.1 * t))
    assert watcher.ever == set()


@pytest.mark.parametrize("lidar", [None, COARSE])
@pytest.mark.parametrize(
    ("step", "apart", "radius", "speed"), [(0.4, 0.12, 0.05, 0.7), (0.8, 0.25, 0.09, 1.7)]
)
def test_short_and_long_legs_are_one_person_too(monkeypatch, step, apart, radius, speed, lidar):
    for name, value in (("STEP", step), ("APART", apart), ("LEG_RADIUS", radius)):
        monkeypatch.setattr(legs, name, value)
    watcher = Watcher() if lidar is None else Watcher(lidar)
    watcher.watch(legs_of((-3.5, 1.5, speed, 0.0)), 3.0)
    (track,) = watcher.confirmed
    assert (track.x, track.y) == pytest.approx((-3.5 + 3.0 * speed, 1.5), abs=0.3)
    assert (track.vx, track.vy) == pytest.approx((speed, 0.0), abs=0.4)


def test_a_person_with_a_pram_is_a_person_and_a_pram():
    walks = legs_of((2.5, -2.5, 0.0, 1.0))
    watcher = Watcher()
    watcher.watch(lambda t: [*walks(t), (2.5, -1.7 + t, 0.25)], 4.0)
    person, pram = sorted(watcher.confirmed, key=lambda track: track.y)
    assert (person.y, pram.y) == pytest.approx((1.5, 2.3), abs=0.1)
    assert (person.vy, pram.vy) == pytest.approx((1.0, 1.0), abs=0.15)


@pytest.mark.parametrize("side", [0.3, 0.4, 0.5])
def test_a_chair_that_was_put_where_nothing_stood_does_not_move(side):
    chair = [(2.5 + x * side, 0.3 + y * side, 0.02) for x in (0, 1) for y in (0, 1)]
    watcher = Watcher()
    watcher.watch(
        lambda t: chair if t > 1.0 else [],
        10.0,
        lambda t: Pose2D(0.3 * max(t - 1.0, 0.0), -0.4 + 0.05 * t, 0.02 * t),
    )
    assert watcher.ever == set()

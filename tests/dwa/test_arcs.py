"""The classic window: arcs, their terms and what is admissible, against a slow oracle."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.dwa import DynamicWindow
from dynastar.dwa.arcs import first_contact
from dynastar.dwa.config import ArcsConfig, DwaConfig, Weights
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import PRESETS
from dynastar.perception import MovingObstacle
from dynastar.robot import ROBOTS, Footprint, Limits, Robot
from scenes import CELL, boxed, centres_of, empty, scene_of, state_of

PERIOD = 0.1
LIMITS = Limits(1.5, 0.5, 0.2, 0.3, 0.2, 0.3)
ROUND = Robot("round", LIMITS, Footprint.disc(0.3))
PRINTED = PRESETS["printed"].dwa
BOXES = ((3.5, 2.5, 3.7, 5.5), (5.0, 1.0, 6.0, 1.5), (1.0, 6.0, 2.5, 6.4))


def printed_arc(state, v, omega, steps, h=0.1):
    """Eq. 4 as printed, from a state's pose: (steps + 1, 3) of x, y, theta."""
    (x, y, cos, sin), _, _ = state
    theta = math.atan2(sin, cos)
    arc = [(x, y, theta)]
    for _ in range(steps):
        x, y, theta = x + v * h * math.cos(theta), y + v * h * math.sin(theta), theta + omega * h
        arc.append((x, y, theta))
    return np.array(arc)


@given(
    st.floats(1.0, 7.0), st.floats(1.0, 7.0), st.floats(-3.1, 3.1), st.floats(0.0, 1.5),
    st.floats(-0.5, 0.5),
)  # fmt: skip
@settings(max_examples=150, deadline=None)
def test_an_arc_as_printed_is_what_equations_4_7_and_8_say(x, y, theta, v, omega):
    """Contact, end-point dist and heading, told from the closed cells themselves."""
    window = DynamicWindow(ROUND, PRINTED, PERIOD)
    closed, target = boxed(*BOXES), (6.5, 6.0)
    scene = scene_of(closed, target=target)
    terms, worst = np.zeros(5), np.zeros((0, 3))
    pose = state_of(x, y, theta)
    found = first_contact(scene, window._rules, window._arcs, pose[0], (v, omega), terms, worst)
    looked = max(30, math.ceil(0.5 * max(v / 0.2, abs(omega) / 0.3) / 0.1))
    arc = printed_arc(pose, v, omega, looked)
    inside = ((arc[:, :2] > 0.3) & (arc[:, :2] < 7.7)).all(axis=1)
    gaps = np.array([np.hypot(*(centres_of(closed) - p[:2]).T).min() - 0.3 for p in arc])
    touching = np.flatnonzero((gaps[1:] < CELL / math.sqrt(2.0)) & inside[1:])
    unsure = np.abs(gaps[1:] - CELL / math.sqrt(2.0)) < 0.05  # the field is good to half a cell
    if not inside.all() or unsure.any():
        return
    if len(touching) == 0:
        assert found == (math.inf, math.inf)
        end = 30
    else:
        k = int(touching[0])
        assert found == pytest.approx((v * k * 0.1, abs(omega) * k * 0.1))
        end = min(k + 1, 30)
    off = math.atan2(target[1] - arc[end, 1], target[0] - arc[end, 0]) - arc[end, 2]
    off = abs(math.remainder(off, math.tau))
    assert terms[0] == pytest.approx(1.0 - off / math.pi, abs=1e-6)
    clear = max(gaps[end] - CELL / math.sqrt(2.0), 0.0)
    assert terms[1] == pytest.approx(min(clear, 10.0) / 10.0, abs=0.006)
    assert terms[2] == pytest.approx(v / 1.5)


@pytest.mark.parametrize("distance", [0.2, 0.6, 1.2, 2.3])
def test_by_equation_7_no_speed_is_admissible_that_does_not_stop_within_dist(distance):
    """A wall ahead: v <= sqrt(2 dist v_brake) to the step of an arc, and something slower is."""
    wall = 1.0 + 0.3 + CELL / math.sqrt(2.0) + distance
    window = DynamicWindow(ROUND, PRINTED._replace(reach=5.0, omega_samples=2), PERIOD)
    scene = scene_of(boxed((wall, 0.1, wall + 0.3, 7.9)), target=(7.5, 4.0))
    choice = window.choose(Pose2D(1.0, 4.0, 0.0), Twist(0.0, 0.0), scene)
    ahead = np.abs(choice.samples[:, 1]) < 1e-9
    speeds, refused = choice.samples[ahead, 0], choice.refused[ahead] > 0
    bound = math.sqrt(2.0 * distance * 0.2)
    slack = 0.1 * 1.0 + CELL  # a step of the arc and the field's cell
    assert not refused[speeds < math.sqrt(2.0 * max(distance - slack, 0.0) * 0.2) - 0.01].any()
    assert refused[speeds > math.sqrt(2.0 * (distance + slack) * 0.2) + 0.01].all()
    assert (speeds > bound).any()


def test_terms_over_their_sums_add_up_to_one():
    window = DynamicWindow(ROUND, PRINTED, PERIOD)
    choice = window.choose(Pose2D(1.5, 4.0, 0.0), Twist(0.4, 0.0), scene_of(boxed(*BOXES)))
    ok = choice.refused == 0
    assert ok.any()
    assert choice.terms[ok][:, :4].sum(axis=0) == pytest.approx(np.ones(4))
    weighted = choice.terms[ok] @ (0.5, 0.2, 0.2, 0.1, 0.0)
    assert choice.score[ok] == pytest.approx(weighted)


@pytest.mark.parametrize("name", sorted(ROBOTS))
@pytest.mark.parametrize("dwa", [PRINTED, DwaConfig(search="arcs")], ids=["printed", "safe"])
def test_the_number_of_samples_is_bounded_for_every_robot(name, dwa):
    robot = ROBOTS[name]
    window = DynamicWindow(robot, dwa, PERIOD)
    scene = scene_of(empty(), radius=robot.footprint.inscribed)
    choice = window.choose(Pose2D(4.0, 4.0, 0.0), Twist(0.0, 0.0), scene)
    assert 0 < len(choice.samples) <= (dwa.v_samples + 1) * (dwa.omega_samples + 1)
    assert choice.command is not None


def test_arcs_behind_the_certified_stop_never_reach_a_wall():
    window = DynamicWindow(ROUND, DwaConfig(search="arcs", reach=5.0), PERIOD)
    for x in np.arange(1.0, 3.0, 0.1):
        scene = scene_of(boxed((3.5, 0.1, 3.8, 7.9)))
        for v in (0.0, 0.4, 0.8):
            choice = window.choose(Pose2D(x, 4.0, 0.0), Twist(v, 0.0), scene)
            if choice.command is not None:
                stop = choice.command.v**2 / (2.0 * LIMITS.v_brake)
                assert x + stop + 0.3 < 3.5


def test_arcs_keep_away_from_moving_obstacles_by_the_risk():
    ahead = [MovingObstacle(3.5, 4.0, -0.5, 0.0, 0.3)]
    config = DwaConfig(search="arcs", weights=Weights(risk=20.0))
    window = DynamicWindow(ROBOTS["jackal"], config, PERIOD)
    pose, twist = Pose2D(1.5, 4.0, 0.0), Twist(0.5, 0.0)
    alone = window.choose(pose, twist, scene_of(empty(), radius=0.3))
    met = window.choose(pose, twist, scene_of(empty(), movers=ahead, radius=0.3))
    best = int(np.argmax(alone.score))
    assert met.terms[best, 4] > 0.1
    assert int(np.argmax(met.score)) != best


def test_the_bearing_may_be_the_heading_of_every_search():
    for search in ("manoeuvres", "arcs"):
        config = DwaConfig(search=search, progress="bearing")
        window = DynamicWindow(ROUND, config, PERIOD)
        scene = scene_of(empty(), radius=0.3, target=(4.0, 6.0))
        choice = window.choose(Pose2D(4.0, 4.0, 0.0), Twist(0.3, 0.0), scene)
        assert choice.command.omega > 0.0
        other = scene._replace(target=(4.0, 2.0))
        assert window.choose(Pose2D(4.0, 4.0, 0.0), Twist(0.3, 0.0), other).command.omega < 0.0


def test_arcs_are_read_as_in_print_where_the_settings_say_so():
    assert PRINTED.arcs == ArcsConfig(
        motion="printed", stop="printed", dist="end", normalise="sums"
    )
    assert (PRINTED.search, PRINTED.progress, PRINTED.reach) == ("arcs", "bearing", 0.0)
    assert PRINTED.weights == Weights(0.5, 0.2, 0.2, 0.1, 0.0)

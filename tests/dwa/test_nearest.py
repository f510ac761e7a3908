import numpy as np
import pytest

from dynastar.dwa import DwaConfig
from dynastar.dwa.admissible import is_admissible, refusal
from dynastar.dwa.dwa import DynamicWindow, StopStart, _records
from dynastar.dwa.motion import command_towards
from dynastar.dwa.nearest import PARTS
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Limits, Robot
from scenes import PERIOD, boxed, scattered, scene_of

LIMITS = Limits(1.2, 1.5, 0.8, 2.0, 0.8, 2.0, v_min=-0.4)
ROUND = Robot("round", LIMITS, Footprint.disc(0.25))


class Case:
    """A robot at ``pose`` that moves at ``twist``, among closed cells."""

    def __init__(self, closed, pose, twist):
        self.around = scene_of(closed).around
        self.window = DynamicWindow(ROUND, DwaConfig(), PERIOD)
        self.twist = twist
        self.stops = [StopStart(Pose2D(*pose), twist, PERIOD)]

    def nearest(self, asked, **more):
        return self.window.nearest(self.around, self.stops, self.twist, Twist(*asked), **more)

    def towards(self, asked):
        return command_towards(self.window.rules, tuple(self.twist), asked)

    def allows(self, command):
        return is_admissible(self.around, self.window.rules, _records(self.stops), command)


def test_what_is_admissible_is_driven_within_the_limits():
    case = Case(boxed(), (4.0, 4.0, 0.0), Twist(0.5, 0.0))
    assert case.nearest((1.0, 0.5)) == (Twist(*case.towards((1.0, 0.5))), "")
    assert case.nearest((0.55, 0.1)) == (Twist(0.55, 0.1), "")


@pytest.mark.parametrize("number", range(60))
def test_the_largest_admissible_part_of_the_speeds_is_driven(number):
    random = np.random.default_rng(number)
    v, omega = random.uniform(0.0, 1.0), random.uniform(-1.0, 1.0)
    case = Case(scattered(random, 0.003), (4.0, 4.0, random.uniform(-3.0, 3.0)), Twist(v, omega))
    asked = random.uniform(-0.4, 1.2), random.uniform(-1.5, 1.5)
    command, why = case.nearest(asked)
    assert (why == "") == case.allows(case.towards(asked))
    along = [case.towards((asked[0] * k / PARTS, asked[1] * k / PARTS)) for k in range(PARTS + 1)]
    parts = [k for k in range(1, PARTS + 1) if case.allows(along[k])]
    if command is None:
        assert not parts
        assert not case.allows(case.towards((0.0, asked[1]))) or case.towards((0.0, asked[1])) == (
            0,
            0,
        )
        return
    assert case.allows(tuple(command))
    if why == "":
        assert tuple(command) == along[PARTS]
    elif parts and parts[-1] < PARTS - 1:
        low, high = along[parts[-1]], along[parts[-1] + 1]
        for at, a, b in zip(command, low, high, strict=True):
            assert min(a, b) - 1e-9 <= at <= max(a, b) + 1e-9


def test_before_a_wall_it_turns_on_the_spot():
    case = Case(boxed((4.25, 2.0, 5.0, 6.0)), (4.0, 4.0, 0.0), Twist(0.0, 0.0))
    assert case.nearest((0.5, 1.0)) == (Twist(0.0, 0.2), "no certified stop")
    assert case.nearest((0.5, 0.0)) == (None, "no certified stop")
    assert case.nearest((-0.3, 0.0))[1] == ""


def test_a_robot_that_has_to_be_steady_starts_only_what_it_can_hold():
    near = Case(boxed((4.30, 2.0, 5.0, 6.0)), (4.0, 4.0, 0.0), Twist(0.0, 0.0))
    command, why = near.nearest((0.5, 0.0))
    assert (command.v > 0.0, why) == (True, "")
    assert near.nearest((0.5, 0.0), steady=0.5) == (None, "no certified stop")
    far = Case(boxed((6.0, 2.0, 7.0, 6.0)), (4.0, 4.0, 0.0), Twist(0.0, 0.0))
    assert far.nearest((0.5, 0.0), steady=0.5) == far.nearest((0.5, 0.0))
    slowing = Case(boxed((4.30, 2.0, 5.0, 6.0)), (4.0, 4.0, 0.0), Twist(0.1, 0.0))
    assert slowing.nearest((0.02, 0.0), steady=0.5) == slowing.nearest((0.02, 0.0))


def test_with_no_stop_left_there_is_no_command():
    case = Case(boxed((4.35, 2.0, 5.0, 6.0)), (4.0, 4.0, 0.0), Twist(1.0, 0.0))
    assert case.nearest((1.0, 0.5)) == (None, "no certified stop")
    code = refusal(case.around, case.window.rules, _records(case.stops), (0.0, 0.0))
    assert code != 0

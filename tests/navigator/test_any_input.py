"""Whatever a caller hands in, ``command`` answers with a twist of numbers and compiles nothing."""

import math
import sys

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba.core.registry import CPUDispatcher

from driving import LIMITS, PERIOD, Drive, room, under_way
from dynastar.errors import InputError
from dynastar.footprint import Footprint
from dynastar.geometry import Pose2D, Twist
from dynastar.navigator import RobotState
from dynastar.perception import MovingObstacle
from dynastar.robot import Lidar, Robot
from dynastar.scan import LaserScan
from dynastar.simulation import warm_up

HUGE = [1e6, -1e6, 1e9, 1e19, -1e40, 1e150, 1.7e308, -1.7e308, 5e-324]
ODD = [None, "", "1", "ab", b"1", True, 10**400, 1 + 2j, (), [1.0], [[]], {}, object, np.ones(1)]
numbers = st.one_of(
    st.floats(-10.0, 10.0),
    st.floats(),
    st.sampled_from([*HUGE, math.nan, math.inf, -math.inf]),
    st.integers(-3, 3),
    st.floats(width=32).map(np.float32),
    st.floats(-3.0, 3.0).map(np.array),
    st.integers(-3, 3).map(np.int64),
)
anything = numbers | st.sampled_from(ODD)
readings = st.sampled_from([0.0, 0.05, 1.0, 5.999, 6.0, 6.5, 65.5, 1e30, -1.0, math.nan, math.inf])
ranges = st.one_of(
    st.lists(readings, max_size=40),
    st.lists(readings, min_size=360, max_size=360).map(np.array),
    st.integers(0, 800).map(lambda n: np.full(n, 3.0)),
    readings.map(lambda one: np.full((4, 90), one, np.float32)),
    st.sampled_from([3, "ab", None, [["a"]], [[1.0], [1.0, 2.0]], np.ones(4, int), {}, []]),
)
SCAN_FIELDS = ("stamp", "angle_min", "angle_increment", "range_min", "range_max")


@st.composite
def states(draw, now):
    """A state with up to three numbers replaced, or something else."""
    if draw(st.integers(0, 9)) == 0:
        return draw(anything | st.lists(anything, max_size=4).map(tuple))
    values = [now.stamp, *now.pose, *now.twist]
    for i in draw(st.lists(st.integers(0, 5), max_size=3)):
        values[i] = draw(anything)
    return RobotState(values[0], Pose2D(*values[1:4]), Twist(*values[4:]))


@st.composite
def scans(draw, scan):
    """A scan with up to three fields replaced, several of them, or something else."""
    kind = draw(st.integers(0, 9))
    if kind == 0:
        return draw(anything)
    if kind == 1:
        return draw(st.lists(scans(scan) | anything, max_size=3))
    fields = vars(scan) | draw(st.dictionaries(st.sampled_from(SCAN_FIELDS), anything, max_size=2))
    if draw(st.booleans()):
        fields["ranges"] = draw(ranges)
    if draw(st.integers(0, 3)) == 0:
        fields["mount"] = draw(anything | st.lists(anything, max_size=4))
    try:
        return LaserScan(**fields)
    except InputError:
        return fields["ranges"]


movers = st.one_of(
    st.none(),
    anything,
    st.lists(st.tuples(*[numbers] * 5).map(lambda five: MovingObstacle(*five)), max_size=4),
    st.lists(st.lists(anything, max_size=6), max_size=3),
)


def signatures():
    """The compiled signatures of every kernel of the package."""
    kernels = {
        id(one): one
        for name, module in list(sys.modules.items())
        if name.startswith("dynastar")
        for one in vars(module).values()
        if isinstance(one, CPUDispatcher)
    }
    return {kernel.py_func.__qualname__: kernel.signatures for kernel in kernels.values()}


@settings(max_examples=60, deadline=None)
@given(data=st.data())
def test_whatever_comes_in_a_finite_twist_comes_out_and_nothing_is_compiled(data):
    warm_up()
    drive = under_way()
    before = signatures()
    for _ in range(3):
        state, scan = data.draw(states(drive.state)), data.draw(scans(drive.scan()))
        command = drive.navigator.command(state, scan, data.draw(movers))
        assert type(command) is Twist
        assert all(type(number) is float and math.isfinite(number) for number in command)
        assert drive.status.reason
        drive.now += PERIOD
    drive.tick()
    assert signatures() == before


@pytest.mark.parametrize(
    "movers", [3, [3], [10**5000], [("a", "b", "c", "d", "e")], [(10**400, 0, 0, 0, 0.3)]]
)
def test_what_is_no_moving_obstacle_brakes_and_says_so(movers):
    drive = under_way()
    v = drive.twist.v
    assert 0.0 <= drive.tick(movers=movers).v < v
    assert drive.status.state == "sensor_lost"
    assert "the moving obstacles are" in drive.status.reason


footprints = st.one_of(
    st.floats(0.0, 10.0).map(Footprint.disc),
    st.tuples(*[st.floats(0.01, 6.0)] * 3).map(
        lambda at: Footprint.polygon(
            [(at[0], -at[1]), (at[0], at[1]), (-at[2], at[1]), (-at[2], -at[1])]
        )
    ),
)
lidars = st.builds(
    Lidar,
    beams=st.integers(2, 800),
    fov=st.sampled_from([0.01, 1.0, math.pi, math.tau]),
    range_min=st.sampled_from([0.0, 0.1, 5.0, 10.0]),
    range_max=st.sampled_from([0.1, 3.5, 5.6, 30.0, 200.0]),
    x=st.floats(-5.0, 5.0),
    y=st.floats(-5.0, 5.0),
    theta=st.floats(-6.0, 6.0),
    nothing=st.lists(st.sampled_from([0.0, 65.5, -1.0, math.nan, math.inf, -math.inf]), max_size=2),
).filter(lambda lidar: lidar.range_min < lidar.range_max)


@pytest.mark.filterwarnings("ignore:a footprint reaches")
@settings(max_examples=40, deadline=None)
@given(footprint=footprints, lidar=lidars, error=st.sampled_from([0.0, 0.05, 1.0]))
def test_any_robot_is_driven_or_says_why_not_and_compiles_nothing(footprint, lidar, error):
    warm_up()
    robot = Robot("any", LIMITS, footprint, lidar)
    drive = Drive(room(), robot, pose=(4.0, 3.0, 0.3), range_error=error, pose_error=error)
    before = signatures()
    drive.navigator.set_goal((6.5, 3.0, 1.0))
    for _ in range(4):
        command = drive.tick()
        assert all(type(number) is float and math.isfinite(number) for number in command)
        assert drive.status.reason
    assert signatures() == before

import math

from hypothesis import given
from hypothesis import strategies as st

from dynastar.geometry import Pose2D, Twist
from dynastar.navigator.braking import StopProfile
from dynastar.robot import Limits, arc, slew, stopping_time

PARTS = 20


def drive(pose, twist, command, limits, period):
    """A drive that goes to the command at its own limits and holds, in fine steps."""
    h = period / PARTS
    for _ in range(PARTS):
        after = Twist(
            slew(twist.v, command.v, limits.v_accel, limits.v_brake, h),
            slew(twist.omega, command.omega, limits.omega_accel, limits.omega_brake, h),
        )
        mean = Twist(0.5 * (twist.v + after.v), 0.5 * (twist.omega + after.omega))
        pose, twist = arc(pose, mean, h), after
    return pose, twist


limits_ = st.builds(
    Limits,
    v_max=st.just(2.0),
    omega_max=st.just(2.0),
    v_accel=st.floats(0.2, 3.0),
    omega_accel=st.floats(0.2, 5.0),
    v_brake=st.floats(0.2, 3.0),
    omega_brake=st.floats(0.2, 5.0),
    v_min=st.just(0.0),
)


@given(limits_, st.floats(-1.5, 1.5), st.floats(-1.5, 1.5), st.sampled_from([0.05, 0.1]))
def test_the_stop_ends_on_the_arc_it_was_certified_on(limits, v, omega, period):
    twist = Twist(v, omega)
    pose = start = Pose2D(0.0, 0.0, 0.0)
    stop, ticks = StopProfile(twist, limits), 0
    while (twist.v or twist.omega) and ticks < 1000:
        pose, twist = drive(pose, twist, stop.next(twist, period), limits, period)
        ticks += 1
    duration = stopping_time(Twist(v, omega), limits)
    expected = arc(start, Twist(v, omega), 0.5 * duration)
    assert twist == Twist(0.0, 0.0)
    assert ticks <= math.ceil(duration / period) + 1
    # What is left is the last period, which ends in a full stop wherever it began.
    slack = 0.6 * period * period * max(limits.v_brake, limits.omega_brake * abs(v) * period) + 0.01
    assert math.dist(pose[:2], expected[:2]) < slack


@given(limits_, st.floats(0.1, 1.5), st.floats(-1.5, 1.5))
def test_braking_is_never_harder_than_the_limits(limits, v, omega):
    twist, stop = Twist(v, omega), StopProfile(Twist(v, omega), limits)
    for _ in range(50):
        command = stop.next(twist, 0.1)
        assert abs(command.v - twist.v) <= limits.v_brake * 0.1 + 1e-9
        assert abs(command.omega - twist.omega) <= limits.omega_brake * 0.1 + 1e-9
        assert abs(command.v) <= abs(twist.v) + 1e-9
        twist = command

"""Ways past movers: how they are driven, and how near movers come on them."""

import math
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from dynastar.clearance import distance_field
from dynastar.dwa import Margins, Surroundings, stop_kernels
from dynastar.dwa.dwa import Body
from dynastar.dwa.manoeuvre_kernels import LATE, STEP, along, aside, drive, first_command, worth
from dynastar.dwa.passing import Scene
from dynastar.geometry import Pose2D, Twist
from dynastar.robot import Limits, arc, slew

LIMITS = Limits(1.0, 1.5, 1.0, 2.0, 1.0, 2.0)
REVERSING = LIMITS._replace(v_min=-0.5)
BODY = Body(np.empty((0, 2)), np.empty((0, 3)), 0.3, 0.3)
HERE = Pose2D(5.0, 5.0, 0.0)
OPEN = np.full((200, 200), 9.0, np.float32)
WIDE = np.full((500, 500), 9.0, np.float32)
PATH = np.column_stack([5.0 + 0.1 * np.arange(30), np.full(30, 5.0), np.full(30, 9.0)])
STAND = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
KEEP = (math.inf,)
SECONDS = 6.0


def scene(movers=(), field=OPEN, spread=0.0, limits=LIMITS):
    low = 5.0 - 0.025 * len(field)
    rows = np.array(movers, float).reshape(-1, 6)
    around = Surroundings(field, low, low, 0.05, rows)
    margins = Margins(0.05, 0.15, spread, 8.0)
    nobody = around._replace(movers=rows[:0])
    return Scene(around, nobody, around, BODY, margins, 1.0, 0.0, limits, 0.1)


def straight(v, omega=0.0, held=0.0, then=None):
    return (v, omega, held, v if then is None else then, math.inf, math.inf)


def to(x, y, speed=0.5):
    return (0.0, 0.0, 0.0, speed, x, y)


def following(speed):
    return to(math.nan, math.nan, speed)


def driven(way, turns=KEEP, v=0.0, stoppable=False, path=PATH, seconds=SECONDS, **kwargs):
    """Where a way leads, whether it can be, and the gap for each of ``turns``."""
    gaps, touched = np.empty(len(turns)), np.empty(len(turns))
    x, y, can_be = drive(
        np.array(way, float),
        (*HERE, v, 0.0),
        path,
        seconds,
        scene(**kwargs),
        0.05,
        np.array(turns),
        stoppable,
        kwargs.get("spread", 0.0),
        gaps,
        touched,
    )
    return (x, y), can_be, gaps, touched


@given(
    st.tuples(st.floats(0, 1), st.floats(-1.5, 1.5), st.sampled_from([0.0, 1.0, 2.0])),
    st.floats(0, 1),
    st.tuples(st.floats(-4, 4), st.floats(-4, 4), st.floats(-1, 1), st.floats(-1, 1)),
    st.sampled_from([0.0, 1.4, math.inf]),
)
@settings(max_examples=150, deadline=None)
def test_the_gap_is_that_of_a_drive_step_by_step(first, then, mover, turn):
    v_held, omega_held, held = first
    x, y, vx, vy = mover
    at, v, omega, least, touched = HERE, 0.0, 0.0, math.inf, math.nan
    for k in range(round(SECONDS / STEP)):
        want = (v_held, omega_held) if k * STEP < held - 1e-9 else (then, 0.0)
        next_v, next_w = slew(v, want[0], 1.0, 1.0, STEP), slew(omega, want[1], 2.0, 2.0, STEP)
        at = arc(at, Twist(0.5 * (v + next_v), 0.5 * (omega + next_w)), STEP)
        v, omega, t = next_v, next_w, (k + 1) * STEP
        on = t if t <= turn else 2.0 * turn - t
        gap = math.hypot(5 + x + vx * on - at.x, 5 + y + vy * on - at.y) - 0.6
        if gap < least:
            least = gap
        if gap <= 0.0 and math.isnan(touched):
            touched = t
    movers = [(5 + x, 5 + y, vx, vy, 0.3, 0.0)]
    way = straight(v_held, omega_held, held, then)
    end, can_be, gaps, times = driven(way, [turn], field=WIDE, movers=movers)
    assert can_be
    assert end == pytest.approx((at.x, at.y), abs=1e-9)
    if abs(least) > 0.02 and math.hypot(vx, vy) > 0.01:  # slower is standing
        assert gaps[0] == pytest.approx(least, abs=1e-6)
        assert times[0] == (math.inf if math.isnan(touched) else pytest.approx(touched))


def test_following_stays_on_the_path_and_stops_at_its_end():
    bend = np.vstack([PATH[:10], PATH[9] + 0.1 * np.outer(np.arange(1, 12), (0.0, 1.0, 0.0))])
    end, can_be, _, _ = driven(following(0.5), path=bend, seconds=9.0)
    assert can_be
    assert math.dist(end, bend[-1, :2]) < 0.25


def test_following_keeps_to_the_speeds_that_the_path_allows():
    """Too fast for the bend it swings into the wall beyond."""
    bend = np.vstack([PATH[:10], PATH[9] + 0.1 * np.outer(np.arange(1, 12), (0.0, 1.0, 0.0))])
    closed = np.zeros((200, 200), bool)
    closed[:, 128:] = True
    field, slower = distance_field(closed, 0.05), bend.copy()
    slower[:, 2] = 0.3
    fast, slow = (
        driven(following(1.0), v=0.3, path=path, field=field, seconds=9.0)
        for path in (bend, slower)
    )
    assert not fast[1]
    assert slow[1]
    assert math.dist(slow[0], bend[-1, :2]) < 0.25


@pytest.mark.parametrize("angle", [0.0, 0.7, 1.6, 2.5, math.pi, -1.2, -2.8])
def test_a_point_aside_is_reached_and_stopped_at(angle):
    aim = 5.0 + 1.2 * math.cos(angle), 5.0 + 1.2 * math.sin(angle)
    for v in (0.0, 0.4):
        end, _, _, _ = driven(to(*aim), v=v, seconds=9.0)
        assert math.dist(end, aim) < 0.25


def test_what_lies_behind_is_backed_to_where_the_robot_may():
    wanted = {}
    for limits in (LIMITS, REVERSING):
        v, omega, _, _ = first_command(
            np.array(to(4.0, 5.1)), (*HERE, 0.0, 0.0), PATH, scene(limits=limits)
        )
        wanted[limits.v_min] = v, omega
    assert wanted[0.0][0] == 0.0
    assert wanted[0.0][1] != 0.0
    assert wanted[-0.5] == pytest.approx((-0.1, -0.2), abs=0.1)
    end, _, _, _ = driven(to(4.0, 5.1), limits=REVERSING, seconds=3.5)
    assert math.dist(end, (4.0, 5.1)) < 0.2


def test_a_wall_on_the_way_is_no_way():
    closed = np.zeros((200, 200), bool)
    closed[:, 118:] = True
    field = distance_field(closed, 0.05)
    assert not driven(straight(1.0), field=field)[1]
    assert not driven(following(1.0), field=field)[1]
    assert driven(straight(0.0, 1.0, 2.0), field=field)[1]


def test_it_gets_less_sure_with_driving_and_not_with_standing():
    beside = [(5.0, 7.0, 0.0, 0.0, 0.3, 0.0)]
    assert driven(STAND, movers=beside, spread=0.1)[2] == pytest.approx([1.4])
    circling = straight(0.05, 1.5, 6.0)
    sure, unsure = (driven(circling, movers=beside, spread=s)[2][0] for s in (0.0, 0.1))
    assert unsure == pytest.approx(sure - 0.15, abs=0.03)


def test_turning_back_counts_from_when_they_turn_and_at_their_top_speed():
    leaving = [(5.0, 6.0, 0.0, 0.5, 0.3, 1.0)]
    _, _, gaps, times = driven(STAND, (math.inf, 0.0, 4.0), movers=leaving)
    assert gaps[0] == pytest.approx(0.5)  # after the first step
    assert times[1] == pytest.approx(0.4, abs=STEP)
    assert times[0] == times[2] == math.inf
    assert gaps[2] == pytest.approx(0.4)  # 2 m further at 4 s, and back by 6 s


def test_who_does_not_turn_back_goes_on_as_now_or_at_its_top_speed():
    hastening = [(5.0, 9.0, 0.0, -0.1, 0.3, 0.6)]  # comes 0.6 m or 3.6 m in six seconds
    _, _, gaps, times = driven(STAND, (math.inf, 3.0), movers=hastening)
    assert times[0] == pytest.approx(5.7, abs=STEP)
    assert gaps[1] == pytest.approx(4.0 - 0.3 - 0.6)
    slowing = [(5.0, 5.9, 0.0, -0.1, 0.3, 9.0)]  # at its top speed past at once
    assert driven(STAND, movers=slowing)[3] == pytest.approx([3.0], abs=1.5 * STEP)


def test_a_way_that_could_not_be_stopped_on_is_told_from_one_that_could():
    """Across before the mover comes, but were it to stop there the mover would come."""
    across = [(6.2, 7.6, 0.0, -0.8, 0.3, 0.8)]
    moving, stopped = (
        driven(straight(1.0), v=1.0, stoppable=s, movers=across, field=WIDE)[2][0]
        for s in (False, True)
    )
    assert moving > 0.0
    assert stopped < moving


def test_a_way_is_worth_its_gaps_and_less_for_an_early_touch():
    never, late, early = math.inf, 5.0, 1.0
    assert worth(np.array([0.2, 0.9]), np.array([never, never]), 0.4, 6.0) == pytest.approx(0.3)
    worths = [
        worth(np.array([gap]), np.array([touched]), 0.4, 6.0)
        for gap, touched in ((-0.5, early), (-0.5, late), (-0.1, late), (0.1, never))
    ]
    assert worths == sorted(worths)
    assert worths[1] - worths[0] == pytest.approx(4.0 * LATE)


# -- going on --------------------------------------------------------------------------------------


def goes_on(movers, least_v=-1.0, enough=0.15, turns=(math.inf, 0.0), field=OPEN):
    gaps = np.empty(len(turns))
    found, v, _ = along(
        np.array([1.0, 0.5, 0.25]),
        least_v,
        enough,
        (*HERE, 0.3, 0.0),
        PATH,
        8.0,
        scene(movers, field),
        np.array(turns),
        gaps,
        np.empty(len(turns)),
    )
    return v if found else None


def test_it_goes_on_before_who_comes_late_not_who_comes_head_on_nor_through_a_wall():
    late, head_on = (6.5, 9.5, 0.0, -0.4, 0.3, 0.4), (7.5, 5.0, -0.5, 0.0, 0.3, 0.5)
    assert goes_on([late]) == pytest.approx(0.4)
    assert goes_on([head_on]) is None
    closed = np.zeros((200, 200), bool)
    closed[:, 118:] = True
    assert goes_on([late], field=distance_field(closed, 0.05)) is None


def test_it_goes_on_only_if_that_is_faster_and_there_is_enough_of_a_gap():
    late = (6.5, 9.5, 0.0, -0.4, 0.3, 0.4)
    assert goes_on([late], least_v=0.39) == pytest.approx(0.4)
    assert goes_on([late], least_v=0.41) is None
    assert goes_on([late], enough=3.5) is None


def test_the_bold_pass_behind_who_may_turn_back():
    leaving = (6.0, 5.9, 0.0, 0.5, 0.3, 0.5)
    assert goes_on([leaving]) is None
    assert goes_on([leaving], turns=(math.inf,)) is not None


@given(st.integers(0, 10**6))
@settings(max_examples=60, deadline=None)
def test_what_it_goes_on_with_can_be_stopped_for_what_stands_and_before_movers(seed):
    rng = np.random.default_rng(seed)
    closed = rng.random((200, 200)) < 0.002
    closed[90:110, 90:115] = False
    side = np.array([math.cos(seed), math.sin(seed)])
    movers = [(*(HERE[:2] + rng.uniform(1.5, 4.0) * side), *(-0.6 * side), 0.3, 0.6)]
    field = distance_field(closed, 0.05)
    v = goes_on(movers, field=field)
    if v is None:
        return
    room = scene(movers, field)
    code = stop_kernels.certify(
        room.around, BODY, room.margins, 1.0, 0.0, (*HERE, 0.3, 0.0), v, 0.0, LIMITS, 0.1
    )
    assert code in (stop_kernels.ADMISSIBLE, stop_kernels.RUN_OVER)


# -- out of the way --------------------------------------------------------------------------------


def goes_aside(movers, way, v, limits, omega=0.0):
    """The first speed of a way that is better than braking, or None."""
    gaps, touched = np.empty(len(KEEP)), np.empty(len(KEEP))
    ways, around = np.array([way], float), scene(movers, spread=0.1, limits=limits)
    found, v, _, _ = aside(
        ways, 0.3, (*HERE, v, omega), PATH, SECONDS, around, np.array(KEEP), gaps, touched
    )
    return v if found >= 0 else None


def test_who_would_be_run_over_where_it_stands_backs_on_though_it_could_not_stop_in_time():
    """How near somebody comes is not sure, and that they come where the robot stands is."""
    weak = REVERSING._replace(v_accel=0.2, v_brake=0.2)
    across = [(5.45, 5.75, 0.0, -0.5, 0.3, 0.5)]  # 0.15 m into the robot, if it stands
    back = straight(-0.5, 0.0, 4.0, 0.0)
    _, _, gaps, _ = driven(back, v=-0.02, movers=across, limits=weak, spread=0.1)
    assert gaps[0] < 0.0  # with all that they may stray
    assert goes_aside(across, back, -0.02, weak) == pytest.approx(-0.04)
    deeper = [(5.2, 6.2, 0.0, -0.5, 0.3, 0.5)]  # a touch either way, if less of one and later
    assert goes_aside(deeper, back, -0.02, weak) == pytest.approx(-0.04)
    assert goes_aside(across, straight(0.0, 0.5, 4.0, 0.0), 0.0, weak) is None  # saves nobody
    past = [(5.95, 5.75, 0.0, -0.5, 0.3, 0.5)]  # passes by who stands
    assert goes_aside(past, back, -0.02, weak) is None


@pytest.mark.parametrize(("gap", "backs"), [(0.31, True), (0.25, False)])
def test_it_backs_before_who_will_touch_it_as_long_as_it_can_be_at_rest_by_then(gap, backs):
    """Backing at 0.1 m/s it stops within 0.6 s; the touch comes after 1.2 s or after 0.8 s."""
    weak = REVERSING._replace(v_accel=0.2, v_brake=0.2)
    head_on, back = [(5.6 + gap, 5.0, -0.5, 0.0, 0.3, 0.5)], straight(-0.5, 0.0, 4.0, 0.0)
    touched = driven(back, v=-0.1, movers=head_on, limits=weak)[3]
    assert touched == pytest.approx([1.2 if backs else 0.8])
    assert goes_aside(head_on, back, -0.1, weak) == (pytest.approx(-0.12) if backs else None)


def test_who_will_be_touched_whatever_it_does_is_at_rest_by_then():
    weak = REVERSING._replace(v_accel=0.2, v_brake=0.2)
    at_once = [(5.2, 5.6, 0.0, -0.5, 0.3, 0.5)]
    back = straight(-0.5, 0.0, 4.0, 0.0)
    for v, way in product((0.0, -0.02), (back, to(4.0, 5.0), straight(0.0, 1.0, 2.0, 0.0))):
        assert driven(way, v=v, movers=at_once, limits=weak)[3] == pytest.approx([STEP])
        assert goes_aside(at_once, way, v, weak) is None
    assert goes_aside(at_once, back, -0.1, weak) == pytest.approx(-0.12)  # at rest it cannot be


@pytest.mark.parametrize(("gap", "brakes"), [(0.75, True), (0.65, False)])
def test_who_can_be_at_rest_by_the_touch_brakes_though_somebody_may_be_there_sooner(gap, brakes):
    """It turns for 1.67 s more. The touch comes after 1.8 s or 1.6 s, if nobody strays."""
    weak = REVERSING._replace(v_accel=0.2, v_brake=0.2, omega_accel=0.3, omega_brake=0.3)
    head_on, round_ = [(5.6 + gap, 5.0, -0.5, 0.0, 0.3, 0.5)], straight(0.3, 0.5, 4.0, 0.0)
    found = goes_aside(head_on, round_, -0.2, weak, omega=0.5)
    assert found == (None if brakes else pytest.approx(-0.18))

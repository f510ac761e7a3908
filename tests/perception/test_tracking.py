import math

import numpy as np
import pytest

from dynastar.geometry import Pose2D
from dynastar.grid import GridFrame
from dynastar.perception.detection import Known
from dynastar.perception.local_map import SEEN_OCCUPIED
from dynastar.perception.planning_map import PlanningMap
from dynastar.robot import ROBOTS, Lidar
from dynastar.simulation.lidar import LidarSimulator
from watching import OPEN, PILLAR, ROUND, Watcher

# -- in view ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("rate", [5.0, 20.0, 40.0])
@pytest.mark.parametrize(("radius", "speed"), [(0.2, 0.3), (0.3, 1.6), (0.5, 2.0)])
def test_an_obstacle_is_found_with_its_velocity_at_any_rate_of_scans(rate, radius, speed):
    watcher = Watcher()
    moving = watcher.watch(lambda t: [(3.0, -2.0 + speed * t, radius)], 2.0, rate=rate)
    (track,) = watcher.confirmed
    assert (track.vx, track.vy) == pytest.approx((0.0, speed), abs=0.1)
    assert (track.x, track.y) == pytest.approx((3.0, -2.0 + 2.0 * speed), abs=0.05)
    assert track.radius == pytest.approx(radius, abs=0.04)
    assert track.still == 0.0
    assert track.age == pytest.approx(2.0, abs=0.25)
    assert moving.sum() > 10


@pytest.mark.parametrize("speed", [0.6, 1.0, 1.6])
def test_an_obstacle_that_enters_free_space_is_confirmed_in_a_third_of_a_second(speed):
    """It comes out from behind the end of a wall."""
    wall = np.array([(2.0, 0.0), (2.1, 0.0), (2.1, 3.0), (2.0, 3.0)])
    watcher = Watcher(polygons=[wall])
    edge = 0.25  # its near side comes into view
    for k in range(40):
        watcher.look(k / 20, [(4.0, edge + 1.0 - speed * k / 20, 0.25)])
        if watcher.confirmed:
            break
    seen = 1.0 / speed  # when about half of it is in view
    assert k / 20 < seen + 0.35


@pytest.mark.parametrize("distance", [7.0, 10.0])
def test_an_obstacle_is_tracked_as_far_as_the_lidar_sees(distance):
    """The local map ends at 5 m."""
    watcher = Watcher(lidar=Lidar(720, math.tau, 0.05, 15.0))
    watcher.watch(lambda t: [(distance, -0.6 + 1.2 * t, 0.3)], 1.0)
    (track,) = watcher.confirmed
    assert (track.x, track.y) == pytest.approx((distance, 0.6), abs=0.1)
    assert track.vy == pytest.approx(1.2, abs=0.2)


@pytest.mark.parametrize("distance", [0.8, 1.0, 2.0, 4.0])
def test_the_position_is_right_though_less_than_half_is_seen_from_near_by(distance):
    watcher = Watcher()
    watcher.watch(lambda t: [(distance + 1.5 - 0.5 * t, 0.0, 0.3)], 3.0)
    (track,) = watcher.confirmed
    assert (track.x, track.y) == pytest.approx((distance, 0.0), abs=0.03)
    assert track.radius == pytest.approx(0.3, abs=0.03)


def test_a_reversal_is_followed_within_0_4_s():
    def at(t):
        return [(3.0, 1.0 - abs(t - 1.5) * 0.8, 0.3)]

    watcher = Watcher()
    watcher.watch(at, 1.9)
    (track,) = watcher.confirmed
    assert track.vy == pytest.approx(-0.8, abs=0.3)


def test_the_error_of_a_track_is_within_its_standard_deviations():
    watcher = Watcher()
    misses = []
    for k in range(100):
        x = 4.0 - 0.03 * k
        watcher.look(k / 20, [(x, 0.5, 0.3)])
        if k > 20:
            (track,) = watcher.confirmed
            misses.append((track.x - x) ** 2 / track.position_sd**2)
            misses.append((track.vx + 0.6) ** 2 / track.velocity_sd**2)
    assert np.mean(misses) < 1.5


def test_two_obstacles_that_pass_each_other_keep_their_velocities():
    watcher = Watcher()
    watcher.watch(lambda t: [(3.0, -1.5 + 0.6 * t, 0.25), (4.2, 1.5 - 0.6 * t, 0.25)], 4.5)
    assert sorted(m.vy for m in watcher.confirmed) == pytest.approx([-0.6, 0.6], abs=0.1)


def test_two_obstacles_that_come_together_stay_two():
    watcher = Watcher()

    def at(t):
        apart = max(0.3, 0.8 - 0.2 * t)
        return [(4.0 - 0.5 * t, apart, 0.28), (4.0 - 0.5 * t, -apart, 0.28)]

    watcher.watch(at, 4.0)
    assert sorted(m.y for m in watcher.confirmed) == pytest.approx([-0.3, 0.3], abs=0.08)


def test_two_obstacles_that_arrive_side_by_side_are_covered():
    watcher = Watcher()
    watcher.watch(lambda t: [(4.0 - 0.5 * t, y, 0.28) for y in (-0.3, 0.3)], 3.0)
    assert watcher.confirmed
    for y in (-0.3, 0.3):
        assert any(math.hypot(m.x - 2.5, m.y - y) < 0.45 for m in watcher.confirmed)
    assert all(m.vx == pytest.approx(-0.5, abs=0.15) for m in watcher.confirmed)


def test_a_moving_obstacle_leaves_no_hits_behind():
    watcher = Watcher()
    watcher.watch(lambda t: [(3.0, -1.5 + 1.0 * t, 0.3)], 3.0)
    assert not (watcher.local_map.states == SEEN_OCCUPIED).any()


def test_an_obstacle_beside_a_wall_of_the_map_is_found():
    """Its points and the wall's are one row; the map tells them apart."""
    mapped = np.zeros((200, 200), bool)
    mapped[102:120, 139:] = True  # from (3.9, 0.2) on a map from (-10, -10)
    wall = np.array([(4.0, 0.3), (4.5, 0.3), (4.5, 1.9), (4.0, 1.9)])
    watcher = Watcher(polygons=[wall], known=Known(mapped, GridFrame(0.1, -10.0, -10.0)))
    watcher.watch(lambda t: [(4.5 - 0.5 * t, 0.0, 0.28)], 1.5)
    (track,) = watcher.confirmed
    assert (track.vx, track.vy) == pytest.approx((-0.5, 0.0), abs=0.1)


@pytest.mark.parametrize("moves", [True, False])
def test_an_obstacle_close_to_a_wall_that_no_map_shows_is_found(moves):
    wall = np.array([(2.0, 0.05), (2.3, 0.05), (2.3, 1.8), (2.0, 1.8)])
    watcher = Watcher(polygons=[wall])

    def at(t):
        return [(2.3 - max(t - 0.5, 0.0), -0.28, 0.3)] if moves and t > 0.5 else []

    watcher.watch(at, 1.2)
    assert len(watcher.confirmed) == moves
    if moves:
        assert (watcher.confirmed[0].vx, watcher.confirmed[0].vy) == pytest.approx(
            (-1.0, 0.0), abs=0.2
        )


# -- at rest ---------------------------------------------------------------------------------------


def test_nothing_at_rest_is_confirmed_though_the_robot_drives_past_at_2_m_s():
    random = np.random.default_rng(4)
    x, y = random.uniform(-1.0, 9.0, 60), random.uniform(0.6, 4.0, 60)
    y[::2] *= -1.0
    posts = np.column_stack([x, y, np.full(60, 0.075)])
    boxes = [box(random.uniform(0.0, 8.0), y, y) for y in (1.5, -1.5, 2.5, -2.5, 3.5, -3.5)]
    watcher = Watcher(ROBOTS["jackal"].lidar, polygons=boxes)

    def pose_at(t):
        return Pose2D(2.0 * t, 0.3 * math.sin(2.0 * t), 0.6 * math.sin(2.0 * t))

    watcher.watch(lambda t: posts, 3.5, pose_at)
    assert not watcher.ever


def box(x, y, angle):
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])
    return np.array([(-0.3, -0.2), (0.3, -0.2), (0.3, 0.2), (-0.3, 0.2)]) @ turn + (x, y)


@pytest.mark.parametrize(
    ("width", "depth"), [(1.2, 1.2), (1.3, 0.4), (0.8, 0.6), (0.4, 0.4), (0.9, 0.1)]
)
@pytest.mark.parametrize("speed", [0.6, 2.0])
def test_a_box_that_was_put_where_nothing_stood_does_not_move(width, depth, speed):
    """The robot drives round it, so that its sides come into view one after the other."""
    watcher, way = Watcher(), 2.0
    box = 0.5 * np.array([(-width, -depth), (width, -depth), (width, depth), (-width, depth)])
    after = LidarSimulator(ROUND, OPEN, [box], 0.01, np.random.default_rng(2))
    for k in range(200):
        t = k / 20
        angle = speed * t / way
        pose = Pose2D(way * math.cos(angle), way * math.sin(angle), angle + 0.5 * math.pi)
        watcher.look(t, [], pose, after if t > 1.0 else None)
    assert not watcher.ever


@pytest.mark.parametrize("omega", [1.0, 4.0])
def test_nothing_at_rest_is_confirmed_though_the_robot_turns(omega):
    """Box corners come into view at the ends of the field of view of 270 degrees."""
    angles = (0.3, 1.5, 2.8, 4.1, 5.3)
    boxes = [box(2.0 * math.cos(a), 2.0 * math.sin(a), a) for a in angles]
    watcher = Watcher(ROBOTS["jackal"].lidar, polygons=boxes)
    watcher.watch(lambda t: [(3.0, 1.8, 0.3)], 4.0, lambda t: Pose2D(0.1 * t, 0.0, omega * t))
    assert not watcher.ever


def test_a_dead_end_round_the_sensor_is_no_track():
    """Its walls are one group, narrower than the widest moving obstacle, that fits a disc here."""
    walls = [(-0.4, 0.32, 0.6, 0.42), (-0.4, -0.42, 0.6, -0.32), (0.6, -0.42, 0.7, 0.42)]
    polygons = [np.array([(a, b), (c, b), (c, d), (a, d)]) for a, b, c, d in walls]
    watcher = Watcher(ROBOTS["jackal"].lidar, polygons=polygons)
    for k in range(30):
        pose = Pose2D(0.3 - 0.01 * k, 0.0, -0.02 * max(k - 15, 0))
        watcher.look(0.05 * k, [], pose)
        assert not watcher.tracker.tracks


def test_the_rim_of_the_map_is_no_track():
    watcher = Watcher(known=PlanningMap(OPEN).known)
    for k in range(60):
        watcher.look(0.05 * k, [], Pose2D(19.0 - 0.02 * k, 16.0 + 0.03 * k, 0.01 * k))
        assert not watcher.tracker.tracks


def test_an_obstacle_that_comes_into_view_at_rest_is_no_track():
    watcher = Watcher()
    watcher.watch(lambda t: [(3.0, 0.0, 0.3)], 2.0)
    assert watcher.tracker.tracks == ()


def test_an_obstacle_that_begins_to_move_is_tentative_until_that_is_certain():
    watcher, states = Watcher(), []
    for k in range(1, 21):
        watcher.look(k / 20, [(3.0, -1.0 + 0.4 * k / 20, 0.3)])
        states += [track.state for track in watcher.tracker.tracks]
    assert states[0] == "tentative"
    assert states[-1] == "confirmed"


# -- stopping --------------------------------------------------------------------------------------


def test_an_obstacle_that_stops_stays_in_the_local_map_until_it_moves_on():
    def at(t):
        return [(3.0, -1.0 + 0.8 * min(t, 2.0) + 0.8 * max(t - 6.0, 0.0), 0.3)]

    watcher = Watcher()
    watcher.watch(at, 2.0)
    (moving,) = watcher.confirmed
    for k in range(41, 120):
        watcher.look(k / 20, at(k / 20))
    (stopped,) = watcher.of("stopped")
    assert stopped.id == moving.id
    assert stopped.still == pytest.approx(3.9, abs=0.4)
    assert (watcher.local_map.states == SEEN_OCCUPIED).any()
    for k in range(120, 140):
        watcher.look(k / 20, at(k / 20))
    (on,) = watcher.confirmed
    assert on.id == moving.id
    assert on.still == 0.0
    assert not (watcher.local_map.states == SEEN_OCCUPIED).any()


# -- out of sight ----------------------------------------------------------------------------------


def behind(t):
    return [PILLAR, (4.0, -3.0 + 0.8 * t, 0.25)]


def test_an_obstacle_that_goes_behind_another_is_predicted():
    watcher = Watcher()
    watcher.watch(behind, 2.2)
    (moving,) = watcher.confirmed
    for k in range(45, 80):
        watcher.look(k / 20, behind(k / 20))
    (hidden,) = watcher.of("occluded")
    assert hidden.id == moving.id
    assert (hidden.x, hidden.y) == pytest.approx((4.0, -3.0 + 0.8 * 3.95), abs=0.3)
    assert hidden.vy == pytest.approx(0.8, abs=0.15)
    assert hidden.unseen > 0.5
    assert hidden.position_sd > moving.position_sd + 0.05


def test_an_obstacle_that_comes_out_again_is_the_same_track():
    watcher = Watcher()
    watcher.watch(behind, 6.5)
    (track,) = watcher.confirmed
    assert (track.vx, track.vy) == pytest.approx((0.0, 0.8), abs=0.1)
    assert track.age == pytest.approx(6.5, abs=0.3)
    assert watcher.of("occluded") == []


def test_a_track_that_stays_hidden_waits_behind_the_edge_for_a_limited_time():
    def hiding(t):
        return [PILLAR, (4.0, min(-3.0 + 0.8 * t, 0.0), 0.25)]

    watcher = Watcher()
    watcher.watch(hiding, 7.5)
    (hidden,) = watcher.of("occluded")
    assert abs(math.atan2(hidden.y, hidden.x)) < math.asin(0.5 / 2.0) + 0.06
    for k in range(150, 220):
        watcher.look(k / 20, hiding(k / 20))
    assert watcher.of("occluded") == []


def test_a_hiding_place_that_is_seen_empty_ends_the_track():
    watcher = Watcher()
    watcher.watch(behind, 3.5)
    assert watcher.of("occluded")
    for k in range(71, 80):
        watcher.look(k / 20, [])
    assert watcher.of("occluded", "confirmed") == []


def test_scans_of_two_sensors_do_not_disturb_each_other():
    """One looks ahead and one back, in turn; the obstacle is only ahead."""
    half = Lidar(360, math.pi, 0.05, 8.0)
    watcher = Watcher(half)
    back = LidarSimulator(half, OPEN, (), 0.01, np.random.default_rng(7))
    for k in range(40):
        discs = [(3.0, -1.0 + 0.03 * k, 0.3)]
        watcher.look(k / 20, discs)
        watcher.look(k / 20 + 0.03, discs, Pose2D(0.0, 0.0, math.pi), back)
        if k > 12:
            (track,) = watcher.confirmed
            assert track.vy == pytest.approx(0.6, abs=0.15)
    assert watcher.ever == {track.id}


def test_forget_drops_all_tracks():
    watcher = Watcher()
    watcher.watch(lambda t: [(3.0, -1.0 + t, 0.3)], 1.0)
    assert watcher.confirmed
    watcher.tracker.forget()
    assert watcher.tracker.tracks == ()


def test_a_scan_without_readings_is_taken_in():
    watcher = Watcher()
    points, moving = watcher.look(0.0, [])
    assert len(points) == len(moving) == 0
    assert watcher.tracker.tracks == ()

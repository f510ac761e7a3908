"""A map that is turned is driven on as one that is not."""

import math

import numpy as np
import pytest

from driving import ROUND, Drive, room
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.navigator.aligned import (
    as_moving,
    turned,
    turned_disc,
    turned_goal,
    turned_path,
    turned_pose,
)
from dynastar.path import Path
from dynastar.perception import MovingObstacle
from dynastar.robot import arc
from dynastar.simulation.lidar import LidarSimulator

YAW = 0.6
WALL = (4.0, 0.0, 4.3, 3.6)


def lying(grid, yaw=YAW):
    """A grid turned about the origin."""
    return OccupancyGrid(grid.values, GridFrame(grid.resolution, 0.0, 0.0, yaw), grid.keepout)


def in_room(pose):
    """A pose in the turned room as seen from the room."""
    return turned_pose(pose, -YAW)


def turned_drive(known, true, start=(1.5, 2.0, 0.3)):
    pose = turned_pose(Pose2D(*start), YAW)
    return Drive(lying(known), true=lying(true), pose=pose)


def test_turning_there_and_back_changes_nothing_and_by_nothing_is_the_same_thing():
    points = np.random.default_rng(0).uniform(-9.0, 9.0, (5, 2))
    pose, goal = Pose2D(3.0, -2.0, 3.0), Goal(1.0, 2.0, -3.0)
    disc, path = MovingObstacle(1.0, 2.0, 0.5, -0.2, 0.3), Path(points)
    assert turned(turned(points, 1.3), -1.3) == pytest.approx(points)
    assert turned_pose(turned_pose(pose, 1.3), -1.3) == pytest.approx(pose)
    assert turned_goal(turned_goal(goal, 1.3), -1.3) == pytest.approx(goal)
    assert turned_goal(Goal(1.0, 2.0), 1.3).heading is None
    assert turned_disc(turned_disc(disc, 1.3), -1.3) == pytest.approx(disc)
    assert turned_path(turned_path(path, 1.3), -1.3).points == pytest.approx(points)
    assert turned(points, 0.0) is points
    assert turned_pose(pose, 0.0) is pose
    assert turned_path(path, 0.0) is path
    twist = Twist(1.0, 0.5)
    there = turned_pose(arc(pose, twist, 1.0), 0.4)
    assert there == pytest.approx(arc(turned_pose(pose, 0.4), twist, 1.0))


@pytest.mark.parametrize("yaw", [0.0, YAW])
def test_moving_obstacles_that_cannot_be_are_a_fault(yaw):
    one = MovingObstacle(1.0, 2.0, 0.5, -0.2, 0.3)
    assert as_moving([one], yaw) == ([turned_disc(one, yaw)], None)
    odd = [one._replace(x=math.nan), one._replace(vy=math.inf), one._replace(radius=math.inf)]
    for other in [*odd, one._replace(radius=-0.1)]:
        found, wrong = as_moving([one, other], yaw)
        assert found is None
        assert wrong.startswith(f"a moving obstacle is {tuple(other)}: expected MovingObstacle(")


def test_goals_with_headings_are_reached_round_what_the_map_does_not_show():
    drive = turned_drive(room(8.0, 6.0, WALL), room(8.0, 6.0, WALL, (2.5, 2.4, 3.0, 4.5)))
    goal = turned_goal(Goal(6.5, 2.0, -1.0), YAW)
    drive.navigator.set_goal(goal)
    drive.until("arrived")
    at = in_room(drive.pose)
    assert math.dist(at[:2], (6.5, 2.0)) < 0.3
    assert abs(math.remainder(at.theta + 1.0, math.tau)) < 0.15
    plan = drive.status.plan.path.points
    assert drive.status.planning_frame.yaw == YAW
    assert plan[-1] == pytest.approx((goal.x, goal.y))
    assert drive.navigator.planning_map.seen.any()


def test_a_given_path_is_followed():
    drive = turned_drive(room(), room())
    drive.navigator.follow(turned(np.array([(1.5, 2.0), (4.0, 4.5), (6.5, 2.0)]), YAW))
    highest = 0.0
    while drive.status.state != "arrived":
        drive.tick()
        highest = max(highest, in_room(drive.pose).y)
        assert drive.now < 60.0
    assert highest > 3.5
    assert math.dist(in_room(drive.pose)[:2], (6.5, 2.0)) < 0.3


def test_tracks_are_where_things_move():
    drive = turned_drive(room(), room(), start=(1.5, 3.0, 0.0))
    for k in range(20):
        y = 1.0 + 0.1 * k
        x0, x1 = 4.0, 4.5
        box = np.array([(x0, y), (x1, y), (x1, y + 0.5), (x0, y + 0.5)])
        drive.lidar = LidarSimulator(ROUND.lidar, lying(room()), [turned(box, YAW)])
        drive.tick()
    (track,) = [one for one in drive.status.tracks if one.state == "confirmed"]
    seen = turned_disc(track, -YAW)
    assert (seen.x, seen.y) == pytest.approx((4.25, y + 0.25), abs=0.3)
    assert (seen.vx, seen.vy) == pytest.approx((0.0, 1.0), abs=0.3)


def test_moving_obstacles_that_are_given_are_where_they_are_said_to_be():
    drive = turned_drive(room(), room(), start=(1.5, 3.0, 0.0))
    drive.navigator.set_goal(turned_goal(Goal(6.5, 3.0), YAW))
    ahead = turned_disc(MovingObstacle(3.0, 3.0, 0.0, 0.0, 0.3), YAW)
    gaps = []
    for _ in range(60):
        drive.tick(movers=[ahead])
        gaps.append(math.dist(drive.pose[:2], (ahead.x, ahead.y)) - 0.55)
    assert min(gaps) > 0.0
    assert in_room(drive.pose).x > 3.0


def test_a_map_with_another_yaw_begins_anew():
    drive = turned_drive(room(), room())
    drive.navigator.set_goal(turned_goal(Goal(6.5, 2.0), YAW))
    drive.for_seconds(1.0)
    before = drive.pose
    # The same ground on a map of its own, large enough for the turned room.
    values = np.zeros((120, 160), np.int8)
    drive.navigator.set_map(OccupancyGrid(values, GridFrame(0.1, -5.0, -2.0)))
    assert not (drive.navigator.sensing.local_map.free_at >= 0.0).any()
    drive.until("arrived")
    assert math.dist(drive.pose[:2], before[:2]) > 2.0
    assert math.dist(in_room(drive.pose)[:2], (6.5, 2.0)) < 0.3

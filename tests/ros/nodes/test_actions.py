"""Nav2's actions and tf over the real middleware, with a room that this test simulates."""

import math
import time

import numpy as np
import pytest

pytest.importorskip(
    "nav2_msgs", reason="no nav2_msgs here: tests/ros/interfaces/build.sh builds it"
)

from action_msgs.msg import GoalStatus
from nav2_msgs.action import FollowPath, NavigateThroughPoses, NavigateToPose
from rclpy.action import ActionClient
from tf2_msgs.msg import TFMessage

from dynastar.geometry import Pose2D
from dynastar.ros.driving_node import FRAMES, FRAMES_FIXED
from dynastar.ros.middleware import make
from dynastar.ros.outgoing import Messages

OUT = Messages(make)


def pose(x, y, frame="map"):
    return make(
        "geometry_msgs/msg/PoseStamped",
        header=OUT.header(frame, 0.0),
        pose=OUT.pose(Pose2D(x, y, 0.0)),
    )


class Mission:
    """A goal sent to an action, with what came back."""

    def __init__(self, client, kind, name, goal) -> None:
        self.client, self.feedback = client, []
        self._action = ActionClient(client.node, kind, name)
        assert self._action.wait_for_server(timeout_sec=10.0)
        future = self._action.send_goal_async(goal, feedback_callback=self._on_feedback)
        assert client.spin(10.0, future.done)
        self.handle = future.result()
        self._result = self.handle.get_result_async() if self.handle.accepted else None

    def _on_feedback(self, message) -> None:
        self.feedback.append(message.feedback)

    def result(self, seconds: float):
        assert self.client.spin(seconds, self._result.done)
        return self._result.result()


def to_pose(client, x, y, frame="map"):
    goal = NavigateToPose.Goal(pose=pose(x, y, frame))
    return Mission(client, NavigateToPose, "navigate_to_pose", goal)


def test_a_pose_is_reached_and_the_way_there_is_told(office):
    mission = to_pose(office, 5.0, 2.0)
    assert mission.handle.accepted
    done = mission.result(60.0)
    assert done.status == GoalStatus.STATUS_SUCCEEDED
    assert math.dist(office.place, (5.0, 2.0)) < 0.35
    left = [found.distance_remaining for found in mission.feedback]
    assert left[0] > left[-1] > 0.0
    assert mission.feedback[-1].navigation_time.sec >= 1
    assert office.contacts == []


def test_poses_are_reached_in_order(office):
    poses = make("nav_msgs/msg/Goals", goals=[pose(3.5, 2.0), pose(5.0, 2.0)])
    goal = NavigateThroughPoses.Goal(poses=poses)
    mission = Mission(office, NavigateThroughPoses, "navigate_through_poses", goal)
    assert mission.result(60.0).status == GoalStatus.STATUS_SUCCEEDED
    counts = [found.number_of_poses_remaining for found in mission.feedback]
    assert counts[0] == 2
    assert counts[-1] == 1


def test_a_path_of_another_planner_is_followed(office):
    points = np.array([(2.0, 2.0), (3.0, 2.0), (4.0, 1.5), (5.0, 2.0)])
    goal = FollowPath.Goal(path=OUT.path(points, "map", 0.0))
    mission = Mission(office, FollowPath, "follow_path", goal)
    assert mission.result(60.0).status == GoalStatus.STATUS_SUCCEEDED
    assert math.dist(office.place, (5.0, 2.0)) < 0.35
    assert mission.feedback[0].distance_to_goal > mission.feedback[-1].distance_to_goal
    empty = make("nav_msgs/msg/Path", header=OUT.header("map", 0.0))
    for path in (empty, OUT.path(points, "odom", 0.0)):
        refused = Mission(office, FollowPath, "follow_path", FollowPath.Goal(path=path))
        assert not refused.handle.accepted


def test_goals_are_refused_cancelled_and_replaced(office):
    for x, y, frame in ((5.0, 2.0, "odom"), (math.nan, 2.0, "map"), (500.0, 2.0, "map")):
        assert not to_pose(office, x, y, frame).handle.accepted
    first = to_pose(office, 7.2, 10.0)
    assert office.spin(20.0, office.drives)
    second = to_pose(office, 12.0, 12.5)
    replaced = first.result(5.0)
    assert replaced.status == GoalStatus.STATUS_ABORTED
    assert replaced.result.error_msg == "replaced by another goal"
    cancelled = second.handle.cancel_goal_async()
    assert office.spin(10.0, cancelled.done)
    assert second.result(5.0).status == GoalStatus.STATUS_CANCELED
    assert office.spin(5.0, lambda: office.commands[-1][1:] == (0.0, 0.0))
    third = to_pose(office, 7.2, 10.0)
    assert office.spin(20.0, office.drives)
    office.send(5.0, 2.0)
    assert third.result(5.0).status == GoalStatus.STATUS_ABORTED


def test_the_pose_and_the_mount_come_from_tf(client, processes, room_of):
    words = ["-p", "robot:=turtlebot3_burger", "-p", "pose_source:=tf", "-p", "pose_age:=1.0"]
    room = room_of(*words)
    room.run(client, 1.0)
    client.wait_for("tf does not say where 'odom' is in 'map'", 5.0)
    frames = client.node.create_publisher(TFMessage, "/tf", FRAMES)
    fixed = client.node.create_publisher(TFMessage, "/tf_static", FRAMES_FIXED)
    fixed.publish(OUT.transforms([("base_link", "laser", Pose2D(0.05, 0.0, math.pi))], 0.0))
    room.each = lambda: frames.publish(
        OUT.transforms([("map", "odom", Pose2D(0.5, 0.0, 0.0))], room.time)
    )
    room.run(client, 1.0)
    assert "idle" in client.state
    client.send(4.0, 2.5)
    room.run(client, 1.0)
    assert client.drives()
    assert client.plans[-1].poses[0].pose.position.x == pytest.approx(2.5, abs=0.1)
    room.each = lambda: None
    struck = time.monotonic()
    room.run(client, 2.0)
    assert "the transform of 'odom' is" in client.state
    stopped = [at for at, v, _ in client.commands if at > struck and v == 0.0]
    assert stopped
    assert stopped[0] - struck < 1.6

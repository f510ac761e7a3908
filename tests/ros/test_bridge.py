"""Messages in, commands out: what is late, wrong or missing brakes the robot and says why."""

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
import yaml

from dynastar.cli.robots import robot_arguments
from dynastar.config import checked
from dynastar.errors import ConfigError, InputError
from dynastar.geometry import Goal, Pose2D, Twist
from dynastar.io import load_scenario
from dynastar.navigator import configured
from dynastar.robot import ROBOTS
from dynastar.ros.bag import as_read, make
from dynastar.ros.bridge import Bridge, start_request, started
from dynastar.ros.outgoing import Messages
from dynastar.ros.settings import NodeSettings, robot_from, robot_of, robot_table
from dynastar.simulation.run import effective_config

OUT = Messages(make)
EXAMPLES = Path(__file__).parents[2] / "examples"
ROOM = np.zeros((100, 100), np.int8)
ROOM[[0, -1]] = ROOM[:, [0, -1]] = 100
START = Pose2D(1.0, 2.5, 0.0)


def a_map(values=ROOM):
    return OUT.grid(values, (0.05, 0.0, 0.0), "map", 0.0)


def a_goal(x, y, frame="map"):
    pose = OUT.pose(Pose2D(x, y, 0.0))
    return make("geometry_msgs/msg/PoseStamped", header=OUT.header(frame, 0.0), pose=pose)


def a_scan(time, frame="laser"):
    ranges = np.full(360, np.inf, np.float32)
    angles = {"angle_min": 0.0, "angle_increment": math.tau / 360}
    limits = {"range_min": 0.12, "range_max": 3.5, "ranges": ranges}
    return make("sensor_msgs/msg/LaserScan", header=OUT.header(frame, time), **angles, **limits)


def odometry(time, pose=START, twist=Twist(0.0, 0.0)):
    return OUT.odometry(pose, twist, ("odom", "base_link"), time)


def feed(bridge, time, twist=Twist(0.0, 0.0)):
    assert bridge.take("odom", odometry(time, twist=twist)) == ""
    assert bridge.take("scan", a_scan(time)) == ""
    return bridge.tick(time)


@pytest.fixture
def bridge():
    made = Bridge(NodeSettings(), ROBOTS["turtlebot3_burger"], configured("default"))
    assert made.tick(0.0).reason == "no map has come yet"
    assert made.take("map", a_map()) == ""
    return made


def test_it_drives_when_it_has_map_scan_odometry_and_goal(bridge):
    assert bridge.tick(0.0).reason == "no odometry has come yet"
    bridge.take("odom", odometry(0.0))
    assert bridge.tick(0.0).reason == "no scan has come yet"
    assert feed(bridge, 0.05).state == "idle"
    assert bridge.take("goal_pose", a_goal(4.0, 2.5)) == ""
    assert feed(bridge, 0.1).command.v > 0.0


@pytest.mark.parametrize(
    ("after", "says"),
    [
        (lambda d: d.take("odom", odometry(0.5)), "the scan is 0.4"),
        (lambda d: d.take("scan", a_scan(0.5)), "the odometry is 0.4"),
        (lambda d: feed(d, 1.5), "ahead of the clock"),
        (lambda d: d.request(fault="the clock stands still"), "the clock stands still"),
    ],
)
def test_what_is_late_or_ahead_brakes_it(bridge, after, says):
    bridge.take("goal_pose", a_goal(4.0, 2.5))
    for k in range(5):
        assert feed(bridge, 0.05 + 0.01 * k, Twist(0.2, 0.0)).state == "following"
    after(bridge)
    tick = bridge.tick(0.5)
    assert says in tick.reason
    assert tick.state == "sensor_lost"
    assert tick.command.v < 0.2


def tilted(message, degrees):
    half = math.radians(degrees) / 2
    message.pose.pose.orientation = make(
        "geometry_msgs/msg/Quaternion", x=math.sin(half), w=math.cos(half)
    )
    return message


def test_tilted_odometry_drives_or_is_the_reason_for_braking(bridge):
    bridge.take("goal_pose", a_goal(4.0, 2.5))
    assert bridge.take("odom", tilted(odometry(0.05), 4.9)) == ""
    bridge.take("scan", a_scan(0.05))
    assert bridge.tick(0.05).command.v > 0.0
    says = "the odometry is tilted by 8.0 degrees: expected at most 5"
    assert bridge.take("odom", tilted(odometry(0.5), 8.0)) == says
    bridge.take("scan", a_scan(0.5))
    tick = bridge.tick(0.5)
    assert (tick.state, tick.reason) == ("sensor_lost", says)
    assert "odometry" not in feed(bridge, 0.6).reason


def test_what_is_missing_because_it_was_refused_says_why():
    own = NodeSettings(pose_source="amcl")
    bridge = Bridge(own, ROBOTS["turtlebot3_burger"], configured("default"))
    bridge.take("map", make_short())
    assert "values: expected" in bridge.tick(0.0).reason
    bridge.take("map", a_map())
    bridge.take("odom", tilted(odometry(0.0), 9.0))
    assert "odometry is tilted by 9.0" in bridge.tick(0.0).reason
    bridge.take("odom", odometry(0.0))
    lidar = OUT.transforms([("base_link", "laser", START)], 0.0)
    lidar.transforms[0].transform.rotation = tilted(odometry(0.0), 20.0).pose.pose.orientation
    bridge.take("/tf_static", lidar)
    bridge.take("scan", a_scan(0.0))
    assert "frame 'laser', seen from 'base_link', is tilted by 20.0" in bridge.tick(0.0).reason
    lidar.transforms[0].transform.rotation = odometry(0.0).pose.pose.orientation
    bridge.take("/tf_static", lidar)
    bridge.take("scan", a_scan(0.0))
    assert bridge.tick(0.0).reason == "the pose in the map is not known yet"
    pose = tilted(odometry(0.0), 30.0).pose
    header = OUT.header("map", 0.0)
    bridge.take(
        "amcl_pose", make("geometry_msgs/msg/PoseWithCovarianceStamped", header=header, pose=pose)
    )
    assert "the pose in the map is tilted by 30.0" in bridge.tick(0.0).reason


def test_goals_that_cannot_be_leave_the_one_under_way(bridge):
    bridge.take("goal_pose", a_goal(4.0, 2.5))
    for goal, says in (
        (a_goal(4.0, 2.5, "odom"), "frame 'odom'"),
        (a_goal(math.nan, 2.5), "finite"),
        (a_goal(400.0, 2.5), "off the map"),
    ):
        words = bridge.take("goal_pose", goal)
        assert words.startswith("the goal is refused")
        assert re.search(says, words)
        assert bridge.navigator.mission.goals == [Goal(4.0, 2.5, 0.0)]


def test_a_pose_from_tf_has_to_be_there_and_new():
    own = NodeSettings(pose_source="tf", pose_age=1.0)
    bridge = Bridge(own, ROBOTS["turtlebot3_burger"], configured("default"))
    bridge.take("map", a_map())
    assert "tf does not say where 'odom' is in 'map'" in feed(bridge, 0.0).reason
    bridge.take("/tf", OUT.transforms([("map", "odom", Pose2D(0.5, 0.0, 0.0))], 0.0))
    tick = feed(bridge, 0.05)
    assert (tick.state, tick.robot.pose.x) == ("idle", 1.5)
    assert "transform of 'odom' is 1.20 s old" in feed(bridge, 1.2).reason
    static = OUT.transforms([("map", "odom", Pose2D(0.5, 0.0, 0.0))], 0.0)
    bridge.take("/tf_static", static)
    assert feed(bridge, 9.0).state == "idle"


def test_a_pose_from_tf_that_is_stamped_ahead_brakes_it_until_one_of_now_comes():
    own = NodeSettings(pose_source="tf", pose_age=1.0)
    bridge = Bridge(own, ROBOTS["turtlebot3_burger"], configured("default"))
    bridge.take("map", a_map())
    bridge.take("/tf", OUT.transforms([("map", "odom", Pose2D(0.5, 0.0, 0.0))], 5000.0))
    assert "is stamped 5000.00 s ahead of the clock" in feed(bridge, 0.0).reason
    bridge.take("/tf", OUT.transforms([("map", "odom", Pose2D(0.7, 0.0, 0.0))], 0.05))
    tick = feed(bridge, 0.05)
    assert (tick.state, tick.robot.pose.x) == ("idle", 1.7)


def test_a_scenario_tells_the_node_all_of_its_robot():
    from dynastar.robot import Limits
    from dynastar.ros.settings import fields_of, flat, parameters_of

    file = EXAMPLES / "features" / "robot.toml"
    scenario = load_scenario(file)
    words = parameters_of(scenario)
    told = dict(word.split(":=") for word in words[2::2])
    assert set(words[1::2]) == {"-p"}
    values = {name: yaml.safe_load(value) for name, value in told.items()}
    known = {
        *fields_of(NodeSettings),
        *fields_of(type(configured())),
        *fields_of(Limits, "limits."),
    }
    assert set(values) <= known
    limits = scenario.robot.limits._asdict()
    assert {name: values[f"limits.{name}"] for name in limits} == limits
    config = effective_config(scenario)._replace(period=0.05)  # that of the simulator's node
    preset = flat(configured(scenario.preset))
    for name, value in flat(config).items():
        assert values.get(name, preset[name]) == value
    shape = scenario.robot.footprint
    assert values.get("radius", shape.circumscribed) == shape.circumscribed
    assert values.get("polygon", []) == pytest.approx(shape.vertices.reshape(-1).tolist())
    own = checked(NodeSettings, {k: values[k] for k in fields_of(NodeSettings) if k in values})
    made = robot_of(ROBOTS[own.robot], scenario.robot.limits, own)
    assert made.lidar == scenario.robot.lidar
    assert made.footprint.vertices == pytest.approx(scenario.robot.footprint.vertices)


def test_a_robots_file_tells_a_node_what_it_declares_and_leaves_the_mount_to_tf(tmp_path):
    def told(text, own_period=False):
        file = tmp_path / "mine.toml"
        file.write_text(text)
        words = robot_arguments(str(file), own_period)
        return dict(word.split(":=") for word in words[2::2])

    settings = "[navigator]\nperiod = 0.12\nscan_age = 0.45\nlatency = 0.15\n"
    plain = told(f'[robot]\nbase = "turtlebot3_burger"\n[sensor]\nbeams = 180\n{settings}')
    assert "laser_pose" not in plain
    assert (plain["laser_beams"], plain["latency"], plain["period"]) == ("180", "0.15", "0.12")
    assert plain["data_age"] == plain["scan_age"] == "0.45"
    mounted = told('[robot]\nbase = "jackal"\n[sensor]\nx = 0.2\n[navigator]\nperiod = 0.12', True)
    assert mounted["laser_pose"] == "[0.2, 0.0, 0.0]"
    assert "period" not in mounted
    assert "data_age" not in mounted


@pytest.mark.parametrize("laser_range", [(0.1,), (5.0, 0.1), (0.1, 0.2, 3.0)])
def test_a_range_of_the_lidar_that_cannot_be_is_refused(laser_range):
    burger = ROBOTS["turtlebot3_burger"]
    with pytest.raises(ConfigError):
        robot_of(burger, burger.limits, NodeSettings(laser_range=laser_range))


def test_the_readings_that_mean_no_return_are_the_robots_and_are_recorded():
    burger = ROBOTS["turtlebot3_burger"]
    robot = robot_of(burger, burger.limits, NodeSettings(laser_nothing=(0.0, math.nan)))
    recorded = robot_from(json.loads(json.dumps(robot_table(robot))))
    for one in (robot, recorded):
        assert one.lidar.nothing == pytest.approx((0.0, math.nan), nan_ok=True)
        assert one.lidar._replace(nothing=()) == burger.lidar


def test_the_mount_of_the_lidar_is_from_tf_unless_it_is_given(bridge):
    bridge.take("scan", a_scan(0.0))
    assert bridge._scan.mount == ROBOTS["turtlebot3_burger"].lidar.mount
    bridge.take("/tf_static", OUT.transforms([("base_link", "laser", Pose2D(0.1, 0.0, 1.0))], 0.0))
    bridge.take("scan", a_scan(0.1))
    assert bridge._scan.mount == pytest.approx((0.1, 0.0, 1.0))
    bridge.settings = bridge.settings._replace(laser_pose=(0.0, 0.0, 0.0))
    bridge.take("scan", a_scan(0.2))
    assert bridge._scan.mount == ROBOTS["turtlebot3_burger"].lidar.mount


@pytest.mark.parametrize(("turn", "drops"), [(0.0, False), (math.pi, True)])
def test_what_a_lidar_saw_is_dropped_when_it_turns_out_to_be_mounted_otherwise(bridge, turn, drops):
    feed(bridge, 0.0)
    before = bridge.navigator.sensing
    lidar = ROBOTS["turtlebot3_burger"].lidar.mount
    mount = Pose2D(lidar.x, lidar.y, turn)
    bridge.take("/tf_static", OUT.transforms([("base_link", "laser", mount)], 0.0))
    feed(bridge, 0.1)
    after = bridge.navigator.sensing
    assert (after is not before) == drops
    feed(bridge, 0.2)
    assert bridge.navigator.sensing is after


def test_masks_become_keepout_zones_and_speed_limits(bridge):
    zone = np.zeros_like(ROOM)
    zone[40:60, 40:60] = 100
    assert bridge.take("keepout_filter_mask", a_map(zone)) == ""
    assert bridge.grid.keepout.sum() == 400
    assert bridge.take("speed_filter_mask", a_map(zone // 2)) == ""
    assert bridge.grid.speed_limit[50, 50] == pytest.approx(0.11)
    assert "expected 100 x 100" in bridge.take("map", make_short())
    assert bridge.grid.keepout.sum() == 400


def test_a_resolution_that_was_a_float32_refines_nothing(bridge):
    fine = configured("default", {"resolution": 0.05})
    bridge = Bridge(NodeSettings(), ROBOTS["jackal"], fine)
    bridge.take("map", as_read("nav_msgs/msg/OccupancyGrid", a_map()))
    assert bridge.grid.resolution != 0.05
    assert bridge.navigator.planning_map.prior.shape == ROOM.shape


def make_short():
    message = a_map()
    message.data = message.data[:-1]
    return message


def test_requests_are_carried_out_and_told(bridge):
    feed(bridge, 0.0)
    words = bridge.request(goals=[(4.0, 2.5, None), (1.0, 1.0, 0.5)])
    assert json.loads(words) == {"goals": [[4.0, 2.5, None], [1.0, 1.0, 0.5]]}
    assert len(bridge.navigator.mission.goals) == 2
    bridge.request(settings={"dwa": {"horizon": 2.5}})
    assert bridge.navigator.config.dwa.horizon == 2.5
    assert len(bridge.navigator.mission.goals) == 2
    bridge.request(cancel=True)
    assert bridge.navigator.mission.goals == []
    bridge.request(clear=True)
    bridge.request(follow=([[1.0, 2.5], [3.0, 2.5]], 0.0))
    assert feed(bridge, 0.05).command.v > 0.0
    with pytest.raises(InputError, match="finite"):
        bridge.request(follow=([[1.0, math.nan]], None))
    with pytest.raises(InputError, match="unknown request 'dance'"):
        bridge.request(dance=True)


def test_a_clock_that_goes_back_drops_the_goal_and_the_data(bridge):
    feed(bridge, 100.0)
    bridge.take("goal_pose", a_goal(4.0, 2.5))
    assert not bridge.jumped(100.0)
    assert not bridge.jumped(99.9)
    assert bridge.jumped(3.0)
    bridge.request(restart="the clock went back")
    assert bridge.navigator.mission.goals == []
    assert bridge.tick(3.0).reason == "no odometry has come yet"
    assert feed(bridge, 3.05).state == "idle"


@pytest.mark.parametrize(
    "request_", [{"restart": "the clock went back"}, {"settings": {"dwa": {"horizon": 2.5}}}]
)
def test_a_robot_under_way_goes_on_with_its_certified_stop(bridge, request_):
    feed(bridge, 100.0)
    bridge.take("goal_pose", a_goal(4.0, 2.5))
    before, fast = feed(bridge, 100.05).command, Twist(0.2, 0.0)
    for k in range(2, 12):
        before = feed(bridge, 100.0 + 0.05 * k, twist=fast).command
    bridge.request(**request_)
    after = bridge.tick(100.6 if "settings" in request_ else 3.0).command
    assert 0.0 < before.v - after.v <= bridge.config.period * bridge.robot.limits.v_brake + 1e-9


def test_other_settings_set_no_robot_off_that_gave_up(bridge):
    feed(bridge, 100.0)
    bridge.take("goal_pose", a_goal(4.0, 2.5))
    bridge.navigator.mission.block("no way is left")
    bridge.request(settings={"dwa": {"horizon": 2.5}})
    assert feed(bridge, 100.1).state == "idle"


def test_settings_that_cannot_be_used_change_nothing(bridge, monkeypatch):
    before = bridge.config, bridge.navigator
    monkeypatch.setattr("dynastar.ros.bridge.Navigator", lambda *given: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        bridge.request(settings={"dwa": {"horizon": 2.5}})
    assert (bridge.config, bridge.navigator) == before


def test_a_given_path_is_kept_by_other_settings(bridge):
    feed(bridge, 100.0)
    bridge.request(follow=([[1.0, 2.5], [3.0, 2.5]], 0.0))
    bridge.request(settings={"dwa": {"horizon": 2.5}})
    assert bridge.navigator.route.given is not None
    assert bridge.navigator.mission.goals == [(3.0, 2.5, 0.0)]


def test_a_driver_can_be_made_again_from_its_first_request():
    own, robot = NodeSettings(pose_source="amcl"), ROBOTS["jackal"]
    config = configured("paper", {"latency": 0.1})
    made = started(json.loads(start_request(own, robot, config))["start"])
    assert (made.settings, made.config, made.robot.limits) == (own, config, robot.limits)
    assert np.array_equal(made.robot.footprint.vertices, robot.footprint.vertices)
    with pytest.raises(InputError):
        started({"settings": {}})

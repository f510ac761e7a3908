"""The layout for Foxglove: a written bag, read by another library, has all that its panels show."""

import json
import re
from dataclasses import replace
from pathlib import Path

import pytest

from dynastar import io
from dynastar.io.examples import example_scenarios
from dynastar.ros.bag import LAYOUT
from dynastar.ros.publishing import PUBLISHES
from dynastar.ros.recording import run_recorded

NAV, SENSOR = "nav_msgs/msg", "sensor_msgs/msg"
SHOWN = {  # schemas that the 3D panel draws, by topic
    "/map": f"{NAV}/OccupancyGrid",
    "/local_map": f"{NAV}/OccupancyGrid",
    "/cost_to_go": f"{NAV}/OccupancyGrid",
    "/plan": f"{NAV}/Path",
    "/local_plan": f"{NAV}/Path",
    "/scan": f"{SENSOR}/LaserScan",
    "/markers": "visualization_msgs/msg/MarkerArray",
}
FILTERED = re.compile(r"(\w+)\[:\]\{(\w+)==\"([^\"]*)\"\}")  # part of a path: items with this value
PANELS = {"3D", "Plot", "StateTransitions", "DiagnosticStatusPanel"}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Ten seconds among ten walkers."""
    made = tmp_path_factory.mktemp("bags") / "crowd"
    scenario = replace(io.load_scenario(example_scenarios()["crowd"]), time_limit=10.0)
    run_recorded(scenario, made)
    return made


@pytest.fixture(scope="module")
def messages(folder):
    """Schema and messages by topic, as the library mcap reads them."""
    reader = pytest.importorskip("mcap_ros2.reader")
    found = {}
    for one in reader.read_ros2_messages(str(next(folder.glob("*.mcap")))):
        found.setdefault(one.channel.topic, (one.schema.name, []))[1].append(one.ros_msg)
    return found


@pytest.fixture(scope="module")
def layout(folder):
    return json.loads((folder / "foxglove.json").read_text())


def panels_of(node):
    """The panels of a layout's tree, from left to right."""
    if isinstance(node, str):
        return [node]
    assert node["direction"] in ("row", "column")
    assert 0 < node["splitPercentage"] < 100
    return [*panels_of(node["first"]), *panels_of(node["second"])]


def values_at(messages, path):
    """The values that a panel's path such as /odom.twist.twist.linear.x has in a bag."""
    topic, *fields = re.split(r"\.(?![^{]*\})", path)
    found = messages[topic][1]
    for field in fields:
        named = FILTERED.fullmatch(field)
        if named is None:
            found = [getattr(one, field) for one in found]
            continue
        name, key, value = named.groups()
        found = [
            item for one in found for item in getattr(one, name) if getattr(item, key) == value
        ]
    return found


def test_every_panel_of_the_tree_is_set_up_and_of_a_kind_that_foxglove_has(layout):
    panels = panels_of(layout["layout"])
    assert sorted(panels) == sorted(layout["configById"])
    assert {panel.partition("!")[0] for panel in panels} == PANELS


def test_the_3d_panel_finds_its_topics_and_frames(layout, messages):
    panel = layout["configById"]["3D!scene"]
    assert set(panel["topics"]) == set(SHOWN)
    for topic, schema in SHOWN.items():
        assert messages[topic][0] == schema, topic
    frames = {one.child_frame_id for tf in messages["/tf"][1] for one in tf.transforms}
    fixed = {one.child_frame_id for tf in messages["/tf_static"][1] for one in tf.transforms}
    assert panel["followTf"] in frames
    assert {one.header.frame_id for one in messages["/scan"][1]} <= fixed
    assert {one.header.frame_id for one in messages["/cost_to_go"][1]} == {"map"}


def test_the_markers_are_the_robot_the_candidates_and_the_tracks(layout, messages):
    named = layout["configById"]["3D!scene"]["topics"]["/markers"]["namespaces"]
    shown = {}
    for array in messages["/markers"][1]:
        for marker in array.markers:
            shown.setdefault(marker.ns, []).append(marker)
    assert set(shown) - {""} == set(named)
    lines = max(shown["candidates"], key=lambda marker: len(marker.points))
    assert len(lines.points) == len(lines.colors) > 100
    assert len({(colour.r, colour.g, colour.b) for colour in lines.colors}) > 10
    assert {(marker.id, marker.type) for marker in shown["robot"]} == {(0, 3)}


def test_the_cost_to_go_falls_along_the_path(messages):
    grid = messages["/cost_to_go"][1][-1]
    info, path = grid.info, messages["/plan"][1][-1].poses[-1].pose.position
    robot = messages["/odom"][1][-1].pose.pose.position
    values = [
        (grid.data[row * info.width + column], row, column)
        for row in range(info.height)
        for column in range(info.width)
    ]
    known = [one for one in values if one[0] >= 0]
    assert (min(known)[0], max(known)[0]) == (0, 100)
    assert len({value for value, _, _ in known}) > 50
    _, row, column = min(known)
    x = info.origin.position.x + (column + 0.5) * info.resolution
    y = info.origin.position.y + (row + 0.5) * info.resolution
    ahead = (x - robot.x) * (path.x - robot.x) + (y - robot.y) * (path.y - robot.y)
    assert ahead > 0.0


def test_the_other_panels_find_values(layout, messages):
    for name in ("Plot!speed", "StateTransitions!states"):
        for path in layout["configById"][name]["paths"]:
            assert len(values_at(messages, path["value"])) > 5, path["value"]
    reasons = values_at(
        messages, layout["configById"]["StateTransitions!states"]["paths"][0]["value"]
    )
    assert "following: the path" in reasons
    panel = layout["configById"]["DiagnosticStatusPanel!reason"]
    status = [one.status[0] for one in messages[panel["topicToRender"]][1]]
    assert {one.name for one in status} == {panel["selectedName"]}
    assert {"limited by", "path", "goals left"} <= {pair.key for pair in status[-1].values}


def test_the_live_nodes_publish_what_the_layout_shows():
    topics = set(json.loads(Path(LAYOUT).read_text())["configById"]["3D!scene"]["topics"])
    simulated = {"/map", "/scan"}
    assert topics - simulated <= {f"/{name}" for name in PUBLISHES}

"""Scenario files: what they mean, and what they say about a typo or a contradiction."""

import copy
import math
import tomllib

import numpy as np
import pytest

from dynastar.errors import InputError, ScenarioError
from dynastar.geometry import Goal
from dynastar.grid import OccupancyGrid
from dynastar.io import load_scenario, save_map, save_scenario
from dynastar.io.scenario_file import read_scenario
from dynastar.io.scenario_things import contains, read_mover, read_obstacle
from dynastar.robot import ROBOTS
from dynastar.simulation.scenario import Scenario

SMALL = """
map.rows = ["#....", ".....", "....."]
robot = "paper"
start = [0.5, 0.5]
goal = [4.5, 0.5]
"""
WHOLE = """
name = "an office"
map = "office.yaml"
world = "office.yaml"
seed = 7
time_limit = 60
latency = 0.1
unknown = "free"
goal_tolerance = 0.5
heading_tolerance = 0.2
preset = "paper"

[robot]
base = "turtlebot3_burger"
radius = 0.2
limits.v_max = 0.3

[sensor]
beams = 180
range_max = 8
range_bound = 0.02
heading_bound = 0.01

[start]
x = 1.0
y = 2.0
heading = 0.5

[[goals]]
x = 3.0
y = 2.0

[[goals]]
x = 4
y = 1
heading = 3.0

[[obstacles]]
box = [2.0, 1.0, 1.0, 0.5]
yaw = 0.3

[[obstacles]]
disc = [4.0, 3.0, 0.2]

[[movers]]
radius = 0.3
waypoints = [[0, 0], [2, 0]]
speed = 0.5

[navigator]
period = 0.05
"""


def load(tmp_path, text, name="small.toml"):
    save_map(OccupancyGrid(np.zeros((5, 6), bool)), tmp_path / "office.yaml")
    (tmp_path / name).write_text(text)
    return load_scenario(tmp_path / name)


def test_a_small_scenario_has_the_defaults(tmp_path):
    scenario = load(tmp_path, SMALL)
    assert scenario.name == "small"
    assert scenario.robot == ROBOTS["paper"]
    assert scenario.start == (0.5, 0.5, None)
    assert scenario.goals == (Goal(4.5, 0.5, None),)
    assert scenario.grid.occupied.sum() == 1
    assert scenario.grid.occupied[2, 0]
    assert (scenario.world, scenario.obstacles, scenario.movers) == (None, (), ())
    assert (scenario.time_limit, scenario.seed, scenario.preset) == (300.0, 0, "default")
    assert scenario.source == tomllib.loads(SMALL)


def test_the_readings_that_mean_no_return_are_read_and_written_back(tmp_path):
    scenario = load(tmp_path, SMALL + "\n[sensor]\nnothing = [0, nan, 65.5]\n")
    again = load_scenario(save_scenario(scenario, tmp_path / "again"))
    for nothing in (scenario.robot.lidar.nothing, again.robot.lidar.nothing):
        assert nothing == pytest.approx((0.0, math.nan, 65.5), nan_ok=True)


def test_a_whole_scenario_is_read_key_by_key(tmp_path):
    scenario = load(tmp_path, WHOLE)
    assert scenario.name == "an office"
    assert scenario.grid.values.shape == (5, 6)
    assert scenario.world is not None
    assert (scenario.seed, scenario.time_limit, scenario.latency) == (7, 60.0, 0.1)
    assert (scenario.unknown, scenario.preset) == ("free", "paper")
    assert (scenario.goal_tolerance, scenario.heading_tolerance) == (0.5, 0.2)
    base = ROBOTS["turtlebot3_burger"]
    assert scenario.robot.limits == base.limits._replace(v_max=0.3)
    assert scenario.robot.footprint.circumscribed == 0.2
    assert scenario.robot.lidar == base.lidar._replace(beams=180, range_max=8.0)
    assert scenario.noise == (0.02, 0.0, 0.01)
    assert scenario.start == (1.0, 2.0, 0.5)
    assert scenario.goals == (Goal(3.0, 2.0), Goal(4.0, 1.0, 3.0))
    assert [len(polygon) for polygon in scenario.obstacles] == [4, 24]
    assert len(scenario.movers) == 1
    assert scenario.navigator == {"period": 0.05}


@pytest.mark.parametrize(
    ("change", "message"),
    [
        ("sed = 3", r"unknown key 'sed' \(did you mean 'seed'\?\)"),
        ("seed = 1.5", "'seed' is 1.5: expected a whole number"),
        ("seed = -1", "'seed' is -1"),
        ("time_limit = nan", "'time_limit' is nan"),
        ("time_limit = 0", "'time_limit' is 0"),
        ("latency = inf", "'latency' is inf"),
        ("unknown = 'maybe'", "'unknown' is 'maybe'"),
        ("preset = 'papre'", "'preset' is 'papre'"),
        ("name = 3", "'name' is 3"),
        ("goals = [[1, 1]]", "'goal' and there is 'goals'"),
        ("world = 'no.yaml'", "no.yaml: there is no such file"),
        ("world = 3", "'world' is 3"),
        ("world.rows = ['x']", r"'world.rows'.*line 1, column 1"),
        ("world.rows = ['#####', '#####', '#####']", "start .* true map or occupied"),
        ("[sensor]\nbeam = 3", r"'sensor.beam' \(did you mean 'beams'\?\)"),
        ("[sensor]\nbeams = 0", "'sensor.beams' is 0"),
        ("[sensor]\nrange_bound = -1", "'sensor.range_bound' is -1"),
        ("[sensor]\nrange_min = 6", "range_min is 6 m: expected less than"),
        ("sensor = 3", "'sensor' is 3"),
        ("obstacles = 3", "'obstacles' is 3"),
        ("[[obstacles]]\nbox = [1, 1, 0, 1]", r"'obstacles\[0\].box\[2\]' is 0"),
        ("[[obstacles]]\ndisc = [1, 1, -1]", r"'obstacles\[0\].disc\[2\]' is -1"),
        ("[[obstacles]]\ndisc = [1, inf, 1]", r"'obstacles\[0\].disc\[1\]' is inf"),
        ("[[obstacles]]\ndisc = [1, 1]", "has 2 values"),
        ("[[obstacles]]\ndisk = [1, 1, 1]", r"did you mean 'disc'"),
        ("[[obstacles]]", "expected one of box, disc, polygon"),
        ("[[obstacles]]\ndisc = [1, 1, 1]\nbox = [1, 1, 1, 1]", "has box and disc"),
        ("[[obstacles]]\ndisc = [1, 1, 1]\nyaw = 1", "yaw' is for a box only"),
        ("[[obstacles]]\npolygon = [[0, 0], [1, 1]]", "has 2 corners"),
        ("[[obstacles]]\npolygon = [[0, 0], [1, 1], [1, 0], [0, 1]]", "crosses itself"),
        ("[[obstacles]]\npolygon = [[0, 0], [1, 1], [2, 2]]", "no area"),
        ("[[obstacles]]\ndisc = [0.5, 0.5, 1]", r"start .* inside obstacles\[0\]"),
        (
            "[[movers]]\nwaypoints = [[0, 0], [1, 1]]\nspeed = 1",
            r"missing key 'movers\[0\].radius'",
        ),
        ("[[movers]]\nradius = 0.3", "expected one of waypoints, from, track"),
        ("[[movers]]\nradius = 0.3\nwaypoints = [[0, 0], [1, 1]]", "missing key 'movers.*speed'"),
        ("[[movers]]\nradius = 0.3\nwaypoints = [[0, 0], [1, 1]]\nspeed = 0", "speed' is 0"),
        ("[[movers]]\nradius = 0.3\nwaypoints = [[0, 0], [1, 1]]\nsped = 1", "'speed'"),
        ("[[movers]]\nradius = 0.3\nwaypoints = [[1, 1]]\nspeed = 1", "2 points"),
        ("[[movers]]\nradius = 0.3\nwaypoints = [[1, 1], [1, 1]]\nspeed = 1", "twice in a row"),
        ("[[movers]]\nradius = 0.3\nfrom = [1, 1]", "missing key 'movers.*velocity'"),
        ("[[movers]]\nradius = 0.3\nfrom = [1]\nvelocity = [1, 1]", "'movers.0..from' has 1"),
        ("[[movers]]\nradius = 0.3\nform = [1, 1]\nvelocity = [1, 1]", "did you mean 'from'"),
        ("[[movers]]\nradius = 0.3\nfrom = [1, 1]\nvelocity = [0, 0]", "velocity' is zero"),
        (
            "[[movers]]\nradius = 0.3\nfrom_ = [1, 1]\nvelocity = [1, 0]",
            "unknown key 'movers.0..from_'",
        ),
        ("[[movers]]\nradius = 0.3\ntrack = [[1, 0, 0], [1, 1, 1]]", "times rise"),
        ("[[movers]]\nradius = 0.3\ntrack = [[1, 0, 0]]", "one row only"),
        ("[[movers]]\nradius = 0.3\ntrack = []", "times rise"),
        ("[[movers]]\nradius = 0.3\ntrack = [[1, 0, 0]]\nspeed = 1", "does not go with 'track'"),
        ("[[movers]]\nradius = 1\nfrom = [1, 1]\nvelocity = [1, 1]", r"inside movers\[0\]"),
        ("[navigator]\nperiodd = 1", r"in \[navigator\]: unknown key 'periodd' .*'period'"),
        ("[navigator.dwa]\nhorizn = 1", r"unknown key 'dwa.horizn'"),
        ("this is no TOML", "not valid TOML"),
        ("x = " + "[" * 100000, "nested too deep|not valid TOML"),
    ],
)
def test_what_is_wrong_is_named_after_the_file(tmp_path, change, message):
    with pytest.raises(ScenarioError, match=rf"small\.toml: .*({message})") as caught:
        load(tmp_path, SMALL + change)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("name", ["v", "omega"])
def test_a_robot_that_could_not_move_is_refused(tmp_path, name):
    text = SMALL.replace(
        'robot = "paper"', f'robot = {{ base = "paper", limits.{name}_least = 5 }}'
    )
    with pytest.raises(ScenarioError, match=rf"{name}_least is 5 .*: expected at most {name}_max"):
        load(tmp_path, text)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ('robot = "paper"', 'robot = "papre"', "unknown robot 'papre'.*'paper'"),
        ('robot = "paper"', "", "missing key 'robot'"),
        ('robot = "paper"', "robot.radius = 1", "missing key 'robot.base'"),
        ('robot = "paper"', 'robot = {base = "paper", radius = 0}', "'robot.radius' is 0"),
        (
            'robot = "paper"',
            'robot = {base = "paper", limits = {vmax = 1}}',
            r"'robot.limits.vmax' \(did you mean 'v_max'\?\)",
        ),
        (
            'robot = "paper"',
            'robot = {base = "paper", radius = 1, polygon = [[1, 0], [0, 1], [-1, -1]]}',
            "a radius and a polygon",
        ),
        (
            'robot = "paper"',
            'robot = {base = "paper", polygon = [[1, 0], [0, 1], [0.1, 0.1]]}',
            "polygon does not contain|not convex",
        ),
        ("start = [0.5, 0.5]", "", "missing key 'start'"),
        ("start = [0.5, 0.5]", "start = [0.5]", "'start' is"),
        ("start = [0.5, 0.5]", "start = {x = 1, z = 2}", "unknown key 'start.z'"),
        ("start = [0.5, 0.5]", "start = [-0.5, 0.5]", "start .*off the map"),
        ("start = [0.5, 0.5]", "start = [0.5, 2.5]", "start .*occupied"),
        ("start = [0.5, 0.5]", "start = [nan, 2.5]", "'start.x' is nan"),
        ("goal = [4.5, 0.5]", "", "no goal"),
        ("goal = [4.5, 0.5]", "goals = []", "no goal"),
        ("goal = [4.5, 0.5]", "goal = 3", "goal"),
        ("goal = [4.5, 0.5]", "goal = [5.0, 0.5]", "goals.0. .*off the map"),
        ("goal = [4.5, 0.5]", "goals = [[1, 1], [0.5, 2.5]]", "goals.1. .*occupied"),
        ('map.rows = ["#....", ".....", "....."]', "map = 3", "'map' is 3"),
        ('map.rows = ["#....", ".....", "....."]', "map = 'none.yaml'", "none.yaml: there is no"),
        ('map.rows = ["#....", ".....", "....."]', "map = '${HOME}/a.yaml'", "only .*DYNASTAR"),
        ('map.rows = ["#....", ".....", "....."]', "map.row = ['.']", "unknown key 'map.row'"),
        ('map.rows = ["#....", ".....", "....."]', "map.rows = []", "'map.rows'"),
        ('map.rows = ["#....", ".....", "....."]', "map = {rows=['.'], resolution=0}", "resolu"),
    ],
)
def test_what_is_missing_or_contradicts_is_named_after_the_file(tmp_path, old, new, message):
    assert old in SMALL
    with pytest.raises(ScenarioError, match=rf"small\.toml: .*({message})"):
        load(tmp_path, SMALL.replace(old, new))


def leaves(table, path=()):
    items = table.items() if isinstance(table, dict) else enumerate(table)
    for key, value in items:
        yield (*path, key)
        if isinstance(value, dict | list):
            yield from leaves(value, (*path, key))


def test_no_value_of_any_key_gives_anything_but_a_scenario_or_an_input_error(tmp_path):
    save_map(OccupancyGrid(np.zeros((5, 6), bool)), tmp_path / "office.yaml")
    whole = tomllib.loads(WHOLE)
    paths = list(leaves(whole))
    assert len(paths) > 40
    odd = ("", "x", "a\0", -1, 0, 10**400, math.nan, math.inf, True, [], [[]], {}, {"x": 1})
    for path in paths:
        for value in odd:
            table = copy.deepcopy(whole)
            inner = table
            for key in path[:-1]:
                inner = inner[key]
            inner[path[-1]] = value
            try:
                assert isinstance(read_scenario(table, tmp_path, "odd"), Scenario)
            except InputError:
                continue


def test_a_scenario_that_is_no_text_file(tmp_path):
    for content, message in ((b"\xff\xfe", "not UTF-8 text: save it as UTF-8"), (b"", "empty")):
        (tmp_path / "a.toml").write_bytes(content)
        with pytest.raises(ScenarioError, match=message):
            load_scenario(tmp_path / "a.toml")
    with pytest.raises(ScenarioError, match="a directory"):
        load_scenario(tmp_path)
    with pytest.raises(ScenarioError, match="no such file"):
        load_scenario(tmp_path / "none.toml")


def test_a_scenario_may_have_a_byte_order_mark(tmp_path):
    (tmp_path / "a.toml").write_text(SMALL, encoding="utf-8-sig")
    assert load_scenario(tmp_path / "a.toml").goals == (Goal(4.5, 0.5),)


def test_a_map_may_lie_in_the_data_folder(tmp_path, monkeypatch):
    text = SMALL.replace(
        'map.rows = ["#....", ".....", "....."]', 'map = "${DYNASTAR_DATA}/m.yaml"'
    )
    save_map(OccupancyGrid(np.zeros((2, 7), bool)), tmp_path / "data" / "m.yaml")
    monkeypatch.setenv("DYNASTAR_DATA", str(tmp_path / "data"))
    assert load(tmp_path, text).grid.values.shape == (2, 7)
    monkeypatch.delenv("DYNASTAR_DATA")
    with pytest.raises(ScenarioError, match="DYNASTAR_DATA is not set"):
        load(tmp_path, text)


def test_a_box_is_turned_about_its_centre():
    corners = read_obstacle({"box": [2, 3, 4, 2], "yaw": math.pi / 2}, "o")
    assert np.allclose(sorted(corners.tolist()), [[1, 1], [1, 5], [3, 1], [3, 5]])
    turned = read_obstacle({"box": [0, 0, 2, 0.2], "yaw": 0.5}, "o")
    assert contains(turned, 0.9 * math.cos(0.5), 0.9 * math.sin(0.5))
    assert not contains(turned, 0.9 * math.cos(0.5), -0.9 * math.sin(0.5))


def test_a_disc_is_held_by_its_polygon():
    corners = read_obstacle({"disc": [1, 2, 0.5]}, "o") - (1, 2)
    middles = (corners + np.roll(corners, 1, axis=0)) / 2
    assert np.hypot(*middles.T) == pytest.approx(0.5)


def test_waypoints_become_keys_at_constant_speed():
    mover = read_mover({"radius": 0.3, "waypoints": [[0, 0], [3, 4], [3, 6]], "speed": 0.5}, "m", 9)
    assert mover.times.tolist() == [0, 10, 14]
    assert mover.points.tolist() == [[0, 0], [3, 4], [3, 6]]
    assert mover.after == "back_and_forth"


def test_a_loop_closes_and_a_pause_is_as_long_at_every_waypoint():
    row = {"radius": 0.3, "waypoints": [[0, 0], [2, 0]], "speed": 1, "pause": 3, "start": 1}
    loop = read_mover(row | {"after": "loop"}, "m", 9)
    assert loop.times.tolist() == [1, 3, 6, 8, 11]
    assert loop.points[:, 0].tolist() == [0, 2, 2, 0, 0]
    there_and_back = read_mover(row, "m", 9)
    assert there_and_back.times.tolist() == [1, 2.5, 4.5, 6]
    assert there_and_back.points[:, 0].tolist() == [0, 0, 2, 2]


def test_a_constant_velocity_lasts_the_whole_time():
    mover = read_mover({"radius": 1, "from": [1, 2], "velocity": [0.5, 0], "start": 2}, "m", 60.0)
    assert mover.times.tolist() == [2, 62]
    assert mover.points.tolist() == [[1, 2], [31, 2]]


def test_a_track_keeps_its_times():
    mover = read_mover({"radius": 0.3, "track": [[1, 0, 0], [2.5, 1, 0]]}, "m", 60.0)
    assert mover.times.tolist() == [1, 2.5]
    assert mover.after == "vanish"

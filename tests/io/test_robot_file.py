"""The robot in a TOML file, with or without the rest of a scenario."""

from pathlib import Path

import pytest

from dynastar.errors import ScenarioError
from dynastar.io import load_robot, load_scenario
from dynastar.navigator import NavigatorConfig
from dynastar.robot import ROBOTS
from dynastar.simulation.run import effective_config

EXAMPLES = Path(__file__).parents[2] / "examples"
OWN = """\
latency = 0.12
[robot]
base = "jackal"
radius = 0.3
[robot.limits]
v_max = 0.8
[sensor]
beams = 400
range_bound = 0.04
[navigator]
period = 0.05
local_map.narrowest = 0.03
"""


@pytest.fixture
def file(tmp_path):
    return tmp_path / "my_robot.toml"


def test_a_file_of_a_robot_alone_has_its_robot_and_its_settings(file):
    file.write_text(OWN)
    robot, config = load_robot(file)
    assert (robot.limits.v_max, robot.limits.v_brake) == (0.8, ROBOTS["jackal"].limits.v_brake)
    assert (robot.footprint.circumscribed, robot.lidar.beams) == (0.3, 400)
    assert (config.latency, config.period, config.range_error) == (0.12, 0.05, 0.04)
    assert config.local_map.narrowest == 0.03


def test_a_name_alone_is_enough(file):
    file.write_text('robot = "pioneer3dx"\n')
    assert load_robot(file) == (ROBOTS["pioneer3dx"], NavigatorConfig())


@pytest.mark.parametrize(
    "name", ["office/office.toml", "features/robot.toml", "features/keepout.toml"]
)
def test_a_scenario_has_the_robot_that_it_drives(name):
    scenario = load_scenario(EXAMPLES / name)
    robot, config = load_robot(EXAMPLES / name)
    assert repr(robot) == repr(scenario.robot)
    assert robot.lidar == scenario.robot.lidar
    assert config == effective_config(scenario)


def test_the_map_of_a_scenario_is_not_read(file):
    file.write_text('map = "no_such.yaml"\nstart = [9.0, 9.0]\ngoals = []\nrobot = "jackal"\n')
    assert repr(load_robot(file)[0]) == repr(ROBOTS["jackal"])


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("latency = 0.1\n", "missing key 'robot'"),
        (OWN.replace("[robot]", "[robto]"), "did you mean 'robot'"),
        (OWN.replace("v_max", "vmax"), "did you mean 'v_max'"),
        (OWN.replace("0.05", "5.0"), "navigator"),
        (OWN.replace("jackal", "jakal"), "did you mean 'jackal'"),
        (OWN.replace("= 0.12", "="), "TOML"),
        (OWN.replace("beams = 400", "beams = 400\nrange_max = 0.05"), "range_max"),
    ],
)
def test_what_is_wrong_is_said_in_one_line_with_the_file(file, text, said):
    file.write_text(text)
    with pytest.raises(ScenarioError) as error:
        load_robot(file)
    assert str(error.value).startswith(str(file))
    assert said in str(error.value)
    assert "\n" not in str(error.value)

"""The colcon package: its files parse, and name what exists."""

import ast
import re
import tomllib
from pathlib import Path
from xml.etree import ElementTree

import pytest
import yaml

from dynastar.config import checked
from dynastar.navigator import NavigatorConfig
from dynastar.ros.settings import GuardSettings, NodeSettings, fields_of, nested

ROOT = Path(__file__).parents[2]
PACKAGE = ROOT / "ros" / "dynastar_ros"
TOPICS = {"/map", "/local_map", "/scan", "/plan", "/local_plan", "/markers", "/odom", "/goal_pose"}


@pytest.mark.parametrize(
    ("file", "kinds"),
    [("dynastar", [NodeSettings]), ("guard", [NodeSettings, GuardSettings])],
)
def test_its_parameters_are_those_of_the_node(file, kinds):
    given = yaml.safe_load((PACKAGE / "config" / f"{file}.yaml").read_text())
    values = given["/**"]["ros__parameters"]  # in any namespace
    for kind in kinds:
        own = {name: values.pop(name) for name in fields_of(kind) if name in values}
        assert own
        checked(kind, own)
    checked(NavigatorConfig, nested(values))


def test_its_version_and_licence_are_those_of_the_project():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    described = ElementTree.parse(PACKAGE / "package.xml").getroot()
    assert described.findtext("license") == project["license"]
    version = re.search(r'__version__ = "(.*)"', (ROOT / "src/dynastar/__init__.py").read_text())
    assert described.findtext("version") == version[1]
    assert f'version="{version[1]}"' in (PACKAGE / "setup.py").read_text()


def test_launch_files_start_executables_that_exist():
    setup = (PACKAGE / "setup.py").read_text()
    for file in (PACKAGE / "launch").glob("*.py"):
        tree = ast.parse(file.read_text())
        names = re.findall(r'package="dynastar_ros",\s+executable="(\w+)"', file.read_text())
        assert names
        assert all(f'"{name} = dynastar_ros:{name}"' in setup for name in names)
        assert any(getattr(node, "name", "") == "generate_launch_description" for node in tree.body)


def test_the_layout_for_rviz_shows_topics_that_exist():
    rviz = yaml.safe_load((PACKAGE / "rviz" / "dynastar.rviz").read_text())
    manager = rviz["Visualization Manager"]
    shown = [thing["Topic"]["Value"] for thing in manager["Displays"]]
    assert set(shown) < TOPICS

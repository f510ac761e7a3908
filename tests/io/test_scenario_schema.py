"""The schema accepts what the reader accepts, and refuses the common mistakes."""

import copy
import json
import tomllib
from pathlib import Path

import jsonschema
import pytest

from dynastar.cli import main
from dynastar.io.scenario_schema import scenario_schema

EXAMPLES = Path(__file__).parents[2] / "examples"
CHECK = jsonschema.Draft202012Validator(scenario_schema())
GOOD = tomllib.loads((EXAMPLES / "features" / "robot.toml").read_text())


def test_it_is_a_schema():
    jsonschema.Draft202012Validator.check_schema(scenario_schema())


@pytest.mark.parametrize("file", sorted(EXAMPLES.rglob("*.toml")), ids=lambda file: file.stem)
def test_every_example_is_valid(file):
    CHECK.validate(tomllib.loads(file.read_text()))


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("gaol",), [1, 2]),
        (("robot", "base"), "pioneer"),
        (("robot", "limits", "v_max"), "fast"),
        (("robot", "limits", "v_mx"), 1.0),
        (("sensor", "beams"), 2.5),
        (("start",), [1]),
        (("unknown",), "maybe"),
        (("seed",), -1),
        (("map",), 3),
        (("navigator",), {"dwa": {"horizon": -1}}),
        (("movers",), [{"waypoints": [[0, 0], [1, 1]]}]),
        (("speed_limit",), {"type": "percent"}),
    ],
)
def test_mistakes_are_found(path, value):
    scenario = copy.deepcopy(GOOD)
    table = scenario
    for key in path[:-1]:
        table = table[key]
    table[path[-1]] = value
    assert not CHECK.is_valid(scenario)


def test_the_command_prints_and_writes_it(tmp_path, capsys):
    assert main(["schema"]) == 0
    assert json.loads(capsys.readouterr().out) == scenario_schema()
    assert main(["schema", "--out", str(tmp_path / "s.json")]) == 0
    assert json.loads((tmp_path / "s.json").read_text()) == scenario_schema()

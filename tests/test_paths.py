"""File names with ~ and file:// URLs, wherever a file is read or written."""

import shutil
from pathlib import Path

import pytest

from dynastar.cli import main
from dynastar.errors import DynastarError, InputError, MapError
from dynastar.grid import OccupancyGrid
from dynastar.io import (
    load_episode,
    load_map,
    load_ros_map,
    load_scenario,
    save_episode,
    save_map,
    save_ros_map,
)
from dynastar.io.movingai import load_movingai_map
from dynastar.paths import local_path
from episodes import episode

GRID = OccupancyGrid.from_text("....\n.##.\n....")
SCENARIO = """map = "~/maps/a b.yaml"
robot = "turtlebot3_burger"
start = [0.5, 0.5]
goal = [3.5, 0.5]
"""


@pytest.fixture
def home(tmp_path, monkeypatch) -> Path:
    monkeypatch.setenv("HOME", str(tmp_path))
    (tmp_path / "maps").mkdir()
    return tmp_path


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("~", ""),
        ("~/maps/a.yaml", "maps/a.yaml"),
        ("file://HOME/maps/a%20b.yaml", "maps/a b.yaml"),
        ("file://localhostHOME/a", "a"),
        ("FILE:HOME/a", "a"),
        (Path("file://HOME/a"), "a"),
        ("file://~/a", "a"),
    ],
)
def test_names_of_local_files(home, name, found):
    name = type(name)(str(name).replace("HOME", str(home)))
    assert local_path(name) == home / found


@pytest.mark.parametrize("name", ["a:b/c", "~nobody-has-this-name/a", "a~/b", "./~", "C:/maps/a"])
def test_names_that_stay_what_they_are(name):
    assert local_path(name) == Path(name)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("https://example.org/a.yaml", "is a URL, expected a file on this computer"),
        ("package://maps/a.yaml", "is a URL"),
        (Path("http://example.org/a.yaml"), "is a URL"),
        ("file://maps/a.yaml", "three slashes, as in file:///"),
    ],
)
def test_urls_that_are_no_local_files(name, says):
    for call in (load_map, load_ros_map):
        with pytest.raises(MapError, match=says):
            call(name)
    with pytest.raises(InputError, match=says):
        local_path(name)


def test_maps_scenarios_and_episodes_are_read_and_written_by_such_names(home):
    url = (home / "maps" / "a b").as_uri()
    save_ros_map(GRID, "~/maps/a b.yaml")
    for name in ("~/maps/a b.yaml", f"{url}.yaml", "~/maps/a b.pgm", f"{url}.pgm"):
        assert (load_map(name).values == GRID.values).all()
        assert (load_ros_map(name).values == GRID.values).all()
    table = (home / "maps" / "a b.yaml").read_text()
    shutil.move(home / "maps" / "a b.pgm", home / "b.pgm")
    for image in ("~/b.pgm", (home / "b.pgm").as_uri()):
        (home / "maps" / "a b.yaml").write_text(table.replace("a b.pgm", image))
        assert (load_map("~/maps/a b.yaml").values == GRID.values).all()
    save_map(GRID, f"{url}.map")
    assert (load_movingai_map("~/maps/a b.map").values == GRID.values).all()
    (home / "drive.toml").write_text(SCENARIO)
    assert (load_scenario("~/drive.toml").grid.values == GRID.values).all()
    save_episode(episode(), "~/e.npz")
    assert load_episode((home / "e.npz").as_uri()).robot == episode().robot
    assert not Path("~").exists()


def test_the_command_line(home, capsys, monkeypatch):
    monkeypatch.chdir(home)
    save_map(GRID, "~/maps/a.yaml")
    assert main(["info", "~/maps/a.yaml"]) == 0
    assert main(["info", (home / "maps" / "a.pgm").as_uri()]) == 0
    assert "4 x 3" in capsys.readouterr().out
    assert main(["schema", "--out", "~/schema.json"]) == 0
    assert (home / "schema.json").is_file()
    assert main(["info", "https://example.org/a.yaml"]) == 2
    said = capsys.readouterr().err
    assert "is a URL" in said
    assert said.count("\n") == 1
    assert issubclass(MapError, DynastarError)

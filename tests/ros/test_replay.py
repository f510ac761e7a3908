"""Recordings: read by others, replayed to the last digit, and refused where they are none."""

import collections
import importlib.util
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dynastar import io
from dynastar.cli import main
from dynastar.errors import DataError, InputError
from dynastar.geometry import Goal
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.robot import ROBOTS
from dynastar.ros.bag import BagReader, BagWriter, make
from dynastar.ros.outgoing import Messages
from dynastar.ros.recording import run_recorded
from dynastar.ros.replay import Overrides, replay
from recordings import foreign

EXAMPLES = Path(__file__).parents[2] / "examples"
OUT = Messages(make)


@pytest.fixture(scope="module")
def office(tmp_path_factory):
    """Twelve seconds of the office, and the episode."""
    folder = tmp_path_factory.mktemp("bags") / "office"
    scenario = replace(io.load_scenario(EXAMPLES / "office" / "office.toml"), time_limit=12.0)
    return folder, run_recorded(scenario, folder)


def test_an_independent_reader_finds_standard_messages(office):
    reader = pytest.importorskip("mcap_ros2.reader")
    counts = collections.Counter()
    headings = []
    for found in reader.read_ros2_messages(str(office[0] / "office.mcap")):
        counts[found.channel.topic, found.schema.name] += 1
        if found.channel.topic == "/odom":
            headings.append(found.ros_msg.pose.pose.position.x)
    episode = office[1]
    ticks = len(episode.commands)
    assert counts["/scan", "sensor_msgs/msg/LaserScan"] > 0.9 * ticks
    assert counts["/odom", "nav_msgs/msg/Odometry"] == ticks
    assert counts["/cmd_vel", "geometry_msgs/msg/Twist"] == ticks
    assert counts["/map", "nav_msgs/msg/OccupancyGrid"] == 1
    for topic, kind in (
        ("/tf", "tf2_msgs/msg/TFMessage"),
        ("/tf_static", "tf2_msgs/msg/TFMessage"),
        ("/plan", "nav_msgs/msg/Path"),
        ("/markers", "visualization_msgs/msg/MarkerArray"),
        ("/diagnostics", "diagnostic_msgs/msg/DiagnosticArray"),
    ):
        assert counts[topic, kind] > 0, topic
    assert (office[0] / "metadata.yaml").is_file()
    assert np.allclose(headings, episode.trajectory.poses[:, 0], atol=0.1)


def test_a_replay_gives_the_recorded_commands_each_time(office):
    first, again = replay(office[0]), replay(office[0] / "office.mcap")
    assert np.array_equal(first.commands, first.recorded)
    assert np.array_equal(first.commands, again.commands)
    assert np.array_equal(first.commands, office[1].commands)
    assert first.states == tuple(office[1].states)
    assert first.refused == ()


def test_other_settings_give_other_commands(office):
    other = replay(office[0], Overrides(settings={"dwa": {"horizon": 1.5}}))
    paper = replay(office[0], Overrides(preset="paper"))
    for found in (other, paper):
        assert len(found.commands) == len(office[1].commands)
        assert not np.array_equal(found.commands, found.recorded)


@pytest.mark.parametrize("feature", ["keepout", "speed_limit"])
def test_masks_are_part_of_a_recording(feature, tmp_path):
    names = [path for path in (EXAMPLES / "features").glob("*.toml") if feature in path.read_text()]
    scenario = replace(io.load_scenario(names[0]), time_limit=5.0)
    run_recorded(scenario, tmp_path / "bag")
    found = replay(tmp_path / "bag")
    assert np.array_equal(found.commands, found.recorded)
    reader = BagReader(tmp_path / "bag")
    assert any("filter_mask" in topic for topic in reader.topics)
    reader.close()


@pytest.mark.parametrize("late", [0.0, 0.08])
def test_recordings_of_others_are_ticked_at_each_scan(tmp_path, late):
    """Or at the newest odometry, whose pose the robot has by then."""
    foreign(tmp_path / "bag", late=late)
    with pytest.raises(DataError, match="name its robot with --robot"):
        replay(tmp_path / "bag")
    found = replay(tmp_path / "bag", Overrides(ROBOTS["turtlebot3_burger"]))
    assert found.times == pytest.approx(0.1 * np.arange(20))
    assert found.states[:6] == ("idle",) * 6
    assert found.commands[-1, 0] > 0.0
    assert np.isnan(found.recorded).all()
    assert found.summary()["ticks as recorded"] is None


def test_map_and_goals_can_be_given_instead_of_recorded_ones(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    bare = (None, "/scan", "/odom", None)
    foreign(tmp_path / "bare", bare)
    burger = ROBOTS["turtlebot3_burger"]
    with pytest.raises(DataError, match=r"no topic 'map' .*give --map MAP, or --topic map=TOPIC"):
        replay(tmp_path / "bare", Overrides(burger))
    values = np.zeros((100, 100), np.int8)
    values[[0, -1]] = values[:, [0, -1]] = 100
    grid = OccupancyGrid(values, GridFrame(0.05))
    with pytest.raises(DataError, match=r"no topic 'goal_pose' .*give --goal X Y \[HEADING\]"):
        replay(tmp_path / "bare", Overrides(burger, grid=grid))
    with pytest.raises(InputError, match="off the map"):
        replay(tmp_path / "bare", Overrides(burger, grid=grid, goals=(Goal(40.0, 2.5),)))
    ahead = Overrides(burger, grid=grid, goals=(Goal(4.0, 2.5, 0.0),))
    found = replay(tmp_path / "bare", ahead)
    assert found.states[1:] == ("following",) * 19
    assert (found.commands[2:, 0] > 0.0).all()
    foreign(tmp_path / "whole", ("/map", "/scan", "/odom", "/goal_pose"))
    assert np.array_equal(replay(tmp_path / "whole", ahead).commands, found.commands)
    walled = values.copy()
    walled[:, 60] = 100
    shut = replay(tmp_path / "whole", ahead._replace(grid=OccupancyGrid(walled, GridFrame(0.05))))
    assert not np.array_equal(shut.commands, found.commands)

    io.save_map(grid, "room.yaml")
    words = ["replay", "bare", "--robot", "turtlebot3_burger", "--map", "room.pgm"]
    assert main(words) == 2
    assert "--goal X Y [HEADING]" in capsys.readouterr().err
    assert main([*words, "--goal", "4", "2.5", "-1.5", "--goal", "1", "2.5"]) == 0
    assert "ticks following" in capsys.readouterr().out
    with pytest.raises(SystemExit):
        main(["replay", "--goal", "4", "2.5", "bare"])
    assert "'bare': expected a number; BAG comes before --goal" in capsys.readouterr().err
    for goal in (["4"], ["1", "2", "3", "4"]):
        assert main([*words, "--goal", *goal]) == 2
        assert "expected X Y, or X Y HEADING" in capsys.readouterr().err


def test_a_recording_by_dynastar_is_ticked_by_its_commands_of_whatever_name(office):
    with pytest.raises(DataError, match="no topic 'cmd_vel' in it: give --topic cmd_vel=TOPIC"):
        replay(office[0], remap={"cmd_vel": "base/velocity"})
    again = replay(office[0], remap={"cmd_vel": "/cmd_vel"})
    assert np.array_equal(again.commands, again.recorded)


def test_goals_instead_of_those_of_a_recording_by_dynastar(office):
    other = replay(office[0], Overrides(goals=(Goal(3.0, 3.0),)))
    assert len(other.commands) == len(office[1].commands)
    assert not np.array_equal(other.commands, other.recorded)
    assert other.refused == ()


def test_recordings_that_are_none(tmp_path, capsys):
    foreign(tmp_path / "bag", ("/map", "/a/scan", "/odom", "/b/goal_pose"))
    shutil.copytree(tmp_path / "bag", tmp_path / "cut")
    file = next((tmp_path / "cut").glob("*.mcap"))
    file.write_bytes(file.read_bytes()[:3000])
    (tmp_path / "empty").mkdir()
    (tmp_path / "words.mcap").write_text("no recording")
    for name in ("nowhere", "cut", "empty", "words.mcap"):
        with pytest.raises(DataError, match=name):
            replay(tmp_path / name, Overrides(ROBOTS["jackal"]))
    with pytest.raises(DataError, match="no topic 'scan' of type sensor_msgs"):
        replay(tmp_path / "bag", Overrides(ROBOTS["jackal"]), {"scan": "rear/scan"})
    with pytest.raises(DataError, match="a new folder"):
        BagWriter(tmp_path / "bag")
    assert main(["replay", str(tmp_path / "nowhere")]) == 2
    assert capsys.readouterr().err.count("\n") == 1


@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # rosbags' files
@pytest.mark.filterwarnings("ignore:.*cut off:dynastar.errors.DynastarWarning")
def test_damaged_recordings_end_in_one_sentence(tmp_path):
    foreign(tmp_path / "bag")
    whole = (tmp_path / "bag" / "bag.mcap").read_bytes()
    rng, said = np.random.default_rng(0), []
    for trial in range(120):
        data = bytearray(whole)
        ends = (0, 40) if trial % 2 else (len(data) - 3000, len(data))
        data[rng.integers(*ends)] = rng.integers(256)
        (tmp_path / "m.mcap").write_bytes(data)
        reader = None
        try:
            reader = BagReader(tmp_path / "m.mcap")
            sum(1 for _ in reader.messages(set(reader.topics)))
        except DataError as error:
            said.append(str(error))
        finally:
            if reader is not None:
                reader.close()
    assert len(said) > 5
    assert all("m.mcap" in words for words in said)


def test_a_recording_that_fails_leaves_nothing(tmp_path):
    with pytest.raises(KeyError), BagWriter(tmp_path / "bag") as bag:
        bag.write("/a", "no_msgs/msg/Such", 0.0, OUT.text("a"))
    assert list(tmp_path.iterdir()) == []


def test_the_commands(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    name = str(EXAMPLES / "features" / "keepout.toml")
    assert main(["run", name, "--bag", "bag", "--no-gif", "--out", "run"]) == 0
    assert main(["run", name, "--bag", "bag", "--out", "run"]) == 2
    assert main(["replay", "bag", "--set", "dwa.horizon=2"]) == 0
    table = capsys.readouterr().out
    assert "dwa.horizon=2" in table
    folder = tmp_path / "out" / "replay-bag"
    if importlib.util.find_spec("matplotlib"):
        assert (folder / "figure.png").stat().st_size > 5000
    rows = (folder / "commands.csv").read_text().splitlines()
    assert rows[0].startswith("time [s],recorded v [m/s],recorded omega [rad/s],as recorded v")
    assert main(["replay", "bag", "--topic", "scan"]) == 2
    assert main(["replay", "bag", "--set", "dwa.horizont=2"]) == 2
    assert "dwa.horizon" in capsys.readouterr().err

"""The suite mrpb: prior and true maps, people, tolerances, and its metrics."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dynastar.bench.missions import Options
from dynastar.bench.suites import mrpb
from dynastar.errors import DataError
from dynastar.grid import OccupancyGrid
from dynastar.io.maps import save_map
from dynastar.io.mrpb import load_mrpb
from dynastar.simulation.movers import Movers
from dynastar.simulation.run import drive
from scripted import Scripted

PRIOR, TRUE = "prior/map.yaml", "true/map.yaml"
TEST = {
    "scenario": "room_partially_unknown",
    "test": 2,
    "prior_map": PRIOR,
    "true_map": TRUE,
    "start": [1.0, 1.0, 0.0],
    "goal": [5.0, 1.0, 1.571],
    "actors": None,
}
EMPTY = {
    **TEST,
    "scenario": "people",
    "prior_map": None,
    "true_map": None,
    "start": [0.0, -4.0, 1.577],
    "goal": [0.0, 9.0, 1.578],
    "actors": "people",
}
KEYS = [[0.0, 3.0, 5.0, 0.0], [10.0, 3.0, 0.0, 0.0], [20.0, 3.0, 5.0, 0.0]]
ACTORS = {"people": [{"actor": "a", "loop": True, "waypoints_t_x_y_yaw": KEYS}]}


@pytest.fixture
def options(tmp_path: Path) -> Options:
    walls = ["#" * 60, *["#" + "." * 58 + "#"] * 18, "#" * 60]
    for name, row in ((PRIOR, "?" * 60), (TRUE, "#" * 60)):
        (tmp_path / name).parent.mkdir()
        lines = [*walls[:2], row, *walls[3:]]
        save_map(OccupancyGrid.from_text(lines, 0.1), tmp_path / name)
    (tmp_path / "scenarios.json").write_text(json.dumps([TEST, EMPTY]))
    (tmp_path / "dynamic_actors.json").write_text(json.dumps(ACTORS))
    return Options(data=tmp_path)


def test_the_robot_has_the_prior_map_and_meets_the_true_one(options: Options) -> None:
    first, _ = mrpb.missions(options)
    made = mrpb.scenario(first, options, 0)
    assert made.grid.unknown.any()
    assert made.world is not None
    assert not made.world.unknown.any()
    assert made.world.occupied.sum() > made.grid.occupied.sum()
    assert made.unknown == "free"
    assert (made.start, tuple(made.goals[0])) == ((1.0, 1.0, 0.0), (5.0, 1.0, 1.571))
    assert (made.goal_tolerance, made.heading_tolerance) == (0.2, 0.1)
    assert made.robot.limits.v_max == 0.55


def test_people_walk_in_a_loop_through_an_empty_world(options: Options) -> None:
    _, second = mrpb.missions(options)
    made = mrpb.scenario(second, options, 0)
    assert made.grid is made.world
    assert not made.grid.blocked().any()
    assert all(made.grid.contains(x, y) for x, y in ((0.0, -8.0), (7.0, 13.0), (-4.0, 9.0)))
    movers = Movers(made.movers)
    assert movers.radii.tolist() == [0.3]
    for time, y in ((0.0, 5.0), (5.0, 2.5), (10.0, 0.0), (25.0, 2.5)):
        assert movers.at(time)[0] == pytest.approx([3.0, y])


def test_its_metrics_are_those_of_the_drive(options: Options) -> None:
    first, _ = mrpb.missions(options)
    made = mrpb.scenario(first, options, 0)
    episode = drive(made, navigator=Scripted)
    assert episode.outcome == "arrived"
    found = mrpb.mrpb_metrics(episode)
    assert found["time_near_obstacles"] == 0.0
    speeds, times = episode.trajectory.twists[:, 0], episode.trajectory.times
    up_and_down = 2.0 * speeds.max() / (times[-1] - times[0])
    assert found["velocity_smoothness"] == pytest.approx(up_and_down, rel=1e-6)
    near = replace(episode, clearance=np.where(np.arange(len(times)) % 2, 0.1, 1.0))
    assert mrpb.mrpb_metrics(near)["time_near_obstacles"] == pytest.approx(0.5, abs=0.02)


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        ({"start": [0.0, 1.0]}, "test 0: start"),
        ({"true_map": "../map.yaml"}, "a file below"),
        ({"true_map": "/map.yaml"}, "a file below"),
        ({"actors": "nobody"}, "'nobody' is missing"),
        ({"test": "two"}, "whole number"),
    ],
)
def test_damaged_data_say_where(options: Options, damage: dict[str, object], says: str) -> None:
    assert options.data is not None
    (options.data / "scenarios.json").write_text(json.dumps([{**TEST, **damage}]))
    with pytest.raises(DataError, match=says):
        load_mrpb(options.data)


def test_a_list_of_tests_is_expected(options: Options) -> None:
    assert options.data is not None
    (options.data / "scenarios.json").write_text("{}")
    with pytest.raises(DataError, match="list of tests"):
        load_mrpb(options.data)


@pytest.mark.data
def test_every_test_of_the_data_set_can_begin(data_dir: Path) -> None:
    options = Options(data=data_dir)
    for mission in mrpb.missions(options):
        made = mrpb.scenario(mission, options, 0)
        assert made.world is not None
        for x, y in (made.start[:2], made.goals[0][:2]):
            assert not made.world.occupied[made.world.world_to_cell(x, y)]
            assert not made.grid.occupied[made.grid.world_to_cell(x, y)]

"""The suite dynabarn: start times, the arena, and contacts that a jump caused."""

import json
from pathlib import Path

import numpy as np
import pytest

from dynastar.bench.missions import Options
from dynastar.bench.selection import choose_missions
from dynastar.bench.suites import dynabarn
from dynastar.errors import DataError
from dynastar.io.dynabarn import load_dynabarn
from dynastar.simulation.movers import Movers
from dynastar.simulation.run import drive
from scripted import Scripted, Still

CROSSES = [[0.0, 5.0, -8.0], [4.0, 5.0, 8.0]]  # at 4 m/s, then jumps back


def table(keys: list[list[float]] = CROSSES, **more: object) -> dict[str, object]:
    obstacle = {"plugin": "a", "length": keys[-1][0], "keys": keys}
    return {
        "obstacle_radius": 0.5,
        "walls": [{"name": "back", "center": [-10, 0], "size": [0.5, 20]}],
        "start": [11, 0, 3.14],
        "goal": [-9, 0],
        "loop": True,
        "worlds": [
            {"world": 2, "difficulty": "easy", "obstacles": [obstacle]},
            {"world": 5, "difficulty": "hard", "obstacles": []},
        ],
        **more,
    }


def write(folder: Path, data: object) -> Options:
    folder.mkdir(exist_ok=True)
    (folder / "dynabarn.json").write_text(json.dumps(data))
    return Options(data=folder)


def test_every_world_has_four_start_times(tmp_path: Path) -> None:
    options = write(tmp_path, table())
    made = list(dynabarn.missions(options))
    assert [mission.number for mission in made] == [8, 9, 10, 11, 20, 21, 22, 23]
    placed = [
        Movers(dynabarn.scenario(mission, options, 0).movers).at(0.0)[0] for mission in made[:4]
    ]
    assert placed[0] == pytest.approx([5.0, -8.0])  # phase 0 is the recording's begin
    assert len({tuple(place) for place in placed}) == 4
    again = dynabarn.scenario(made[2], options, 1).movers[0]
    assert again.times == pytest.approx(dynabarn.scenario(made[2], options, 0).movers[0].times)
    other = dynabarn.scenario(made[2], options._replace(seed=1), 0).movers[0]
    assert again.times[0] != other.times[0]


def test_the_same_missions_at_half_a_metre_per_second(tmp_path: Path) -> None:
    options = write(tmp_path, table())._replace(select="0:")
    made = list(dynabarn.missions(options))
    assert [mission.number for mission in made[8:]] == [
        1008,
        1009,
        1010,
        1011,
        1020,
        1021,
        1022,
        1023,
    ]
    fast, slow = (dynabarn.scenario(mission, options, 0) for mission in (made[2], made[10]))
    assert (fast.robot.limits.v_max, slow.robot.limits.v_max) == (2.0, 0.5)
    assert slow.movers[0].times.tolist() == fast.movers[0].times.tolist()
    assert [chosen.number for chosen in choose_missions(dynabarn, options)[0]][-1] == 1023
    select = options._replace(select="1000::4")
    assert [m.number for m in choose_missions(dynabarn, select)[0]] == [1008, 1020]


def test_a_mover_goes_on_as_recorded_from_its_start_time(tmp_path: Path) -> None:
    options = write(tmp_path, table())
    for mission in list(dynabarn.missions(options))[:4]:
        movers = Movers(dynabarn.scenario(mission, options, 0).movers)
        begin = dynabarn._start_time(mission, options)
        for time in (0.0, 1.3, 7.9, 50.0):
            expected = [5.0, -8.0 + 4.0 * ((begin + time) % 4.0)]
            assert movers.at(time)[0] == pytest.approx(expected)


def test_the_map_has_the_walls_as_thick_as_they_are(tmp_path: Path) -> None:
    options = write(tmp_path, table())
    made = dynabarn.scenario(next(iter(dynabarn.missions(options))), options, 0)
    grid = made.grid
    for x, y, occupied in (
        (-9.8, 0, True),
        (-10.2, 9.9, True),
        (-9.7, 0, False),
        (-10.3, 0, False),
    ):
        assert grid.occupied[grid.world_to_cell(x, y)] == occupied, (x, y)
    assert not grid.unknown.any()
    assert (made.start, made.goals[0][:2], made.goal_tolerance) == ((11, 0, 3.14), (-9, 0), 1.0)


def test_a_jump_onto_a_resting_robot_is_told_from_a_walk_into_it(tmp_path: Path) -> None:
    jumps = [[0.0, 11.0, 0.0], [2.0, 11.0, 9.0]]  # the start is at (11, 0)
    for keys, jumped in ((jumps, True), (CROSSES, False)):
        if not jumped:
            keys = [[t, 11.0, y] for t, _, y in CROSSES]
        options = write(tmp_path, table(keys))
        load_dynabarn.cache_clear()
        mission = next(iter(dynabarn.missions(options)))
        made = dynabarn.scenario(mission, options, 0)
        movers = tuple(
            type(mover)(mover.radius, mover.times - 0.5, mover.points, "loop")
            for mover in made.movers
        )
        made = type(made)(**{**vars(made), "movers": movers})
        episode = drive(made, navigator=Still)
        assert (episode.outcome, episode.contact) == ("contact", "resting")
        assert dynabarn.contact_after_jump(episode, made.movers) == jumped


def test_nobody_is_touched_in_an_empty_world(tmp_path: Path) -> None:
    options = write(tmp_path, table())
    mission = list(dynabarn.missions(options))[4]
    made = dynabarn.scenario(mission, options, 0)
    episode = drive(made, navigator=Scripted)
    assert episode.outcome == "arrived"
    assert not dynabarn.contact_after_jump(episode, made.movers)


@pytest.mark.parametrize(
    ("damage", "says"),
    [
        ({"goal": [1]}, "goal: expected"),
        ({"obstacle_radius": -1.0}, "obstacle_radius"),
        ({"obstacle_radius": "wide"}, "obstacle_radius"),
        ({"worlds": 3}, "'worlds' is int"),
        ({"worlds": [{"world": 1}]}, "world 1: 'obstacles' is missing"),
        ({"worlds": [{"world": -1}]}, "numbers from 0"),
        ({"walls": [{"center": [0, 0], "size": [0, 1]}]}, "size"),
    ],
)
def test_damaged_data_say_where(tmp_path: Path, damage: dict[str, object], says: str) -> None:
    write(tmp_path, table(**damage))
    with pytest.raises(DataError, match=says):
        load_dynabarn(tmp_path)


def test_keys_have_to_rise_and_to_last_their_length(tmp_path: Path) -> None:
    write(tmp_path, table([[1.0, 0, 0], [0.5, 1, 1]]))
    with pytest.raises(DataError, match="world 2, obstacle 0: expected 2 keys"):
        load_dynabarn(tmp_path)
    (tmp_path / "dynabarn.json").write_text("{")
    load_dynabarn.cache_clear()
    with pytest.raises(DataError, match="not valid JSON"):
        load_dynabarn(tmp_path)


@pytest.mark.data
def test_the_data_set_moves_at_its_published_speeds(data_dir: Path) -> None:
    data = load_dynabarn(data_dir / "dynabarn")
    ranges = {"easy": (0.4, 1.0), "medium": (0.9, 1.5), "hard": (1.3, 2.0)}
    assert len(data.worlds) >= 20
    for world in data.worlds.values():
        low, high = ranges[world.difficulty]
        for keys in world.tracks:
            steps = np.diff(keys, axis=0)
            speeds = np.hypot(steps[:, 1], steps[:, 2]).sum() / steps[:, 0].sum()
            assert low < speeds < high
    options = Options(data=data_dir)
    for mission in list(dynabarn.missions(options))[::7]:
        made = dynabarn.scenario(mission, options, 0)
        gaps = np.hypot(*(Movers(made.movers).at(0.0) - made.start[:2]).T) - data.radius
        assert gaps.min() > made.robot.footprint.circumscribed

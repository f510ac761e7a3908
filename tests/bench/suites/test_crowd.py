"""The suite crowd: tracks, walk-ins, entries, and when a mission starts."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from dynastar.bench.missions import Options
from dynastar.bench.robots import CROWD_ROBOT
from dynastar.bench.selection import choose_missions
from dynastar.bench.suites import crowd, crowd_worlds
from dynastar.errors import DataError
from dynastar.grid import GridFrame, OccupancyGrid
from dynastar.io.maps import load_map, save_map
from dynastar.io.pedestrians import load_recording
from dynastar.simulation import Mover
from dynastar.simulation.movers import Movers
from dynastar.simulation.run import drive
from scripted import Still

HEAD = "t_s,ped_id,x_m,y_m\n"


def track(number: int, begin: float, start: tuple[float, float], end: tuple[float, float]) -> str:
    """A walk at 1 m/s, every 0.4 s."""
    a, b = np.array(start), np.array(end)
    length = float(np.hypot(*(b - a)))
    steps = np.arange(0.0, length, 0.4)
    rows = [(begin + s, number, *(a + (b - a) * s / length)) for s in steps]
    return "".join(f"{t:.3f},{n},{x:.4f},{y:.4f}\n" for t, n, x, y in rows)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Twelve people from the west to the east, twelve from the south to the north, over 95 s."""
    rows = HEAD
    for k in range(12):
        rows += track(2 * k, 7.6 * k, (1.2, 4.0 + 0.1 * k), (10.8, 4.0 + 0.1 * k))
        rows += track(2 * k + 1, 7.6 * k + 0.4, (5.0 + 0.1 * k, 1.2), (5.0 + 0.1 * k, 8.8))
    folder = tmp_path / "pedestrians"
    folder.mkdir()
    (folder / "square.csv").write_text(rows)
    walls = ["#" * 120, *["#" + "." * 118 + "#"] * 98, "#" * 120]
    save_map(OccupancyGrid.from_text(walls, 0.1), folder / "square_map.yaml")
    return folder


def test_missions_number_recording_pair_and_time(folder: Path) -> None:
    options = Options(data=folder.parent)
    made = list(crowd.missions(options))
    assert len(made) == 48
    assert [mission.number for mission in made[:9]] == [0, 1, 2, 3, 4, 5, 6, 7, 10]
    chosen, _ = choose_missions(crowd, options)
    assert len(chosen) > 20
    assert choose_missions(crowd, Options(data=folder))[0] == chosen


def test_entries_lie_where_people_walk(folder: Path) -> None:
    recording = load_recording(folder / "square.csv")
    grid = load_map(folder / "square_map.yaml")
    found = crowd_worlds.entries(recording, grid, CROWD_ROBOT)
    assert found["W"][0] < 2.0 < 10.0 < found["E"][0]
    assert found["S"][1] < 2.0 < 8.0 < found["N"][1]
    need = CROWD_ROBOT.footprint.circumscribed + 0.25
    for x, y in found.values():
        assert 0.1 + need < x < 11.9 - need
        assert 0.1 + need < y < 9.9 - need
    with pytest.raises(DataError, match="no place"):
        crowd_worlds.entries(recording, OccupancyGrid.from_text(["#?"], 6.0), CROWD_ROBOT)


def test_people_walk_in_from_off_the_map(folder: Path) -> None:
    recording = load_recording(folder / "square.csv")
    free = OccupancyGrid(np.zeros((100, 120), np.int8), GridFrame(0.1))
    walked_in = crowd_worlds.with_walk_in(recording, free).tracks[0]
    assert walked_in[1:] == pytest.approx(recording.tracks[0])
    assert walked_in[0] == pytest.approx([-1.2, 0.0, 4.0], abs=0.11)


def test_people_walk_in_past_a_wall_or_as_far_as_it(folder: Path) -> None:
    recording = load_recording(folder / "square.csv")
    post = np.zeros((100, 120), np.int8)
    post[38:42, 4:6] = 100  # before pedestrian 0, who comes from (0, 4)
    first = crowd_worlds.with_walk_in(recording, OccupancyGrid(post, GridFrame(0.1))).tracks[0][0]
    assert first[1] <= 0.1
    assert abs(first[2] - 4.0) > 0.2 + 0.25
    walled = load_map(folder / "square_map.yaml")
    first = crowd_worlds.with_walk_in(recording, walled).tracks[0][0]
    assert 0.1 + 0.2 < first[1] < 0.6


def test_pedestrians_are_the_recording_from_a_time_on(folder: Path) -> None:
    recording = load_recording(folder / "square.csv")
    at = Movers(crowd_worlds.pedestrians(recording, 20.0, 140.0)).at(1.0)
    there = at[np.isfinite(at[:, 0])]
    expected = [
        [np.interp(21.0, keys[:, 0], keys[:, axis]) for axis in (1, 2)]
        for keys in recording.tracks
        if keys[0, 0] <= 21.0 <= keys[-1, 0]
    ]
    assert there == pytest.approx(np.array(expected))
    assert len(there) >= 2
    after = Movers(crowd_worlds.pedestrians(recording, 20.0, 140.0)).at(119.0)
    assert np.isnan(after).all()


def test_a_mission_starts_when_nobody_is_near(folder: Path) -> None:
    recording = load_recording(folder / "square.csv")
    begin = crowd_worlds.clear_start(recording, (2.0, 4.0), 0.0)
    assert begin is not None
    assert 2.0 <= begin <= 3.2  # pedestrian 0 comes by at 0.8 s, at 1 m/s
    movers = Movers(crowd_worlds.pedestrians(recording, begin, begin + 10.0))
    for time in np.arange(0.0, 1.0, 0.05):
        assert not (np.hypot(*(movers.at(time) - (2.0, 4.0)).T) - 0.25 < 1.0).any()
    stands = recording._replace(tracks=(np.array([[0.0, 2.0, 4.0], [90.0, 2.0, 4.0]]),))
    assert crowd_worlds.clear_start(stands, (2.5, 4.0), 10.0) is None


def test_start_times_end_a_minute_before_the_recording(folder: Path) -> None:
    recording = load_recording(folder / "square.csv")
    times = crowd_worlds.start_times(recording, 8)
    assert (times[0], len(times)) == (0.0, 8)
    assert times[-1] == pytest.approx(recording.span[1] - 60.0, abs=0.1)


def test_a_contact_with_somebody_who_just_appeared_is_flagged(folder: Path) -> None:
    options = Options(data=folder)
    mission = choose_missions(crowd, options)[0][0]
    made = replace(crowd.scenario(mission, options, 0), start=(6.0, 2.0, 0.0), time_limit=5.0)
    for begin, flagged in ((1.0, True), (-2.0, False)):
        appears = Mover(0.25, np.array([begin, 4.0]), np.array([[6.0, 3.2], [6.0, 1.0]]), "vanish")
        world = replace(made, movers=(appears,), time_limit=20.0, attention="none")
        episode = drive(world, navigator=Still)
        assert episode.contact == "resting"
        late = float(episode.trajectory.times[-1]) - begin
        assert crowd.contact_on_appearing(episode, world.movers) == (flagged and late <= 1.0)


def test_who_walks_up_to_a_robot_at_rest_stops_and_no_contact_is_flagged(folder: Path) -> None:
    options = Options(data=folder)
    mission = choose_missions(crowd, options)[0][0]
    made = replace(crowd.scenario(mission, options, 0), start=(6.0, 2.0, 0.0))
    appears = Mover(0.25, np.array([1.0, 4.0]), np.array([[6.0, 3.2], [6.0, 1.0]]), "vanish")
    world = replace(made, movers=(appears,), time_limit=5.0)
    assert world.attention == "late"
    episode = drive(world, navigator=Still)
    assert episode.contact == ""
    assert not crowd.contact_on_appearing(episode, world.movers)


def test_damaged_recordings_say_where(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    for text, says in (
        (HEAD, "no pedestrian"),
        ("t_s,ped_id,x_m\n0,1,2\n", "'y_m' is missing"),
        (HEAD + "0,1,2,3\n0.4,1,x,3\n", "line 3"),
        (HEAD + "0,1,2,nan\n", "line 2"),
        (HEAD + "0,1,2,3\n0,1,2,4\n", "two rows for one time"),
    ):
        path.write_text(text)
        with pytest.raises(DataError, match=says):
            load_recording(path)
        load_recording.cache_clear()


def test_without_data_it_says_what_to_give(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.delenv("DYNASTAR_DATA", raising=False)
    with pytest.raises(DataError, match="--data"):
        list(crowd.missions(Options()))
    with pytest.raises(DataError, match="pedestrians"):
        list(crowd.missions(Options(data=tmp_path)))


@pytest.mark.data
def test_the_data_set_has_a_hundred_missions_that_begin_clear(data_dir: Path) -> None:
    options = Options(data=data_dir)
    chosen, _ = choose_missions(crowd, options)
    assert len(chosen) >= 100
    for mission in chosen[::9]:
        made = crowd.scenario(mission, options, 0)
        movers = Movers(made.movers)
        for time in (0.0, 0.5, 1.0):
            gaps = np.hypot(*(movers.at(time) - made.start[:2]).T) - 0.25
            assert not (gaps < 1.0).any()

"""The suite barn: its geometry, the challenge's clock and score."""

import io
import math
import tarfile
from pathlib import Path

import numpy as np
import pytest
import shapely

from dynastar.bench import driven
from dynastar.bench.missions import Mission, Options
from dynastar.bench.suites import barn
from dynastar.bench.suites.challenge import challenge_run, challenge_score
from dynastar.errors import DataError
from dynastar.io.barn import load_barn_worlds, official_length, read_barn_world
from dynastar.simulation.run import drive
from scripted import Scripted

MODEL = """<model name='{name}'><static>1</static>
  <pose frame=''>{x} {y} 0.0 0 0 0</pose>
  <link name='link'><collision name='collision'><geometry><{shape}>
    <radius>{radius}</radius><length>1</length></{shape}></geometry></collision></link></model>
"""
GROUND = "<model name='ground_plane'><static>1</static></model>"


def world(*places: tuple[float, float], shape: str = "cylinder", radius: str = "0.075") -> str:
    models = [
        MODEL.format(name=f"unit_cylinder_{i}", x=x, y=y, shape=shape, radius=radius)
        for i, (x, y) in enumerate(places)
    ]
    state = "<state><model name='unit_cylinder_0'><pose>9 9 0 0 0 0</pose></model></state>"
    return f"<sdf><world>{GROUND}{''.join(models)}{state}</world></sdf>"


def write(folder: Path, **worlds: str) -> Path:
    (folder / "path_files").mkdir(parents=True, exist_ok=True)
    with tarfile.open(folder / "worlds.tar.xz", "w:xz") as archive:
        for name, text in worlds.items():
            member = tarfile.TarInfo(f"worlds/{name}.world")
            member.size = len(text)
            archive.addfile(member, io.BytesIO(text.encode()))
            np.save(folder / "path_files" / f"path_{name[6:]}.npy", [[15, 0], [15, 29]])
    return folder


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    aside = ((-4.425, 6.0), (-0.075, 6.0))
    return write(tmp_path / "barn", world_7=world(*aside), world_3=world((-2.25, 6.0), *aside))


def test_missions_have_the_worlds_numbers(folder: Path) -> None:
    options = Options(data=folder.parent)
    assert [mission.number for mission in barn.missions(options)] == [3, 7]


def test_a_world_is_its_cylinders_in_an_empty_map(folder: Path) -> None:
    made = barn.scenario(Mission(3), Options(data=folder), 0)
    assert not made.grid.occupied.any()
    assert not made.grid.unknown.any()
    assert all(made.grid.contains(x, y) for x, y in ((-2.25, 3.0), (-2.25, 13.0), (-7.0, 16.0)))
    assert (made.start, made.goals[0][:2]) == ((-2.25, 3.0, math.pi / 2), (-2.25, 13.0))
    assert (made.goal_tolerance, made.time_limit, made.robot.name) == (1.0, 100.0, "jackal")
    assert (made.noise.range_bound, made.latency) == (0.01, 0.05)
    assert barn.scenario(Mission(3), Options(data=folder, ideal=True), 0).noise.range_bound == 0.0
    assert len(made.obstacles) == 3
    disc = shapely.Point(-2.25, 6.0).buffer(0.075, quad_segs=64)
    polygon = shapely.Polygon(made.obstacles[0])
    assert polygon.covers(disc)
    assert polygon.hausdorff_distance(disc) < 0.004


def test_the_challenge_times_from_a_tenth_of_a_metre_to_a_metre_off(folder: Path) -> None:
    episode = drive(barn.scenario(Mission(7), Options(data=folder), 0), navigator=Scripted)
    run = challenge_run(episode)
    assert run.success
    # 8.9 m at 1 m/s lie between the two, whatever comes before and after.
    assert run.seconds == pytest.approx(8.9, abs=0.15)
    assert challenge_score(episode, 6.0) == pytest.approx(0.5)
    assert challenge_score(episode, 2.0) == pytest.approx(2.0 / run.seconds)
    assert challenge_score(episode, 1.0) == pytest.approx(1.0 / 8.0)


def test_a_contact_or_a_stop_on_the_way_scores_nothing(folder: Path) -> None:
    episode = drive(barn.scenario(Mission(3), Options(data=folder), 0), navigator=Scripted)
    assert episode.outcome == "contact"
    assert challenge_score(episode, 6.0) == 0.0


def test_a_row_has_the_score_and_the_clock(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(driven, "time_bound", lambda scenario: 5.0)
    monkeypatch.setattr(driven, "controller_named", lambda name: Scripted)
    row = barn.run_mission(Mission(7), Options(data=folder), 0)
    assert row["optimal_time"] == pytest.approx(official_length(folder, 7) / 2.0)
    assert row["outcome"] == "arrived"
    assert row["group"] == "static"
    assert row["score"] == pytest.approx(0.5)
    assert row["challenge_time"] == pytest.approx(8.9, abs=0.15)


def test_the_official_length_joins_start_and_goal(folder: Path) -> None:
    # (row 15, column 0 to 29) is x = -2.325, y = 5.075 to 9.425.
    expected = math.hypot(0.075, 2.075) + 4.35 + math.hypot(0.075, 3.575)
    assert official_length(folder, 7) == pytest.approx(expected)
    with pytest.raises(DataError, match=r"path_8\.npy"):
        official_length(folder, 8)


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (world((1.0, 2.0), shape="sphere"), "no static cylinder"),
        (world((1.0, 2.0), radius="-1"), "radii over 0"),
        (world((1.0, 2.0), radius="wide"), "in words"),
        (world(), "no cylinder"),
        ("", "no cylinder"),
    ],
)
def test_a_damaged_world_says_what_is_wrong(text: str, says: str) -> None:
    with pytest.raises(DataError, match=says):
        read_barn_world(text, "world_1.world")


def test_a_damaged_archive_says_so(tmp_path: Path) -> None:
    with pytest.raises(DataError, match="no such file"):
        load_barn_worlds(tmp_path)
    (tmp_path / "worlds.tar.xz").write_bytes(b"not an archive")
    with pytest.raises(DataError, match="unpacked"):
        load_barn_worlds(tmp_path)
    other = write(tmp_path / "other")
    with pytest.raises(DataError, match="holds no world"):
        load_barn_worlds(other)


@pytest.mark.data
def test_the_data_set_agrees_with_its_index(data_dir: Path) -> None:
    folder = data_dir / "barn"
    worlds = load_barn_worlds(folder)
    index = np.genfromtxt(folder / "barn_index.csv", delimiter=",", skip_header=1)
    assert len(worlds) >= 100
    for number, cylinders in worlds.items():
        row = index[index[:, 0] == number][0]
        assert len(cylinders) == row[1]
        assert (cylinders[:, 2] == 0.075).all()
        assert official_length(folder, number) == pytest.approx(row[4], abs=1e-3)

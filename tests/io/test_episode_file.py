"""Episodes load back equal, and damage is told."""

import contextlib
import dataclasses
import io
import json
import math
import os
import tracemalloc
import zipfile
from typing import Any

import numpy as np
import pytest

from dynastar.episode import Episode, Trace
from dynastar.errors import DynastarWarning, EpisodeError, InputError
from dynastar.geometry import Pose2D
from dynastar.io import episode_file, load_episode, save_episode, write_json
from dynastar.io.archive import MAX_MEMBERS
from dynastar.writing import written_aside
from episodes import episode


def same(a: Any, b: Any) -> bool:
    if dataclasses.is_dataclass(a):
        names = [field.name for field in dataclasses.fields(a)]
        return type(a) is type(b) and all(same(getattr(a, n), getattr(b, n)) for n in names)
    if isinstance(a, np.ndarray):
        numbers = a.dtype.kind == "f"
        return a.dtype == b.dtype and np.array_equal(a, b, equal_nan=numbers)
    if isinstance(a, tuple | list):
        return type(a) is type(b) and len(a) == len(b) and all(map(same, a, b))
    return type(a) is type(b) and a == b


@pytest.mark.parametrize("ticks", [0, 1, 5])
@pytest.mark.parametrize("movers", [0, 2])
@pytest.mark.parametrize("plans", [0, 2])
@pytest.mark.parametrize("masks", [True, False])
@pytest.mark.parametrize("name", ["run.npz", "run.dynastar"])
def test_an_episode_loads_back_equal(tmp_path, ticks, movers, plans, masks, name):
    before = episode(ticks, movers, plans, masks)
    save_episode(before, tmp_path / name)
    after = load_episode(tmp_path / name)
    assert same(before, after)
    assert not after.commands.flags.writeable
    assert [path.name for path in tmp_path.iterdir()] == [name]


def test_the_same_episode_gives_the_same_bytes(tmp_path):
    save_episode(episode(), tmp_path / "a.npz")
    save_episode(episode(), tmp_path / "b.npz")
    assert (tmp_path / "a.npz").read_bytes() == (tmp_path / "b.npz").read_bytes()


def traced() -> Episode:
    """An episode with a trace, three candidates and a track at each tick."""
    rng, n = np.random.default_rng(1), 5
    trace = Trace(
        candidates=rng.random((3 * n, 3)),
        refused=np.zeros(3 * n, np.uint8),
        candidate_rows=np.full(n, 3),
        terms=rng.random((n, 6)),
        chosen=rng.random((n, 3)),
        tracks=rng.random((n, 5)),
        track_rows=np.ones(n, np.int64),
        reasons=np.full(n, "the path"),
        seen=rng.random((40, 4)),
        seen_frame=(0.1, 0.0, 0.0, 0.0),
    )
    return dataclasses.replace(episode(n), trace=trace)


def test_an_episode_that_was_cut_off_is_read_as_far_as_it_goes(tmp_path):
    path, before = tmp_path / "a.npz", traced()
    save_episode(before, path)
    assert same(load_episode(path), before)
    with zipfile.ZipFile(path) as archive:
        begin = {member.filename: member.header_offset for member in archive.infolist()}
        index = archive.start_dir
    plain = dataclasses.replace(before, trace=None)
    unexplored = [plan._replace(explored=np.empty((0, 2), np.int32)) for plan in before.plans]
    bare = dataclasses.replace(plain, plans=tuple(unexplored))
    whole = path.read_bytes()
    for cut, expected, says in (
        (len(whole) - 1, before, "drive of 5 ticks is read, but not its index"),
        (index, before, "but not its index"),
        (begin["seen.npy"] + 9, plain, "but not what the navigator considered"),
        (begin["candidates.npy"], plain, "but not what the navigator considered"),
        (
            begin["explored_rows.npy"] + 99,
            bare,
            "but not the cells that its plans looked at and what",
        ),
        (begin["explored.npy"], bare, "but not the cells"),
    ):
        path.write_bytes(whole[:cut])
        with pytest.warns(DynastarWarning, match=rf"a\.npz was cut off .*{says}"):
            assert same(load_episode(path), expected)
    for name in ("values", "times", "commands", "movers"):
        path.write_bytes(whole[: begin[f"{name}.npy"] + 9])
        with pytest.raises(EpisodeError, match=rf"a\.npz: .*ends at '{name}', before the drive"):
            load_episode(path)
    path.write_bytes(whole[:200])
    with pytest.raises(EpisodeError, match=r"a\.npz: damaged, or not an episode"):
        load_episode(path)


@pytest.mark.filterwarnings("ignore:.*cut off:dynastar.errors.DynastarWarning")
def test_no_damage_gives_anything_but_an_episode_or_an_episode_error(tmp_path):
    path = tmp_path / "a.npz"
    save_episode(episode(), path)
    whole = path.read_bytes()
    for k in range(0, len(whole), 29):
        path.write_bytes(whole[:k] + bytes([whole[k] ^ 0x55]) + whole[k + 1 :])
        try:
            assert isinstance(load_episode(path), Episode)
        except EpisodeError:
            continue


def rewritten(tmp_path, change) -> None:
    with np.load(tmp_path / "a.npz") as members:
        arrays = dict(members)
    change(arrays)
    np.savez(tmp_path / "a.npz", **arrays)


def header(**changes):
    def change(arrays):
        new = json.loads(arrays["header"].tobytes()) | changes
        arrays["header"] = np.frombuffer(json.dumps(new).encode(), np.uint8)

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (header(version=2), "version 2, this dynastar reads 1"),
        (header(format="other"), "not an episode"),
        (header(plans=[]), "damaged"),
        (header(frame=[0, 0, 0, 0]), "resolution > 0"),
        (lambda arrays: arrays.pop("header"), "lacks 'header'"),
        (lambda arrays: arrays.pop("movers"), "lacks 'movers'"),
        (lambda arrays: arrays.update(commands=np.zeros((4, 2))), "'commands' has shape"),
        (lambda arrays: arrays.update(poses=np.zeros(5)), "'poses' has shape"),
        (lambda arrays: arrays.update(mover_radii=np.zeros(9)), "'mover_radii' has shape"),
        (lambda arrays: arrays.update(commands=np.full((5, 2), "a")), "expected numbers"),
        (lambda arrays: arrays.update(plan_rows=np.array([1, 1])), "add up"),
        (lambda arrays: arrays.update(plan_rows=np.array([-1, 4])), "add up"),
        (lambda arrays: arrays.update(clearance=np.array([None] * 5)), "damaged"),
        (lambda arrays: arrays.update(times=np.full(5, np.nan)), "'times' are not finite"),
        (lambda arrays: arrays.update(times=arrays["times"][::-1]), "go back"),
        (lambda arrays: arrays.update(explored=arrays["explored"] + 0.5), "whole numbers"),
    ],
)
def test_an_episode_that_lies_says_where(tmp_path, change, message):
    save_episode(episode(), tmp_path / "a.npz")
    rewritten(tmp_path, change)
    with pytest.raises(EpisodeError, match=f"a.npz: .*{message}"):
        load_episode(tmp_path / "a.npz")


def test_what_is_no_episode_at_all(tmp_path):
    with zipfile.ZipFile(tmp_path / "a.zip", "w") as archive:
        archive.writestr("hello", "world")
    (tmp_path / "b.zip").write_text("hello")
    for name in ("a.zip", "b.zip", "none.npz", "."):
        with pytest.raises(EpisodeError):
            load_episode(tmp_path / name)
    unsayable = dataclasses.replace(episode(), config={"a": object()})
    with pytest.raises(EpisodeError, match="a header cannot hold a object"):
        save_episode(unsayable, tmp_path / "c.npz")
    assert not (tmp_path / "c.npz").exists()


def test_json_holds_no_nan_and_is_written_whole(tmp_path):
    path = tmp_path / "new" / "a.json"
    write_json(
        path,
        {
            "a": math.nan,
            "b": [math.inf, 1, True, None, "ä"],
            "pose": Pose2D(1.0, 2.0),
            "array": np.array([[1.5, math.nan]]),
            "number": np.float32(0.5),
            "path": path.name,
        },
    )
    assert json.loads(path.read_text(encoding="utf-8"), parse_constant=pytest.fail) == {
        "a": None,
        "b": [None, 1, True, None, "ä"],
        "pose": {"x": 1.0, "y": 2.0, "theta": 0.0},
        "array": [[1.5, None]],
        "number": 0.5,
        "path": "a.json",
    }
    with pytest.raises(TypeError, match="cannot hold a object"):
        write_json(path, object())
    assert [p.name for p in path.parent.iterdir()] == ["a.json"]


def test_json_holds_a_file_name_that_is_not_utf_8(tmp_path):
    name = os.fsdecode(b"q\xff.toml")
    write_json(tmp_path / "a.json", {"name": name, "ä": "ö"})
    text = (tmp_path / "a.json").read_text(encoding="utf-8")
    assert json.loads(text) == {"name": name, "ä": "ö"}
    assert "ö" in text


def test_what_fails_while_it_is_written_leaves_the_old_file(tmp_path):
    path = tmp_path / "a.txt"
    path.write_text("old")
    with pytest.raises(ZeroDivisionError), written_aside(path) as aside:
        aside.with_suffix(".txt").write_text("half") / 0
    assert path.read_text() == "old"
    assert list(tmp_path.iterdir()) == [path]
    with pytest.raises(InputError, match="cannot be written"), written_aside(path / "b") as aside:
        pytest.fail("there is no such folder")


LARGE = 3 * 2**20  # bytes, three times what is read


def npy(shape: tuple[int, ...], size: int, descr: str = "|i1") -> bytes:
    """An ``.npy`` file that declares a shape, with ``size`` bytes of zeros."""
    stream = io.BytesIO()
    header = {"descr": descr, "fortran_order": False, "shape": shape}
    np.lib.format.write_array_header_1_0(stream, header)
    return stream.getvalue() + bytes(size)


def replaced(path, name: str, content: bytes, other: str = "", method: int = 8) -> None:
    """Replaces an archive's member by another, of the same name unless ``other`` is one."""
    with zipfile.ZipFile(path) as archive:
        members = {one: archive.read(one) for one in archive.namelist() if one != name}
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(other or name, content, method)
        for one, data in members.items():
            archive.writestr(one, data)


def most_allocated(path) -> int:
    """Bytes that loading a file, or refusing it, takes at most."""
    tracemalloc.start()
    try:
        with contextlib.suppress(EpisodeError):
            load_episode(path)
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.fixture
def small_limits(monkeypatch):
    monkeypatch.setattr(episode_file, "MAX_EPISODE_BYTES", LARGE // 3)
    monkeypatch.setattr(episode_file, "MAX_HEADER_BYTES", LARGE // 3)


def members_of(tmp_path) -> tuple[Any, list[str]]:
    """An episode's file with every member that there is, and their names."""
    path = tmp_path / "a.npz"
    save_episode(traced(), path)
    with zipfile.ZipFile(path) as archive:
        return path, archive.namelist()


@pytest.mark.filterwarnings("ignore:.*cut off:dynastar.errors.DynastarWarning")
def test_no_member_is_unpacked_beyond_the_limit(tmp_path, small_limits):
    _, names = members_of(tmp_path)
    for name in names:
        for other in ("", name.removesuffix(".npy"), f"{name}.npy", f"./{name}", f"{name}\0"):
            path, _ = members_of(tmp_path)
            replaced(path, name, npy((LARGE,), LARGE), other)
            assert most_allocated(path) < LARGE // 2, (name, other)
            whole = path.read_bytes()
            path.write_bytes(whole[:-1])
            assert most_allocated(path) < LARGE, (name, other, "cut off")


def test_a_declared_size_or_shape_is_not_believed(tmp_path, small_limits):
    _, names = members_of(tmp_path)
    for name in names:
        path, _ = members_of(tmp_path)
        replaced(path, name, npy((LARGE,), LARGE))
        whole = path.read_bytes()
        sizes = len(npy((LARGE,), LARGE)).to_bytes(4, "little")
        assert whole.count(sizes) == 2
        path.write_bytes(whole.replace(sizes, (200).to_bytes(4, "little")))
        assert most_allocated(path) < LARGE, name
        for shape in ((2**50,), (2**50, 0), (2**20, 2**20)):
            path, _ = members_of(tmp_path)
            replaced(path, name, npy(shape, 8))
            with pytest.raises(EpisodeError, match=r"a\.npz: "):
                load_episode(path)


@pytest.mark.parametrize("method", [zipfile.ZIP_BZIP2, zipfile.ZIP_LZMA])
def test_other_ways_to_compress_are_refused(tmp_path, method):
    path, _ = members_of(tmp_path)
    replaced(path, "values.npy", npy((4, 6), 24), method=method)
    with pytest.raises(EpisodeError, match=r"'values\.npy' is not compressed as in an \.npz"):
        load_episode(path)


def test_an_archive_of_too_many_members_is_refused(tmp_path):
    path, names = members_of(tmp_path)
    with zipfile.ZipFile(path, "a") as archive:
        for number in range(MAX_MEMBERS + 1 - len(names)):
            archive.writestr(str(number), b"")
    with pytest.raises(EpisodeError, match=f"more than {MAX_MEMBERS} members"):
        load_episode(path)

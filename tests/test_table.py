"""Ticks of an episode and numbers of a result as tables."""

import csv
import os
import sys
from types import ModuleType

import numpy as np
import pytest

from dynastar import InputError
from dynastar.errors import MissingPackage
from dynastar.metrics import measure
from dynastar.table import write_csv
from episodes import episode

EPISODE = episode(7)


def rows_of(path):
    with path.open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def test_an_episode_is_a_row_for_each_tick(tmp_path):
    EPISODE.to_csv(tmp_path / "ticks.csv")
    rows = rows_of(tmp_path / "ticks.csv")
    assert [float(row["time_s"]) for row in rows] == EPISODE.trajectory.times.tolist()
    for name, column in zip(("x_m", "y_m", "heading_rad"), EPISODE.trajectory.poses.T, strict=True):
        assert [float(row[name]) for row in rows] == column.tolist()
    assert [float(row["command_omega_radps"]) for row in rows] == EPISODE.commands[:, 1].tolist()
    assert [row["state"] for row in rows] == EPISODE.states.tolist()
    assert "limited_by" not in rows[0]


def test_a_result_is_one_row(tmp_path):
    result = measure(EPISODE)
    result.to_csv(tmp_path / "result.csv")
    (row,) = rows_of(tmp_path / "result.csv")
    assert tuple(row) == result._fields
    assert (row["outcome"], float(row["length"])) == ("arrived", result.length)


def test_folders_that_are_missing_are_made(tmp_path):
    EPISODE.to_csv(tmp_path / "no" / "ticks.csv")
    assert len(rows_of(tmp_path / "no" / "ticks.csv")) == len(EPISODE.trajectory.times)


def test_a_file_that_cannot_be_written_is_named(tmp_path):
    (tmp_path / "file").write_text("")
    os.mkfifo(tmp_path / "pipe")
    for name, said in (
        ("file/ticks.csv", r"ticks.csv: cannot be written"),
        ("pipe", "is no regular file"),
        (".", "is no regular file"),
    ):
        with pytest.raises(InputError, match=said):
            EPISODE.to_csv(tmp_path / name)
    with pytest.raises(InputError, match="name"):
        EPISODE.to_csv("")


def test_a_file_that_is_cut_off_in_writing_leaves_the_old_one(tmp_path):
    file = tmp_path / "a.csv"
    write_csv({"a": [1]}, file)
    with pytest.raises(ValueError, match="shorter"):
        write_csv({"a": [1, 2], "b": [1]}, file)
    assert file.read_text(encoding="utf-8").split() == ["a", "1"]
    assert [path.name for path in tmp_path.iterdir()] == ["a.csv"]


def test_a_data_frame_has_the_columns(monkeypatch):
    pandas = ModuleType("pandas")
    pandas.DataFrame = dict
    pandas.__spec__ = sys.__spec__
    monkeypatch.setitem(sys.modules, "pandas", pandas)
    frame = EPISODE.to_dataframe()
    assert list(frame)[:4] == ["time_s", "x_m", "y_m", "heading_rad"]
    assert np.array_equal(frame["clearance_m"], EPISODE.clearance)


def test_without_pandas_one_error_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(MissingPackage, match=r"data frames need pandas: pip install '\.\[pandas"):
        EPISODE.to_dataframe()

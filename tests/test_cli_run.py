"""What `dynastar run` leaves in a folder that has the results of an older run."""

import errno
from pathlib import Path
from typing import Any

import pytest

from dynastar.cli import run
from dynastar.errors import InputError
from dynastar.writing import written_aside


def contents(folder: Path) -> dict[str, str]:
    return {file.name: file.read_text() for file in folder.iterdir()}


def test_a_folder_never_holds_files_of_two_runs(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in (*run.FILES, "notes.txt"):
        (tmp_path / name).write_text("older")
    before, interrupts = contents(tmp_path), [KeyboardInterrupt]

    def write_files(folder: Path, *given: Any) -> None:
        (folder / "summary.json").write_text("newer")
        if interrupts:
            raise interrupts.pop()

    monkeypatch.setattr(run, "_write_files", write_files)
    given: Any = None
    with pytest.raises(KeyboardInterrupt):
        run.write_folder(tmp_path, given, {}, gif=False)
    assert contents(tmp_path) == before
    run.write_folder(tmp_path, given, {}, gif=False)
    assert contents(tmp_path) == {"summary.json": "newer", "notes.txt": "older"}
    (tmp_path / "figure.png").mkdir()
    with pytest.raises(InputError, match=r"figure\.png: that is a folder"):
        run.write_folder(tmp_path, given, {}, gif=False)


def test_a_full_disk_is_told_of_the_folder_that_was_asked_for(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def write_files(folder: Path, *given: Any) -> None:
        with written_aside(folder / "episode.npz"):
            raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr(run, "_write_files", write_files)
    given: Any = None
    with pytest.raises(InputError) as found:
        run.write_folder(tmp_path, given, {}, gif=False)
    file = tmp_path / "episode.npz"
    assert str(found.value) == f"{file}: cannot be written (No space left on device)"
    assert contents(tmp_path) == {}

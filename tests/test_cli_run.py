"""What `dynastar run` leaves in a folder that has the results of an older run."""

from pathlib import Path
from typing import Any

import pytest

from dynastar.cli import run
from dynastar.errors import InputError


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

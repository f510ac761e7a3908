"""Folders beside their place: kept, dropped, and cleared when their process was killed."""

import subprocess
import sys

import pytest

from dynastar.ros import aside
from dynastar.ros.aside import AsideFolder

HELD = """
import sys, time
from pathlib import Path
from dynastar.ros.aside import AsideFolder
folder = AsideFolder(Path(sys.argv[1]))
folder.written.mkdir()
print("written", flush=True)
time.sleep(600)
"""


def names(folder):
    return [path.name for path in folder.iterdir()]


def test_what_is_kept_has_its_name_and_nothing_else_is_left(tmp_path):
    kept, dropped = AsideFolder(tmp_path / "a"), AsideFolder(tmp_path / "b")
    kept.written.mkdir()
    dropped.written.mkdir()
    kept.keep()
    dropped.drop()
    assert names(tmp_path) == ["a"]


@pytest.mark.skipif(aside.fcntl is None, reason="needs locks")
def test_what_a_killed_process_left_goes_and_what_is_being_written_stays(tmp_path):
    command = [sys.executable, "-c", HELD, str(tmp_path / "a")]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    try:
        assert process.stdout.readline() == "written\n"
        [held] = names(tmp_path)
        AsideFolder(tmp_path / "b").drop()
        assert names(tmp_path) == [held]
    finally:
        process.kill()
        process.communicate()
    other = tmp_path / ".other.aside"
    other.mkdir()
    AsideFolder(tmp_path / "b").drop()
    assert names(tmp_path) == [other.name]

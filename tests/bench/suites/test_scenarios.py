"""Scenario files of a user's own folder as a suite."""

import shutil

from dynastar.bench.missions import Options
from dynastar.bench.runner import run_suite
from dynastar.bench.suites import load_suite
from dynastar.io.examples import example_scenarios

SUITE = load_suite("scenarios")
SCENE = example_scenarios()["u_trap"]


def folder_of(tmp_path, *names):
    folder = tmp_path / "scenes"
    shutil.copytree(
        SCENE.parent, folder, ignore=lambda _, files: {f for f in files if ".toml" in f}
    )
    text = SCENE.read_text(encoding="utf-8")
    for name in names:
        (folder / name).write_text(f"{changed(text)}", encoding="utf-8")
    return folder


def changed(text, preset="paper"):
    lines = [line for line in text.splitlines() if not line.startswith(("preset", "time_limit"))]
    return "\n".join([f'preset = "{preset}"', "time_limit = 0.5", *lines])


def test_a_file_is_driven_with_its_own_preset_unless_one_is_asked_for(tmp_path):
    folder = folder_of(tmp_path, "one.toml")
    for asked, driven in (("", "paper"), ("default", "default")):
        result = run_suite("scenarios", SUITE, Options(data=folder, preset=asked))
        assert [row["preset"] for row in result["rows"]] == [driven]
        assert result["preset"] == driven


def test_a_run_that_goes_on_drives_files_that_are_new_or_changed(tmp_path):
    folder, keep = folder_of(tmp_path, "b.toml"), tmp_path / "rows.jsonl"
    run_suite("scenarios", SUITE, Options(data=folder), keep=keep)
    shutil.copy(folder / "b.toml", folder / "a.toml")
    result = run_suite("scenarios", SUITE, Options(data=folder), keep=keep)
    assert [row["file"] for row in result["rows"]] == ["a.toml", "b.toml"]
    text = (folder / "b.toml").read_text(encoding="utf-8").replace("0.5", "1.0")
    (folder / "b.toml").write_text(text, encoding="utf-8")
    result = run_suite("scenarios", SUITE, Options(data=folder), keep=keep)
    assert [row["time"] for row in result["rows"]] == [0.5, 1.0]


def test_a_file_that_is_not_there_is_a_failed_row_and_the_others_are_driven(tmp_path):
    folder = folder_of(tmp_path, "one.toml")
    (folder / "gone.toml").symlink_to(tmp_path / "nowhere.toml")
    result = run_suite("scenarios", SUITE, Options(data=folder))
    assert [row["outcome"] for row in result["rows"]] == ["error", "timeout"]
    assert "gone.toml" in result["rows"][0]["reason"]
    assert result["preset"] == "paper"

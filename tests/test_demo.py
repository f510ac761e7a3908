"""What the demo says beside what `dynastar run` does."""

import io
import sys

import pytest

from dynastar.cli import main


@pytest.mark.parametrize(
    ("terminal", "answer", "opened"),
    [(True, "y\n", True), (True, "\n", False), (True, "", False), (False, "y\n", False)],
)
def test_the_demo_offers_its_replay_at_a_terminal_only(
    terminal, answer, opened, tmp_path, monkeypatch, capsys
):
    shown = []
    stdin, told = io.StringIO(answer), "open the replay in the browser?"
    monkeypatch.setattr(stdin, "isatty", lambda: terminal)
    monkeypatch.setattr("sys.stdin", stdin)
    monkeypatch.setattr(sys.stderr, "isatty", lambda: True, raising=False)
    monkeypatch.setattr("dynastar.cli.run.execute", lambda arguments: 1)
    monkeypatch.setattr("webbrowser.open", lambda address: shown.append(address) or True)
    assert main(["demo", "--out", str(tmp_path)]) == 1
    assert (told in capsys.readouterr().err) == terminal
    assert shown == ([(tmp_path / "report.html").as_uri()] if opened else [])


def test_a_copy_that_fails_is_one_line_and_can_be_tried_again(tmp_path, monkeypatch, capsys):
    source, target = tmp_path / "source", tmp_path / "mine"
    (source / "office").mkdir(parents=True)
    (source / "first.py").touch()
    for name in ("a.toml", "b.toml"):
        (source / "office" / name).symlink_to("nowhere")  # cannot be copied
    monkeypatch.setattr("dynastar.io.examples.examples_folder", lambda: source)
    assert main(["demo", "--copy", str(target)]) == 2
    (said,) = capsys.readouterr().err.splitlines()
    assert f"--copy {target}: " in said
    assert (said.count(".toml"), "No such file" in said) == (1, True)
    assert list(target.iterdir()) == []
    for file in (source / "office").iterdir():
        file.unlink()
    assert main(["demo", "--copy", str(target)]) == 0
    assert sorted(file.name for file in target.iterdir()) == ["first.py", "office"]

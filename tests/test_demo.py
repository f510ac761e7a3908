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

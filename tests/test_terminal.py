"""Text for terminals, on the command line and in progress, and names that are drawn."""

import io as streams
import sys
from dataclasses import replace

import pytest

from dynastar import terminal
from dynastar.cli import main
from dynastar.io import save_episode
from dynastar.terminal import printable, progress_bar
from episodes import episode

HOSTILE = "\x1b]0;owned\x07\x1b[2J\r\x9b31m\u202ename\n  outcome  arrived"


class Terminal(streams.StringIO):
    """A stream that is a terminal."""

    def isatty(self):
        return True


def test_control_characters_become_escapes_and_letters_stay():
    text = printable(HOSTILE)
    assert text.isprintable()
    assert text.startswith(r"\x1b]0;owned\x07\x1b[2J\r\x9b31m\u202ename\n")
    assert printable("Büro 1 \N{ROBOT FACE} \u5ba4") == "Büro 1 \N{ROBOT FACE} \u5ba4"
    assert printable("a\nb\tc\x1b", keep="\n\t") == "a\nb\tc\\x1b"


def hostile():
    """An episode whose texts are all hostile."""
    one = episode(movers=1)
    return replace(
        one, robot=HOSTILE, outcome=HOSTILE, reason=HOSTILE, contact=HOSTILE,
        scenario={**one.scenario, "name": HOSTILE},
    )  # fmt: skip


@pytest.mark.parametrize("more", [[], ["--json"]])
def test_names_in_files_do_not_reach_the_terminal_as_they_are(tmp_path, capsys, more):
    save_episode(hostile(), tmp_path / "a.npz")
    (tmp_path / "a.toml").write_text(f"robot = {HOSTILE!r}".replace("'", '"'))
    main(["info", str(tmp_path / "a.npz"), *more])
    main(["info", str(tmp_path / "a.toml"), *more])
    main(["info", str(tmp_path / f"{HOSTILE}.npz"), *more])
    out, errors = capsys.readouterr()
    assert "owned" in errors
    for line in (out + errors).splitlines():
        assert line.isprintable(), line
    assert "\n  outcome  arrived" not in out + errors


def test_progress_in_a_pipe_is_a_line_every_few_seconds(monkeypatch):
    now, pipe = [0.0], streams.StringIO()
    monkeypatch.setattr(sys, "stderr", pipe)
    monkeypatch.setattr(terminal, "EVERY", 0.0)
    list(progress_bar(range(3), HOSTILE, mininterval=0.0))
    lines = pipe.getvalue().splitlines()
    assert 1 <= len(lines) <= 5
    assert all(line.isprintable() and "owned" in line for line in lines)
    pipe.truncate(0)
    monkeypatch.setattr(terminal, "EVERY", 5.0)
    monkeypatch.setattr("time.monotonic", lambda: now[0])
    stream = terminal._Lines(pipe)
    for tick in range(120):
        now[0] = 0.1 * tick
        stream.write(f"\r{tick} of 120   ")
    assert pipe.getvalue().strip("\0").splitlines() == ["50 of 120", "100 of 120"]


def test_progress_in_a_terminal_is_a_bar(monkeypatch):
    screen = Terminal()
    monkeypatch.setattr(sys, "stderr", terminal.Printable(screen))
    list(progress_bar(range(3), HOSTILE, mininterval=0.0))
    assert "\r" in screen.getvalue()
    assert "\x1b" not in screen.getvalue()

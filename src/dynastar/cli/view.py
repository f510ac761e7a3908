"""``dynastar view``: episodes as a page that replays them."""

import argparse
import sys
import webbrowser
from pathlib import Path

from dynastar import io
from dynastar.cli.outputs import check_file
from dynastar.errors import EpisodeError, InputError
from dynastar.page import write_report
from dynastar.page.report import MOST

EPISODE = "episode.npz"


def execute(arguments: argparse.Namespace) -> int:
    """Writes the page and prints where it is."""
    if len(arguments.episodes) > MOST:
        raise InputError(f"{len(arguments.episodes)} episodes are given: expected one or two")
    files = [_file(path) for path in arguments.episodes]
    out = arguments.out or files[0].with_name(
        "report.html" if files[0].name == EPISODE else f"{files[0].stem}.html"
    )
    check_file("--out", out)
    write_report([io.load_episode(file) for file in files], out)
    print(out)
    if arguments.open and not webbrowser.open(out.absolute().as_uri()):
        print(f"no browser was found: open {out} in one", file=sys.stderr)
    return 0


def _file(path: Path) -> Path:
    """The episode's file, also of a folder that ``dynastar run`` wrote."""
    if not path.is_dir():
        return path
    if not (path / EPISODE).is_file():
        raise EpisodeError(f"{path}: no {EPISODE} in this folder; name an episode (.npz)")
    return path / EPISODE

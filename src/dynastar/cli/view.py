"""``dynastar view``: episodes as a page that replays them."""

import argparse
import sys
from pathlib import Path

from dynastar import io
from dynastar.cli.outputs import check_file, refuse_dash
from dynastar.cli.parsing import path
from dynastar.errors import EpisodeError, InputError

DESCRIPTION = (
    "Writes one HTML file that replays an episode, or two side by side on one clock: map, "
    "paths, candidates with their scores, terms of Eq. 9 and tracked obstacles over time. It needs no "
    "network."
)

EXAMPLES = """\
examples:
  dynastar view out/office --open
  dynastar view out/default out/paper --out both.html
  dynastar view failures/barn-17.npz

Episodes of `dynastar run` have all that the page can show; those that were written without it lack
candidates, terms and tracks."""

EPISODE = "episode.npz"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "episodes", nargs="+", metavar="EPISODE", type=path, help="an .npz, or a folder of `run`"
    )
    parser.add_argument(
        "--out", type=path, metavar="HTML", help="default report.html beside the first episode"
    )
    parser.add_argument("--open", action="store_true", help="open it in the browser")


def execute(arguments: argparse.Namespace) -> int:
    """Writes the page and prints where it is."""
    import webbrowser

    from dynastar.page import write_report
    from dynastar.page.report import MOST

    if len(arguments.episodes) > MOST:
        raise InputError(f"{len(arguments.episodes)} episodes are given: expected one or two")
    files = [_file(path) for path in arguments.episodes]
    out = arguments.out or files[0].with_name(
        "report.html" if files[0].name == EPISODE else f"{files[0].stem}.html"
    )
    refuse_dash("--out", out)
    check_file("--out", out, files)
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

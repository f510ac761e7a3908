"""``dynastar demo``: drive an example that comes with dynastar, or copy them all."""

import argparse
import sys
from pathlib import Path

from dynastar.cli import run
from dynastar.cli.arguments import add_json, add_no_gif
from dynastar.cli.outputs import make_folder
from dynastar.cli.parsing import path
from dynastar.config import choose
from dynastar.errors import InputError
from dynastar.writing import reason_of

DESCRIPTION = (
    "Drives a robot across an office, or through another of the examples that come with "
    "dynastar; draws it and measures it, as `dynastar run` does."
)

EXAMPLES = """\
examples:
  dynastar demo
  dynastar demo --list
  dynastar demo --copy my-examples"""


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Add the options of the command."""
    parser.add_argument(
        "name", nargs="?", default="office", metavar="NAME", help="of --list (default office)"
    )
    parser.add_argument("--out", type=path, metavar="DIR", help="default out/NAME")
    add_json(parser)
    add_no_gif(parser)
    parser.add_argument("--list", action="store_true", help="list the examples instead")
    parser.add_argument(
        "--copy", type=path, metavar="DIR", help="copy all of them into a folder instead, to change"
    )


def execute(arguments: argparse.Namespace) -> int:
    """Runs an example as ``dynastar run`` does, or copies or lists the examples."""
    from dynastar.io.examples import example_scenarios

    if arguments.list:
        print("\n".join(example_scenarios()))
        return 0
    if arguments.copy is not None:
        return _copy(arguments.copy)
    choose(arguments.name, example_scenarios(), "example")
    arguments.out = arguments.out or Path("out", arguments.name)
    arguments.scenario = example_scenarios()[arguments.name]
    arguments.seed = arguments.preset = arguments.bag = None
    arguments.set = []
    print(f"driving the example {arguments.name} in simulation", file=sys.stderr)
    status = run.execute(arguments)
    if sys.stdin.isatty() and sys.stderr.isatty():
        _offer(run.replay_address(arguments.out))
    return status


def _offer(address: str) -> None:
    """Asks whether to open the replay in the browser."""
    import webbrowser

    print("open the replay in the browser? [y/N] ", end="", file=sys.stderr, flush=True)
    if sys.stdin.readline().strip().lower() in ("y", "yes") and not webbrowser.open(address):
        print(f"no browser was found: open {address} in one", file=sys.stderr)


def _copy(folder: Path) -> int:
    import shutil
    import tempfile

    from dynastar.io.examples import examples_folder

    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        raise InputError(f"--copy {folder}: is there already; expected a new or an empty folder")
    make_folder("--copy", folder)
    try:
        with tempfile.TemporaryDirectory(prefix=".examples.", suffix=".aside", dir=folder) as aside:
            ignored = shutil.ignore_patterns("__pycache__")
            shutil.copytree(examples_folder(), aside, dirs_exist_ok=True, ignore=ignored)
            for made in Path(aside).iterdir():
                made.replace(folder / made.name)
    except shutil.Error as errors:
        file, _, why = errors.args[0][0]  # why: "[Errno 28] No space left on device: '...'"
        why = why.partition("] ")[2].partition(":")[0] or why
        raise InputError(
            f"--copy {folder}: {Path(file).name} cannot be copied there ({why})"
        ) from None
    except OSError as error:
        raise InputError(f"--copy {folder}: cannot be written ({reason_of(error)})") from None
    print(f"the examples are in {folder}", file=sys.stderr)
    return 0

"""The command line: ``dynastar plan``, ``run``, ``demo``, ``info`` and so on, a module each.

A command's module has its ``DESCRIPTION``, ``EXAMPLES``, ``add_arguments`` and ``execute``. Only the
modules of commands that are named are imported, and nothing heavy before ``execute``.

Exit status: 0 done; 1 no path (``plan``) or anything but a contact-free arrival (``run``); 2 bad
input, with one line on stderr.
"""

import os
import sys
import warnings
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, redirect_stderr, redirect_stdout, suppress
from importlib import import_module
from typing import Any, TextIO, cast

from dynastar import __version__
from dynastar.cli.parsing import OneLineParser
from dynastar.errors import DynastarError, DynastarWarning, InputError, MissingPackage
from dynastar.interrupt import INTERRUPTED
from dynastar.terminal import Printable

COMMANDS = {
    "plan": "find a path on a map",
    "run": "drive a scenario in simulation",
    "check": "check a robot, its map and a recording before it drives",
    "demo": "drive an example that comes with dynastar",
    "info": "what a map, a scenario or an episode holds",
    "view": "replay an episode in the browser",
    "schema": "the JSON Schema of scenario files, for editors",
    "bench": "run suites of missions, compare results",
    "tune": "search better settings for a robot, or measure it from a recording",
    "paper": "remake the paper's tables and figures",
    "ros": "the navigator as a ROS 2 node",
    "ros-guard": "a guard for the commands of another controller, as a ROS 2 node",
    "ros-sim": "the simulator as a ROS 2 node",
    "ros-goal": "send the ROS 2 node a goal, and say what happens",
    "replay": "drive by the scans and odometry of a recording",
    "play": "drive live in the browser: set goals, paint obstacles, add walkers",
    "warmup": "compile everything now, so that the first mission does not wait",
}

EXAMPLES = """\
examples:
  dynastar demo
  dynastar info office.yaml --out drawing.png
  dynastar plan office.yaml --start 2 2 --goal 38 23 --radius 0.25
  dynastar run examples/office/office.toml --out out/office
  dynastar bench paper --missions 20
  dynastar bench all --quick --data data
  dynastar paper table1 --maps 100
  dynastar play
  dynastar warmup"""

ROS, TAKE_ROS = "--ros-args", ("ros", "ros-guard", "ros-sim", "ros-goal")

BROKEN_PIPE = 141


def main(argv: Sequence[str] | None = None) -> int:
    """Runs a command and returns its exit status; errors of dynastar's end here, in one line."""
    with warnings.catch_warnings(), _printable_streams():
        warnings.simplefilter("always", DynastarWarning)
        warnings.showwarning = _show(warnings.showwarning)
        return _run(list(sys.argv[1:] if argv is None else argv))


@contextmanager
def _printable_streams() -> Iterator[None]:
    """Names from files reach the terminal without the control characters that they may hold."""
    out, errors = Printable(sys.stdout), Printable(sys.stderr)
    with redirect_stdout(cast(TextIO, out)), redirect_stderr(cast(TextIO, errors)):
        yield


def _run(words: list[str]) -> int:
    """Carries out a command and returns its exit status."""
    try:
        cut = words.index(ROS) if ROS in words and words[0] in TAKE_ROS else len(words)
        arguments = build_parser(words).parse_args(words[:cut])
        arguments.ros_args = words[cut:]
        status: int = arguments.execute(arguments)
        sys.stdout.flush()
        return status
    except DynastarError as error:
        return _say(str(error), 2 if isinstance(error, InputError | MissingPackage) else 1)
    except KeyboardInterrupt:
        return _say("interrupted", INTERRUPTED)
    except BrokenPipeError:  # the reader of the output has closed it: nothing to add
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except OSError as error:  # a folder that cannot be written, a full disk
        return _say(str(error), 2)


def build_parser(names: Iterable[str] = COMMANDS) -> OneLineParser:
    """The parser of all commands; only those in ``names`` are imported and have their options."""
    parser = OneLineParser(
        prog="dynastar",
        description="Navigation for differential-drive robots: an improved A* plans, "
        "a dynamic window drives.",
        epilog=EXAMPLES,
    )
    parser.add_argument("--version", action="version", version=f"dynastar {__version__}")
    commands = parser.add_subparsers(dest="command", metavar="COMMAND", required=True)
    for name, what in COMMANDS.items():
        added = commands.add_parser(name, help=what)
        if name in names:
            command = import_module(f"dynastar.cli.{name.replace('-', '_')}")
            added.description, added.epilog = command.DESCRIPTION, command.EXAMPLES
            added.set_defaults(execute=command.execute)
            command.add_arguments(added)
    return parser


def _show(others: Callable[..., None]) -> Callable[..., None]:
    """A way to show warnings: dynastar's once in one line on stderr, those of others as before."""
    said = set()

    def show(message: Warning | str, category: type[Warning], *where: Any) -> None:
        if not issubclass(category, DynastarWarning):
            return others(message, category, *where)
        if str(message) not in said:
            said.add(str(message))
            _say(f"warning: {message}", 0)

    return show


def _say(message: str, status: int) -> int:
    with suppress(OSError):  # stderr is full or closed: the exit status says it
        print(f"dynastar: {' '.join(message.split())}", file=sys.stderr)
    return status

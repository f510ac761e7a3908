"""The command line: ``dynastar plan``, ``run``, ``demo``, ``info`` and so on.

Exit status: 0 done; 1 no path (``plan``) or anything but a contact-free arrival (``run``); 2 bad
input, with one line on stderr. Nothing heavy is imported before a command needs it.
"""

import os
import sys
from collections.abc import Sequence
from importlib import import_module

from dynastar.cli.arguments import build_parser
from dynastar.errors import DynastarError, InputError

ROS, TAKE_ROS = "--ros-args", ("ros", "ros-sim")
INTERRUPTED = 130
BROKEN_PIPE = 141


def main(argv: Sequence[str] | None = None) -> int:
    """Runs a command and returns its exit status; errors of dynastar's end here, in one line."""
    try:
        words = list(sys.argv[1:] if argv is None else argv)
        cut = words.index(ROS) if ROS in words and words[0] in TAKE_ROS else len(words)
        arguments = build_parser().parse_args(words[:cut])
        arguments.ros_args = words[cut:]
        command = import_module(f"dynastar.cli.{arguments.command.replace('-', '_')}")
        status: int = command.execute(arguments)
        sys.stdout.flush()
        return status
    except DynastarError as error:
        return _say(str(error), 2 if isinstance(error, InputError) else 1)
    except KeyboardInterrupt:
        return _say("interrupted", INTERRUPTED)
    except BrokenPipeError:  # the reader of the output has closed it: nothing to add
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return BROKEN_PIPE
    except OSError as error:  # a folder that cannot be written, a full disk
        return _say(str(error), 2)


def _say(message: str, status: int) -> int:
    print(f"dynastar: {' '.join(message.split())}", file=sys.stderr)
    return status

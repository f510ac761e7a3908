"""Ctrl-C while modules are imported, which otherwise ends in tracebacks, or is swallowed."""

import os
import signal
from types import FrameType

INTERRUPTED = 130  # exit status
_IMPORTING = "<frozen importlib._bootstrap>"


def end_imports_cleanly() -> None:
    """From now on Ctrl-C during an import ends this process at once, with one line on stderr.

    At any other time it raises KeyboardInterrupt, as ever. A handler of somebody else's stays.
    """
    if signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        return
    this_process = os.getpid()

    def interrupted(number: int, frame: FrameType | None) -> None:
        at = frame
        while at is not None and os.getpid() == this_process:
            if at.f_code.co_filename == _IMPORTING:
                os.write(2, b"dynastar: interrupted\n")
                os._exit(INTERRUPTED)
            at = at.f_back
        signal.default_int_handler(number, frame)

    signal.signal(signal.SIGINT, interrupted)

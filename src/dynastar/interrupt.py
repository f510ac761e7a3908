"""Ctrl-C while modules are imported or a kernel returns, which otherwise is a traceback or is lost."""

import os
import signal
from threading import Timer
from types import FrameType

INTERRUPTED = 130  # exit status
_IMPORTING = "<frozen importlib._bootstrap>"
_BOXING = "_numba_unpickle"  # what numba calls when a kernel returns a tuple with names
_AGAIN = 0.02  # s


def interrupt_cleanly() -> None:
    """From now on Ctrl-C during an import ends this process at once, with one line on stderr.

    numba makes a SystemError of an exception that is raised while a kernel returns: such a Ctrl-C comes
    again a moment later. At any other time it raises KeyboardInterrupt, as ever. A handler of somebody
    else's stays.
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
            if at.f_code.co_name == _BOXING:
                Timer(_AGAIN, os.kill, (this_process, number)).start()
                return
            at = at.f_back
        signal.default_int_handler(number, frame)

    signal.signal(signal.SIGINT, interrupted)

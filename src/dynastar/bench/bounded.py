"""Missions that may never return: each in a process of its own, with a limit of wall time."""

import multiprocessing
import warnings
from collections.abc import Callable
from multiprocessing.connection import Connection
from typing import Any

from dynastar.bench.missions import row_of

Row = dict[str, Any]


def row_within(seconds: float, work: Callable[[], Row]) -> Row:
    """The row that ``work`` returns, or the outcome "error" if it takes longer than ``seconds``.

    It runs in a forked process, because a compiled kernel cannot be interrupted in this one. Where
    that cannot be had (no fork, or a daemonic process) it runs here, without the limit.
    """
    forks = "fork" in multiprocessing.get_all_start_methods()
    if not forks or multiprocessing.current_process().daemon:
        return row_of(work)
    context = multiprocessing.get_context("fork")
    receiver, sender = context.Pipe(duplex=False)
    child = context.Process(target=_send, args=(sender, work), daemon=True)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", DeprecationWarning)  # of a fork beside threads
        child.start()
    sender.close()
    reason = f"no answer within {seconds:g} s of wall time"
    try:
        if receiver.poll(seconds):
            return receiver.recv()
    except EOFError:
        reason = "the process ended without an answer"
    finally:
        child.kill()
        child.join()
        receiver.close()
    return {"outcome": "error", "reason": reason}


def _send(sender: Connection, work: Callable[[], Row]) -> None:
    sender.send(row_of(work))
    sender.close()

"""The robot's loop: a thread of its own that ticks a session in real time, whoever listens."""

import logging
import queue
import threading
import time
from collections.abc import Callable
from concurrent.futures import Future
from typing import Any, NamedTuple

from dynastar.errors import InputError
from dynastar.play.session import Session

log = logging.getLogger("dynastar")

MOST_WAITING = 256  # requests between two ticks
BEHIND = 1.0  # s that the loop may be late until it stops to catch up
RATE_TICKS = 40  # over which the rate is taken


class News(NamedTuple):
    """What pages are told: the journal's number and entries, and the newest frame, all JSON."""

    journal: int
    entries: list[str]
    frame: str
    ticks: int
    rate: float
    paused: bool
    halted: str


class Loop(threading.Thread):
    """Ticks a session in real time; other threads ask by ``call`` and read ``news``.

    ``told`` is called from the loop's thread after each tick; it must not wait.
    """

    def __init__(self, session: Session, told: Callable[[], None]) -> None:
        super().__init__(name="robot", daemon=True)
        self._session, self._told = session, told
        self._asked: queue.Queue[tuple[Callable[..., Any], tuple[Any, ...], Future[Any]]]
        self._asked = queue.Queue(MOST_WAITING)
        self._over = threading.Event()
        self._ticks, self._ended = 0, [time.monotonic()]
        self.news = self._news()

    def call(self, function: Callable[..., Any], *arguments: Any) -> "Future[Any]":
        """Has the loop call something between two ticks; the future has what came of it."""
        future: Future[Any] = Future()
        try:
            self._asked.put_nowait((function, arguments, future))
        except queue.Full:
            future.set_exception(InputError("too much is asked for at once"))
        return future

    def stop(self) -> None:
        """Ends the loop and waits until it has."""
        self._over.set()
        self.join(5.0)

    def run(self) -> None:
        """Ticks until ``stop``."""
        due = time.monotonic()
        while not self._over.is_set():
            self._answer()
            if not self._session.paused:
                self._tick()
            self._ended = [*self._ended[-RATE_TICKS:], time.monotonic()]
            self.news = self._news()
            self._told()
            due += self._session.lasted
            late = time.monotonic() - due
            if late > BEHIND:
                due += late
            self._over.wait(max(0.0, -late))

    def _tick(self) -> None:
        try:
            self._session.tick()
            self._ticks += 1
        except Exception:  # the page stays alive, and says so
            log.exception("the simulation has stopped")
            self._session.paused = True
            self._session.halted = "the simulation has stopped by an error, which the log names"

    def _answer(self) -> None:
        for _ in range(self._asked.qsize()):
            function, arguments, future = self._asked.get_nowait()
            if not future.set_running_or_notify_cancel():  # who asked is gone
                continue
            try:
                future.set_result(function(*arguments))
            except Exception as error:
                future.set_exception(error)

    def _news(self) -> News:
        journal, session = self._session.journal, self._session
        span = self._ended[-1] - self._ended[0]
        rate = (len(self._ended) - 1) / span if span > 0.0 else 0.0
        return News(
            journal.number,
            journal.entries,
            journal.frame,
            self._ticks,
            rate,
            session.paused,
            session.halted,
        )

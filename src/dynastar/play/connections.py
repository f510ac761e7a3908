"""Connections that have asked for nothing yet: closed after a few seconds, and few at once."""

import asyncio

from uvicorn.protocols.http.h11_impl import H11Protocol

HEADERS_WITHIN = 4.0  # s from the connection, or from the last answer, to a whole request
MOST_WAITING = 64  # connections without a whole request


class Connection(H11Protocol):
    """A connection of the server; the longest waiting one makes room for a new one.

    So whoever sends a whole request at once is answered, however many others send half of one.
    """

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """Begins to wait for a request."""
        super().connection_made(transport)
        self._since = self.loop.time()
        waiting = [one for one in self.connections if isinstance(one, Connection) and one.waits]
        if len(waiting) > MOST_WAITING:
            min(waiting, key=lambda one: one._since).transport.abort()
        self._look_later(HEADERS_WITHIN)

    @property
    def waits(self) -> bool:
        """Whether there is no request that is to be answered."""
        return self.cycle is None or self.cycle.response_complete

    def on_response_complete(self) -> None:
        """Begins to wait for the next request."""
        self._since = self.loop.time()
        super().on_response_complete()

    def _look_later(self, seconds: float) -> None:
        self.loop.call_later(seconds, self._look)

    def _look(self) -> None:
        """Closes the connection if it has waited too long."""
        if self not in self.connections:  # it is lost, or a WebSocket now
            return
        left = HEADERS_WITHIN
        if self.waits:
            left += self._since - self.loop.time()
        if left > 0.0:
            self._look_later(left)
        else:
            self.transport.abort()

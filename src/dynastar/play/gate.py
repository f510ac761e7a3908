"""Who may talk to the server: checks of Host, Origin and token, and how much a page may ask for."""

import secrets
import time
from collections.abc import Mapping
from ipaddress import ip_address
from urllib.parse import urlsplit

TOKEN_BYTES = 18
RATE = 40.0  # messages/s that a page may send
BURST = 80.0


class Gate:
    """Lets requests in. On loopback they need a loopback name as their host, elsewhere the token."""

    def __init__(self, host: str, port: int) -> None:
        self.loopback = is_loopback(host)
        self.token = "" if self.loopback else secrets.token_urlsafe(TOKEN_BYTES)
        self.port = port

    def refusal(self, headers: Mapping[str, str], token: str) -> str:
        """Why a request is refused, or ""; an origin, where there is one, must be this server."""
        host = headers.get("host", "")
        if self.loopback and not _local(host, self.port):
            return "the host is not this machine"
        origin = headers.get("origin")
        if origin is not None and _host_of(origin) != host:
            return "another site may not talk to this server"
        given = token.encode("utf-8", "replace")
        if self.token and not secrets.compare_digest(given, self.token.encode()):
            return "the token is wrong or missing: use the address that the server printed"
        return ""


class Allowance:
    """How many messages a page may still send: ``RATE`` a second, ``BURST`` at once."""

    def __init__(self) -> None:
        self._left, self._at = BURST, time.monotonic()

    def take(self) -> bool:
        """Take one. Returns True if there was one."""
        now = time.monotonic()
        self._left = min(BURST, self._left + RATE * (now - self._at))
        self._at = now
        if self._left < 1.0:
            return False
        self._left -= 1.0
        return True


def is_loopback(host: str) -> bool:
    """Whether a name or address is of this machine alone."""
    if host == "localhost":
        return True
    try:
        return ip_address(host.strip("[]")).is_loopback
    except ValueError:
        return False


def _local(host: str, port: int) -> bool:
    """Whether a Host header names this machine and the server's port."""
    try:
        parts = urlsplit(f"//{host}")
        return is_loopback(parts.hostname or "") and (parts.port or 80) == port
    except ValueError:
        return False


def _host_of(origin: str) -> str | None:
    """The host and port of an origin; None if it is none."""
    try:
        return urlsplit(origin).netloc
    except ValueError:
        return None

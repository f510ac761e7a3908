"""The server as a process: what it answers, whom it lets in, and that nobody can slow the robot."""

import asyncio
import contextlib
import io as streams
import json
import socket
import subprocess
import sys
import threading
import time
import urllib.error
import urllib.request
import zipfile
from concurrent.futures import ThreadPoolExecutor

import pytest

from dynastar import io
from playing import ended, started

websockets = pytest.importorskip("websockets.sync.client")
pytest.importorskip("starlette")
pytest.importorskip("uvicorn")

from starlette.websockets import WebSocketDisconnect  # noqa: E402
from websockets.exceptions import ConnectionClosed, InvalidStatus  # noqa: E402

from dynastar.play.server import Playground  # noqa: E402


@pytest.fixture(scope="module")
def address():
    process, line = started()
    yield line
    ended(process)


class Page:
    """A page without a browser."""

    def __init__(self, address, **more):
        place, _, query = address.partition("/?")
        url = place.rstrip("/").replace("http", "ws", 1) + "/socket" + (query and f"?{query}")
        self.socket = websockets.connect(url, max_size=None, **more).__enter__()
        self.told = {}

    def ask(self, **message):
        self.socket.send(json.dumps(message))

    def until(self, holds, seconds=60.0):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            for one in json.loads(self.socket.recv(timeout=seconds)):
                self.told[one["type"]] = one
                if holds(one):
                    return one
        raise AssertionError(f"not in {seconds} s")

    def frame(self):
        return self.until(lambda one: one["type"] == "frame")

    def rate(self, seconds=3.0):
        """Ticks a second by this test's own clock."""
        first, began = self.until(lambda one: one["type"] == "loop"), time.monotonic()
        last = first
        while time.monotonic() < began + seconds:
            last = self.until(lambda one: one["type"] == "loop")
        return (last["ticks"] - first["ticks"]) / (time.monotonic() - began)


def status_of(address, path="", **headers):
    """Status and body of a GET."""
    place, _, query = address.partition("/?")
    request = urllib.request.Request(f"{place.rstrip('/')}/{path}?{query}", headers=headers)
    try:
        with urllib.request.urlopen(request, timeout=30) as answer:
            return answer.status, answer.read(), answer.headers
    except urllib.error.HTTPError as error:
        return error.code, error.read(), error.headers


def test_a_page_drives_and_what_was_driven_is_saved(address, tmp_path):
    page = Page(address)
    scene = page.until(lambda one: one["type"] == "scene")
    assert scene["scenes"] == ["office", "twenty", "field", "crowd", "u_trap"]
    page.ask(type="scene", scene="u_trap")
    page.ask(type="goals", goals=[[1.5, 8.0, None]])
    page.until(lambda one: one["type"] == "frame" and one["state"] == "arrived", 60.0)
    status, body, _ = status_of(address, "scene.zip")
    assert status == 200
    zipfile.ZipFile(streams.BytesIO(body)).extractall(tmp_path)
    assert io.load_scenario(tmp_path / "scenario.toml").start[1] == pytest.approx(8.0, abs=0.3)
    status, body, _ = status_of(address, "episode.npz")
    (tmp_path / "episode.npz").write_bytes(body)
    assert io.load_episode(tmp_path / "episode.npz").outcome == "arrived"
    status, body, _ = status_of(address, "report.html")
    assert (status, b"<canvas" in body or b"views" in body) == (200, True)


def test_pages_see_the_same_robot_and_what_is_refused_is_said_to_who_asked(address):
    first, second = Page(address), Page(address)
    first.ask(type="reset")
    first.ask(type="pause", paused=True)
    for page in (first, second):
        page.until(lambda one: one["type"] == "loop" and one["paused"])
    assert first.frame()["time"] == second.frame()["time"]
    first.ask(type="walker", x=-5.0, y=0.0, vx=1.0, vy=0.0)
    refused = first.until(lambda one: one["type"] == "refused")
    assert refused["reason"].startswith("nobody has room")
    assert "refused" not in second.told
    first.ask(type="pause", paused=False)
    second.until(lambda one: one["type"] == "loop" and not one["paused"])


def test_the_page_has_its_headers_and_the_rest_is_not_there(address):
    status, body, headers = status_of(address)
    assert (status, body[:15]) == (200, b"<!doctype html>")
    assert "default-src 'none'" in headers["content-security-policy"]
    assert headers["cache-control"] == "no-store"
    for path in ("static/page.css", "../pyproject.toml", "%2e%2e/etc/passwd"):
        assert status_of(address, path)[0] == 404


@pytest.mark.parametrize(
    "headers", [{"Host": "evil.example"}, {"Origin": "http://evil.example"}, {"Origin": "null"}]
)
def test_other_sites_get_nothing(address, headers):
    for path in ("", "scene.zip", "episode.npz", "report.html"):
        assert status_of(address, path, **headers)[0] == 403
    if "Origin" in headers:
        with pytest.raises(InvalidStatus):
            Page(address, additional_headers=headers)


def test_elsewhere_a_token_is_asked_for():
    process, line = started("--host", "0.0.0.0")
    try:
        port = line.split("/?")[0].rpartition(":")[2]
        own = f"http://{socket.gethostname()}:"
        assert line.startswith(own)
        local = line.replace(own, "http://127.0.0.1:")
        assert status_of(local)[0] == 200
        assert status_of(f"http://127.0.0.1:{port}")[0] == 403
        assert status_of(local + "x")[0] == 403
        assert Page(local).frame()["time"] >= 0.0
        with pytest.raises(InvalidStatus):
            Page(f"http://127.0.0.1:{port}")
    finally:
        ended(process)


def test_a_thousand_malformed_messages_leave_it_running(address):
    watcher = Page(address)
    junk = ["", "{", "[]", "null", '{"type": 1}', '{"type": "goals", "goals": 3}', "[" * 9000]
    junk += [
        '{"type": "stroke", "points": [[1e999, 0]]}',
        "\x00",
        '{"type": "\\ud800"}',
        "9" * 9000,
    ]
    sent = 0
    while sent < 1000:
        page = Page(address)
        try:
            for _ in range(1000 - sent):
                page.socket.send(junk[sent % len(junk)])
                sent += 1
            page.socket.recv(timeout=60.0)
        except ConnectionClosed:  # too many, as it should be
            pass
    page = Page(address)
    page.socket.send("x" * 100_000)
    with pytest.raises(ConnectionClosed):
        page.until(lambda one: False)
    page = Page(address)
    page.socket.send(b"\xff\xfe")
    watcher.ask(type="pause", paused=False)
    ticks = watcher.until(lambda one: one["type"] == "loop")["ticks"]
    watcher.until(lambda one: one["type"] == "loop" and one["ticks"] > ticks + 10)
    watcher.ask(type="reset")
    assert watcher.until(lambda one: one["type"] == "scene")["name"] == "u_trap"


def test_a_flood_and_a_page_that_takes_nothing_do_not_slow_the_robot(address):
    watcher, deaf = Page(address), Page(address)
    watcher.ask(type="pause", paused=False)
    calm = watcher.rate(4.0)
    deaf.ask(type="reset")
    over, sent, pages = threading.Event(), [], []

    def flood():
        while not over.is_set():
            try:
                page = Page(address)
                pages.append(page)
                while not over.is_set():
                    page.socket.send('{"type": "goals", "goals": [[1.5, 8.0, null]]}')
                    sent.append(1)
            except (ConnectionClosed, InvalidStatus, OSError):  # refused: sent too many
                time.sleep(0.05)

    threads = [threading.Thread(target=flood) for _ in range(2)]
    for thread in threads:
        thread.start()
    try:
        rate = watcher.rate(4.0)
    finally:
        over.set()
        for page in pages:  # a send that waits for the server would wait 40 s for its keepalive
            with contextlib.suppress(OSError):
                page.socket.socket.shutdown(socket.SHUT_RDWR)
        for thread in threads:
            thread.join()
    assert rate > 0.75 * calm
    assert len(sent) > 1000


def half_sent(address, count):
    """Connections that have sent a part of a request each."""
    port = int(address.split("/?")[0].rstrip("/").rpartition(":")[2])
    opened = [socket.create_connection(("127.0.0.1", port), timeout=60) for _ in range(count)]
    for one in opened:
        one.sendall(f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n".encode())
    return opened


def test_half_sent_requests_keep_nobody_out_and_are_closed(address):
    opened = half_sent(address, 200)
    try:
        assert status_of(address)[0] == 200
        assert Page(address).frame()["time"] >= 0.0
        for one in opened:  # closed by the server: without this each would wait for its timeout
            with contextlib.suppress(ConnectionResetError):
                assert one.recv(1) == b""
    finally:
        for one in opened:
            one.close()


@pytest.mark.parametrize("gone", [WebSocketDisconnect(1006), RuntimeError("closed"), OSError()])
def test_a_page_that_leaves_while_it_is_told_to_go_is_no_error(gone):
    class Left:
        async def accept(self):
            raise gone

        async def close(self, code, reason):
            raise gone

    page = Playground.__new__(Playground)
    page._pages = set()
    for refused in ("", "of another origin"):
        page._refusal = lambda _, refused=refused: refused
        with ThreadPoolExecutor() as apart:  # a browser's test may have left a loop in this thread
            apart.submit(lambda: asyncio.run(page._socket(Left()))).result()
    assert not page._pages


def test_a_port_that_is_taken_and_a_scene_that_is_none_are_one_line(address):
    port = address.rstrip("/").rpartition(":")[2]
    for words, says in (
        (["--port", port], f"port {port} is in use; try another --port"),
        (["nowhere"], "unknown scene 'nowhere'"),
        (["nowhere.toml"], "there is no such file"),
        (["--port", "70000"], "expected 0 to 65535"),
        (["--host", "no such host"], "no such host:8642 is not an address to serve at: "),
    ):
        done = subprocess.run(
            [sys.executable, "-m", "dynastar", "play", *words],
            capture_output=True, text=True, timeout=120,
        )  # fmt: skip
        assert done.returncode == 2
        assert says in done.stderr
        assert len(done.stderr.splitlines()) == 1

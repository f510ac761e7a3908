"""The playground's server: one page, one WebSocket to the loop, and what can be saved."""

import asyncio
import contextlib
import errno
import io as streams
import json
import socket
import tempfile
import zipfile
from collections.abc import AsyncIterator, Callable
from pathlib import Path
from typing import Any

import uvicorn
from starlette.applications import Starlette
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.websockets import WebSocket, WebSocketDisconnect

from dynastar import io
from dynastar.errors import DynastarError, InputError
from dynastar.io.scenario_writing import save_scenario
from dynastar.page import report_html
from dynastar.page.packing import filled
from dynastar.play.connections import MOST_WAITING, Connection
from dynastar.play.gate import Allowance, Gate
from dynastar.play.loop import Loop, News
from dynastar.play.messages import MOST_BYTES, read_message
from dynastar.play.session import Session

SCRIPTS = ("scene.js", "charts.js", "legend.js", "panel.js", "live.js", "hand.js", "play.js")
HEADERS = {
    "Cache-Control": "no-store",
    "Referrer-Policy": "no-referrer",
    "X-Content-Type-Options": "nosniff",
    "Content-Security-Policy": "default-src 'none'; script-src 'unsafe-inline'; "
    "style-src 'unsafe-inline'; connect-src 'self'; img-src data:; base-uri 'none'; "
    "frame-ancestors 'none'; form-action 'none'",
}
MOST_PAGES = 16  # connected at once
MOST_ANSWERS = 64  # given at once
PATIENCE = 20.0  # s for a page to take what it is sent
POLICY, BUSY = 1008, 1013  # codes of a WebSocket's close
GONE = (WebSocketDisconnect, RuntimeError, OSError)  # what sending to a page that left raises
EVERYWHERE = ("0.0.0.0", "::")  # hosts that stand for all addresses of this machine


class Playground:
    """The application: pages are sent the journal's entries in order, and the newest frame."""

    def __init__(self, session: Session, gate: Gate) -> None:
        self._gate, self._session = gate, session
        self._html = filled("play.html", "dynastar", SCRIPTS)
        self._pages: set[asyncio.Event] = set()
        self._saving, self._answers = asyncio.Semaphore(1), 0
        self._events: asyncio.AbstractEventLoop | None = None
        self._loop = Loop(session, self._told)
        self.app = Starlette(
            routes=[
                Route("/", self._guarded(self._page)),
                Route("/scene.zip", self._guarded(self._scene)),
                Route("/episode.npz", self._guarded(self._episode)),
                Route("/report.html", self._guarded(self._report)),
                WebSocketRoute("/socket", self._socket),
            ],
            lifespan=self._running,
        )

    @contextlib.asynccontextmanager
    async def _running(self, app: Starlette) -> AsyncIterator[None]:
        del app
        self._events = asyncio.get_running_loop()
        self._loop.start()
        yield
        await asyncio.to_thread(self._loop.stop)

    def _told(self) -> None:
        """From the loop's thread: wakes the pages' senders."""
        if self._events is not None and not self._events.is_closed():
            with contextlib.suppress(RuntimeError):  # it has been closed since
                self._events.call_soon_threadsafe(self._wake)

    def _wake(self) -> None:
        for page in self._pages:
            page.set()

    def _refusal(self, connection: HTTPConnection) -> str:
        return self._gate.refusal(connection.headers, connection.query_params.get("token", ""))

    # -- pages ------------------------------------------------------------------------------------

    def _guarded(self, answer: Callable[[], Any]) -> Callable[[Request], Any]:
        async def checked(request: Request) -> Response:
            refusal = self._refusal(request)
            if refusal:
                return PlainTextResponse(refusal + "\n", 403, HEADERS)
            if self._answers >= MOST_ANSWERS:
                return PlainTextResponse("too much is asked for at once\n", 503, HEADERS)
            self._answers += 1
            try:
                response: Response = await answer()
            except DynastarError as error:
                response = PlainTextResponse(f"{error}\n", 409)
            finally:
                self._answers -= 1
            response.headers.update(HEADERS)
            return response

        return checked

    async def _page(self) -> Response:
        return HTMLResponse(self._html)

    async def _asked(self, function: Callable[..., Any], *arguments: Any) -> Any:
        return await asyncio.wrap_future(self._loop.call(function, *arguments))

    async def _scene(self) -> Response:
        async with self._saving:
            scenario = await self._asked(self._session.as_scenario)
            return _file(await asyncio.to_thread(scene_zip, scenario), "scene.zip")

    async def _episode(self) -> Response:
        async with self._saving:
            episode = await self._asked(self._session.as_episode)
            return _file(await asyncio.to_thread(episode_npz, episode), "episode.npz")

    async def _report(self) -> Response:
        async with self._saving:
            episode = await self._asked(self._session.as_episode)
            return HTMLResponse(await asyncio.to_thread(report_html, [episode]))

    # -- the socket -------------------------------------------------------------------------------

    async def _socket(self, socket: WebSocket) -> None:
        refusal = self._refusal(socket)
        if refusal:
            await _close(socket, POLICY, refusal)
            return
        try:
            await socket.accept()
        except GONE:
            return
        if len(self._pages) >= MOST_PAGES:
            await _close(socket, BUSY, f"{MOST_PAGES} pages are open, which are enough")
            return
        woken, told = asyncio.Event(), asyncio.Queue[str](MOST_PAGES)
        self._pages.add(woken)
        tasks = {
            asyncio.create_task(self._send(socket, woken, told)),
            asyncio.create_task(self._receive(socket, told)),
        }
        try:
            done, _ = await asyncio.wait(tasks, return_when=asyncio.FIRST_COMPLETED)
            code, reason = next(iter(done)).result()
        except GONE:
            code, reason = 0, ""
        except asyncio.CancelledError:  # the server ends, and this page has not closed in time
            code, reason = 0, ""
        finally:
            self._pages.discard(woken)
            for task in tasks:
                task.cancel()
            with contextlib.suppress(asyncio.CancelledError):
                await asyncio.gather(*tasks, return_exceptions=True)
        if code:
            await _close(socket, code, reason)

    async def _send(
        self, socket: WebSocket, woken: asyncio.Event, told: "asyncio.Queue[str]"
    ) -> tuple[int, str]:
        """Sends what is new, until the page does not take it; a slow page misses frames."""
        journal = have = 0
        while True:
            news = self._loop.news
            if news.journal != journal:
                journal, have = news.journal, 0
            entries = news.entries[have:]
            have += len(entries)
            parts = [*entries, *([news.frame] if news.frame else []), _clock(news)]
            while not told.empty():
                parts.append(told.get_nowait())
            try:
                await asyncio.wait_for(socket.send_text(f"[{','.join(parts)}]"), PATIENCE)
            except TimeoutError:
                return POLICY, f"nothing was taken for {PATIENCE:g} s"
            await woken.wait()
            woken.clear()

    async def _receive(self, socket: WebSocket, told: "asyncio.Queue[str]") -> tuple[int, str]:
        """Carries out what a page asks for, until it asks for too much."""
        allowance = Allowance()
        while True:
            received = await socket.receive()
            if received["type"] == "websocket.disconnect":
                return 0, ""
            text = received.get("text") or received.get("bytes") or ""
            if not allowance.take():
                return POLICY, "too many messages"
            try:
                await self._asked(self._session.take, read_message(text))
            except DynastarError as error:
                refused = json.dumps({"type": "refused", "reason": str(error)})
                with contextlib.suppress(asyncio.QueueFull):
                    told.put_nowait(refused)


async def _close(socket: WebSocket, code: int, reason: str) -> None:
    with contextlib.suppress(*GONE):
        await socket.close(code, reason)


def _clock(news: News) -> str:
    return json.dumps(
        {
            "type": "loop",
            "ticks": news.ticks,
            "rate": round(news.rate, 2),
            "paused": news.paused,
            "halted": news.halted,
        }
    )


def _file(data: bytes, name: str) -> Response:
    disposition = {"Content-Disposition": f'attachment; filename="{name}"'}
    return Response(data, media_type="application/octet-stream", headers=disposition)


def scene_zip(scenario: Any) -> bytes:
    """A scenario file with its maps, zipped."""
    packed = streams.BytesIO()
    with tempfile.TemporaryDirectory() as folder:
        save_scenario(scenario, folder)
        with zipfile.ZipFile(packed, "w", zipfile.ZIP_DEFLATED) as archive:
            for file in sorted(Path(folder).iterdir()):
                archive.write(file, file.name)
    return packed.getvalue()


def episode_npz(episode: Any) -> bytes:
    """An episode's file."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "episode.npz")
        io.save_episode(episode, path)
        return path.read_bytes()


def serve(session: Session, host: str, port: int, ready: Callable[[str], None]) -> None:
    """Serves a session until it is interrupted; ``ready`` is told the address. Port 0: any free one.

    Raises InputError for an address that is in use or not of this machine.
    """
    listening = _listen(host, port)
    gate = Gate(host, listening.getsockname()[1])
    name = socket.gethostname() if host in EVERYWHERE else host
    shown = f"[{name}]" if ":" in name else name
    query = f"/?token={gate.token}" if gate.token else "/"
    config = uvicorn.Config(
        Playground(session, gate).app,
        log_level="error",
        access_log=False,
        server_header=False,
        http=Connection,
        ws="websockets-sansio",
        ws_max_size=MOST_BYTES,
        ws_max_queue=8,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=2,
    )
    ready(f"http://{shown}:{gate.port}{query}")
    with contextlib.suppress(KeyboardInterrupt):
        uvicorn.Server(config).run(sockets=[listening])


def _listen(host: str, port: int) -> socket.socket:
    try:
        family = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0][0]
        listening = socket.socket(family, socket.SOCK_STREAM)
        listening.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listening.bind((host, port))
        listening.listen(MOST_WAITING)  # from now on connections wait until they are served
        return listening
    except (OSError, UnicodeError) as error:
        if isinstance(error, OSError) and error.errno == errno.EADDRINUSE:
            raise InputError(f"port {port} is in use; try another --port") from None
        reason = getattr(error, "strerror", None) or error
        raise InputError(f"{host}:{port} is not an address to serve at: {reason}") from None

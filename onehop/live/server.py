"""The live page's server: page, scripts and feeds, in a thread of its own beside whatever it shows."""

import asyncio
import contextlib
import os
import threading
import time
from collections.abc import Awaitable, Callable, Sequence
from importlib.resources import files
from typing import Any, Self

import uvicorn
from starlette.applications import Starlette
from starlette.requests import Request
from starlette.responses import PlainTextResponse, Response
from starlette.routing import Route, WebSocketRoute
from starlette.types import ASGIApp, Receive, Scope, Send
from starlette.websockets import WebSocket

from onehop.contracts.printable import printable
from onehop.live.first_difference import FirstDifference
from onehop.live.guard import HEADERS, Address, Guard, bind, content_policy
from onehop.live.hand import Hand
from onehop.live.requests import LONGEST_BYTES
from onehop.live.source import Source
from onehop.live.viewer import Viewer
from onehop.live.watchers import Watchers
from onehop.node import startup

NICE = 5
"""Of a log, or of a mission that leaves processor time by itself, since it goes by the wall clock."""

CLOSE_S = 1
"""How long open connections may take to end [s]."""

_MEDIA = {".html": "text/html", ".css": "text/css", ".js": "text/javascript", ".svg": "image/svg+xml"}


class LiveServer:
    """Serves the page while it is entered. hand: on the mission that runs, None for logs.

    Raises InputError when the address cannot be listened on.
    """

    def __init__(self, sources: Sequence[Source], address: Address, hand: Hand | None = None) -> None:
        self._sources = sources
        self._hand = hand
        self._socket = bind(address)
        self._guard = Guard(address.host, self._socket.getsockname()[1])
        self._difference = _difference(sources)
        self._watchers: Watchers[Viewer] = Watchers()
        self._files = _page_files()
        self._server = uvicorn.Server(
            uvicorn.Config(
                app(self._guard, self._routes()),
                ws="websockets-sansio",
                http="h11",
                loop="asyncio",
                lifespan="off",
                log_config=None,
                log_level="critical",
                access_log=False,
                server_header=False,
                ws_max_size=LONGEST_BYTES,
                ws_per_message_deflate=False,
                timeout_graceful_shutdown=CLOSE_S,
            )
        )
        self._thread = threading.Thread(target=self._run, name="live page", daemon=True)

    @property
    def url(self) -> str:
        """The address that people open."""
        return self._guard.url

    @property
    def viewers(self) -> int:
        """How many look on."""
        return len(self._watchers)

    def __enter__(self) -> Self:
        self._thread.start()
        while not self._server.started and self._thread.is_alive():
            time.sleep(0.005)
        return self

    def __exit__(self, *_: object) -> None:
        self._server.should_exit = True
        self._thread.join()
        self._socket.close()

    def _run(self) -> None:
        if self._hand is not None and self._hand.is_paced:
            startup.give_way()
        elif hasattr(os, "setpriority"):
            with contextlib.suppress(OSError):  # on Linux it is of this thread alone
                os.setpriority(os.PRIO_PROCESS, threading.get_native_id(), NICE)
        asyncio.run(self._serve())

    async def _serve(self) -> None:
        loop = asyncio.get_running_loop()

        def changed() -> None:
            with contextlib.suppress(RuntimeError):  # the loop has ended
                loop.call_soon_threadsafe(self._watchers.stir)

        for source in self._sources:
            source.start(changed)
        if self._difference is not None:
            self._difference.start(changed)
        try:
            await self._server.serve(sockets=[self._socket])
        finally:
            for source in self._sources:
                source.close()

    def _routes(self) -> list[Route | WebSocketRoute]:
        return [
            Route("/", self._page),
            Route("/static/{name}", self._static),
            WebSocketRoute("/feed/{number:int}", self._feed),
        ]

    async def _page(self, request: Request) -> Response:
        if not self._guard.knows_token(request.query_params.get("token")):
            return PlainTextResponse(
                "The address needs its token: open the one that was printed.\n", 403
            )
        return self._file("index.html")

    async def _static(self, request: Request) -> Response:
        name = request.path_params["name"]
        return self._file(name) if name in self._files else PlainTextResponse("no such file\n", 404)

    def _file(self, name: str) -> Response:
        return Response(self._files[name], media_type=_MEDIA["." + name.rpartition(".")[2]])

    async def _feed(self, socket: WebSocket) -> None:
        number = socket.path_params["number"]
        own = self._guard.is_own_page(socket.headers.get("origin"), socket.headers.get("host"))
        known = self._guard.knows_token(socket.query_params.get("token"))
        if not own or not known or number >= len(self._sources):
            await socket.close()  # before it is accepted: the answer is 403
            return
        await socket.accept()
        source = self._sources[number]
        name = printable(str(source.path))
        await socket.send_json({"kind": "hello", "logs": len(self._sources), "name": name})
        await Viewer(socket, source, self._watchers, self._hand, self._difference).serve()


def _difference(sources: Sequence[Source]) -> FirstDifference | None:
    """Where two logs begin to differ; None of one log, or of one that is not there yet."""
    logs = [source.log for source in sources if source.log is not None]
    return FirstDifference(*logs) if len(logs) == 2 else None


def app(guard: Guard, routes: list[Route | WebSocketRoute]) -> ASGIApp:
    """The application, behind its guard: every request has to name this machine."""
    inner = Starlette(routes=routes)

    async def guarded(scope: Scope, receive: Receive, send: Send) -> None:
        host = dict(scope.get("headers", ())).get(b"host", b"").decode("latin-1")
        if scope["type"] == "http" and not guard.knows_host(host):
            await PlainTextResponse("this is not its name\n", 421)(scope, receive, send)
            return
        await inner(scope, receive, _with_headers(send, host))

    return guarded


def _with_headers(send: Send, host: str) -> Callable[[Any], Awaitable[None]]:
    async def sending(message: Any) -> None:
        if message["type"] == "http.response.start":
            own = {**HEADERS, "Content-Security-Policy": content_policy(host)}
            message["headers"] += [(name.encode(), value.encode()) for name, value in own.items()]
        await send(message)

    return sending


def _page_files() -> dict[str, bytes]:
    folder = files("onehop.live") / "page"
    return {one.name: one.read_bytes() for one in folder.iterdir() if one.is_file()}

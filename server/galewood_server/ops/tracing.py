"""What is known of every request: an id for its log lines, its status, how long it took."""

from __future__ import annotations

import logging
import re
import secrets
import time

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.contextvars import bound_contextvars

from galewood_server.ops.metrics import Metrics

log = logging.getLogger("galewood.requests")
HEADER = "x-request-id"
_GIVEN = re.compile(r"[A-Za-z0-9._:-]{1,128}")
QUIET = ("/healthz", "/api/health", "/metrics", "/assets/")


def request_id(headers: Headers) -> str:
    """The id that a proxy or a client gave, if it is a plain short word; else a new one."""
    given = headers.get(HEADER, "")
    return given if _GIVEN.fullmatch(given) else secrets.token_hex(8)


class Tracing:
    """ASGI middleware: the id in the context, in the answer and in the logs; the request in the metrics."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request or a socket on, watched."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        name = request_id(Headers(scope=scope))
        status, began_s = 0, time.perf_counter()

        async def answer(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)[HEADER] = name
            await send(message)

        with bound_contextvars(request_id=name):
            try:
                await self._app(scope, receive, answer)
            finally:
                if scope["type"] == "http":
                    self._note(scope, status or 499, time.perf_counter() - began_s)

    def _note(self, scope: Scope, status: int, seconds: float) -> None:
        """499, as proxies say: the client left before there was an answer."""
        self._metrics.request(scope["method"], route_of(scope), status, seconds)
        client = scope.get("client") or ("",)
        level = logging.DEBUG if scope["path"].startswith(QUIET) else logging.INFO
        what = {
            "method": scope["method"],
            "path": scope["path"][:200],
            "status": status,
            "ms": round(seconds * 1000, 1),
            "client": client[0],
        }
        log.log(level, "request", extra=what)


def route_of(scope: Scope) -> str:
    """The route's pattern, so that metrics count routes and not every path that was ever tried."""
    route = scope.get("route")
    return str(getattr(route, "path", "")) or ("page" if scope.get("endpoint") else "none")

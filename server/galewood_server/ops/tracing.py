"""Request tracing: request id, log line and metrics of every request."""

from __future__ import annotations

import logging
import re
import secrets
import time
from http import HTTPStatus

from starlette.datastructures import Headers, MutableHeaders
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from structlog.contextvars import bound_contextvars

from galewood_server.ops.metrics import Metrics

REQUEST_LOGGER = "galewood.requests"
log = logging.getLogger(REQUEST_LOGGER)
REQUEST_ID_HEADER = "x-request-id"
_VALID_ID = re.compile(r"[A-Za-z0-9._:-]{1,128}")
METHODS = frozenset({"GET", "HEAD", "POST", "PUT", "PATCH", "DELETE", "OPTIONS"})
QUIET_PATHS = ("/healthz", "/api/health", "/metrics", "/assets/")


def request_id(headers: Headers) -> str:
    """The X-Request-ID header if it is valid, otherwise a new id."""
    given = headers.get(REQUEST_ID_HEADER, "")
    return given if _VALID_ID.fullmatch(given) else secrets.token_hex(8)


class Tracing:
    """ASGI middleware that adds a request id to logs and response and records the request in the metrics."""

    def __init__(self, app: ASGIApp, metrics: Metrics) -> None:
        self._app = app
        self._metrics = metrics

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request or WebSocket with a request id in the log context."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        name = request_id(Headers(scope=scope))
        status, began_s = 0, time.perf_counter()

        async def send_response(message: Message) -> None:
            nonlocal status
            if message["type"] == "http.response.start":
                status = message["status"]
                MutableHeaders(scope=message)[REQUEST_ID_HEADER] = name
            await send(message)

        with bound_contextvars(request_id=name):
            try:
                await self._app(scope, receive, send_response)
            finally:
                if scope["type"] == "http":
                    self._record(scope, status or 499, time.perf_counter() - began_s)

    def _record(self, scope: Scope, status: int, seconds: float) -> None:
        """Log and count a request. Status 499: the client disconnected before the response."""
        self._metrics.request(method_of(scope), route_of(scope), status, seconds)
        client = scope.get("client") or ("",)
        # refusals of one address have no end: they are counted, and access control names the address
        quiet = status == HTTPStatus.TOO_MANY_REQUESTS or scope["path"].startswith(QUIET_PATHS)
        level = logging.DEBUG if quiet else logging.INFO
        fields = {
            "method": scope["method"][:20],
            "path": scope["path"][:200],
            "status": status,
            "ms": round(seconds * 1000, 1),
            "client": client[0],
        }
        log.log(level, "request", extra=fields)


def method_of(scope: Scope) -> str:
    """The method, or "other": clients invent methods, and metric labels must stay bounded."""
    return scope["method"] if scope["method"] in METHODS else "other"


def route_of(scope: Scope) -> str:
    """The path pattern of the route, so that the number of metric labels stays bounded."""
    route = scope.get("route")
    return str(getattr(route, "path", "")) or ("page" if scope.get("endpoint") else "none")

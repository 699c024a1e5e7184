"""Access from pages of other origins (CORS): the operator lists them in GALEWOOD_ALLOWED_ORIGINS."""

from __future__ import annotations

from collections.abc import Sequence

from fastapi import FastAPI
from starlette.datastructures import MutableHeaders
from starlette.middleware.cors import CORSMiddleware
from starlette.types import ASGIApp, Message, Receive, Scope, Send

METHODS = ("GET", "HEAD", "POST", "PATCH", "DELETE")
REQUEST_HEADERS = ("Authorization", "Content-Type", "If-None-Match", "Last-Event-ID", "Range")
RESPONSE_HEADERS = (
    "Accept-Ranges", "Content-Range", "ETag", "Location", "Retry-After", "X-Request-ID",
)  # fmt: skip
PREFLIGHT_S = 86_400


def allow_cross_origin(app: FastAPI, origins: Sequence[str]) -> None:
    """Answer cross-origin requests of these origins. Without any, browsers refuse all such requests."""
    if not origins:
        return
    app.add_middleware(
        CORSMiddleware,
        allow_origins=list(origins),
        allow_methods=METHODS,
        allow_headers=REQUEST_HEADERS,
        expose_headers=RESPONSE_HEADERS,
        max_age=PREFLIGHT_S,
    )
    app.add_middleware(VaryByOrigin)


class VaryByOrigin:
    """ASGI middleware: tells caches that responses differ by origin, also those to requests without one."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request and complete the Vary header of its response."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return

        async def send_response(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                if "origin" not in headers.get("vary", "").lower():
                    headers.add_vary_header("Origin")
            await send(message)

        await self._app(scope, receive, send_response)

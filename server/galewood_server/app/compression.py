"""Compression of JSON responses; files have compressed copies of their own (storage/encodings.py)."""

from __future__ import annotations

from starlette.datastructures import Headers, MutableHeaders
from starlette.middleware.gzip import GZipMiddleware
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from galewood_server.http import COMPRESSED_BYTES, GZIP_LEVEL

FILES = (
    "/api/tables/",
    "/api/records/",
    "/api/compliances/",
    "/api/meshes/",
    "/api/light-meshes/",
    "/api/convert",
    "/api/stand-risk",
)
"""Paths of files, which are served in ranges or compressed already, or are large and come in one piece."""


class CompressedJson:
    """ASGI middleware that compresses JSON responses of the API with gzip where the client accepts it."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app
        self._compressing = GZipMiddleware(WeakTags(app), COMPRESSED_BYTES, GZIP_LEVEL)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request, compressing its response if it is JSON of the API."""
        is_api = scope["type"] == "http" and scope["path"].startswith(("/api/", "/openapi.json"))
        compresses = is_api and not scope["path"].startswith(FILES)
        await (self._compressing if compresses else self._app)(scope, receive, send)


class WeakTags:
    """Makes ETags weak where a response may be compressed: its bytes differ by coding (RFC 9110, 8.8.3)."""

    def __init__(self, app: ASGIApp) -> None:
        self._app = app

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Handle a request and weaken the ETag of its response."""
        if "gzip" not in Headers(scope=scope).get("accept-encoding", ""):
            await self._app(scope, receive, send)
            return

        async def send_response(message: Message) -> None:
            if message["type"] == "http.response.start":
                headers = MutableHeaders(scope=message)
                if headers.get("etag", "").startswith('"'):
                    headers["ETag"] = f"W/{headers['etag']}"
            await send(message)

        await self._app(scope, receive, send_response)

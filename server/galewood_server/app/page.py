"""The web page: the built files of web/, or instructions how to build them."""

from __future__ import annotations

import mimetypes
import os
from pathlib import Path

from fastapi.responses import FileResponse, HTMLResponse, Response
from starlette.datastructures import Headers
from starlette.exceptions import HTTPException
from starlette.staticfiles import NotModifiedResponse, StaticFiles
from starlette.types import Receive, Scope, Send

from galewood_server.http import IMMUTABLE_CACHE
from galewood_server.storage import preferred_coding

NOT_BUILT = """<!doctype html><html lang="en"><meta charset="utf-8"><title>Galewood</title>
<body style="font: 16px/1.5 system-ui; max-width: 40rem; margin: 4rem auto; padding: 0 1rem">
<h1>The page has not been built</h1>
<p>The server is running, but <code>web/dist</code> has no page. Build it, then reload:</p>
<pre>make build</pre>
<p>The REST API is documented at <a href="/docs">/docs</a>.</p></body></html>"""
HEADERS = {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "same-origin"}
SUFFIXES = {"br": ".br", "gzip": ".gz"}
"""Codings of the copies that the build writes beside the page's files (web/scripts/precompress.ts)."""


class Page(StaticFiles):
    """Static files, looked up on each request, so that a page built later needs no restart.

    Each has one address and nothing is redirected: Starlette's redirects to folders (`html=True`) repeat the
    host and the path that the client sent, so both could lead elsewhere.
    """

    def __init__(self, folder: Path) -> None:
        super().__init__(directory=folder, check_dir=False)
        self._folder = folder

    async def check_config(self) -> None:
        """Skip the check: a missing folder is handled by `get_response`."""

    async def get_response(self, path: str, scope: Scope) -> Response:
        """A file of the page; HTTPException 404 if there is none.

        Files with a hash in their name are immutable, others are revalidated.
        """
        if "//" in scope["path"]:
            raise HTTPException(404)
        if scope["path"] == "/":
            path = "index.html"
        if path == "index.html" and not (self._folder / "index.html").is_file():
            return HTMLResponse(NOT_BUILT, 503, HEADERS)
        response = await super().get_response(path, scope)
        response.headers["Cache-Control"] = IMMUTABLE_CACHE if path.startswith("assets/") else "no-cache"
        response.headers.update(HEADERS)
        return response

    def file_response(
        self,
        full_path: str | os.PathLike[str],
        stat_result: os.stat_result,
        scope: Scope,
        status_code: int = 200,
    ) -> Response:
        """A file, or its compressed copy where the client accepts one; each has its own ETag."""
        asked = Headers(scope=scope)
        copies = [name for name, suffix in SUFFIXES.items() if Path(f"{full_path}{suffix}").is_file()]
        coding = preferred_coding(asked.get("accept-encoding", ""), copies)
        sent = f"{full_path}{SUFFIXES[coding]}" if coding else full_path
        response = FileResponse(
            sent,
            status_code=status_code,
            stat_result=Path(sent).stat() if coding else stat_result,
            media_type=mimetypes.guess_type(full_path)[0] or "text/plain",
        )
        if copies:
            response.headers["Vary"] = "Accept-Encoding"
        if coding:
            response.headers["Content-Encoding"] = coding
        if self.is_not_modified(response.headers, asked):
            return NotModifiedResponse(response.headers)
        return response

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Serve HTTP requests; reject WebSockets to unknown paths."""
        if scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
            return
        await super().__call__(scope, receive, send)

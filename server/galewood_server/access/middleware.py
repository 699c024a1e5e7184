"""What every request passes before it reaches a route: rates, keys, a watch on bodies that come slowly."""

from __future__ import annotations

import asyncio
import logging
import time

from fastapi import HTTPException
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from galewood_server.access.keys import check_writer, is_write
from galewood_server.access.rates import Rates
from galewood_server.http import ProblemError, problem_of
from galewood_server.ops import Metrics
from galewood_server.settings import Settings

log = logging.getLogger("galewood.errors")
GUARDED = ("/api/", "/docs", "/openapi.json")
ALWAYS = "/api/health"  # whoever watches over the service is never turned away
GRACE_S = 10.0


class AccessControl:
    """ASGI middleware; whatever goes wrong behind it becomes a problem as well."""

    def __init__(self, app: ASGIApp, settings: Settings, metrics: Metrics) -> None:
        self._app = app
        self._settings = settings
        self._metrics = metrics
        self._rates = Rates(settings)

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Let a request in, or answer it with a problem."""
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        begun = False

        async def answer(message: Message) -> None:
            nonlocal begun
            begun = begun or message["type"] == "http.response.start"
            await send(message)

        try:
            await self._admit(scope)
            await self._app(scope, self._watched(scope, receive), answer)
        except Exception as error:
            if begun:
                raise
            if not isinstance(error, ProblemError):
                log.exception("%s %s failed", scope["method"], scope["path"])
            await problem_of(error).response(getattr(error, "headers", None))(scope, receive, send)

    async def _admit(self, scope: Scope) -> None:
        path = scope["path"]
        if not path.startswith(GUARDED) or path.startswith(ALWAYS):
            return
        try:
            await self._check(scope, (scope.get("client") or ("",))[0])
        except ProblemError as error:
            self._metrics.refused.labels(error.problem.code).inc()
            raise

    async def _check(self, scope: Scope, address: str) -> None:
        if not is_write(scope):
            await self._rates.count("read", address)
            return
        await self._rates.check("wrong-key", address)
        try:
            check_writer(scope, self._settings)
        except ProblemError as error:
            if error.problem.status == 401:
                await self._rates.count("wrong-key", address)
            raise
        await self._rates.count("write", address)

    def _watched(self, scope: Scope, receive: Receive) -> Receive:
        """A body must keep coming, and on average at a least rate, or the request is over (slow loris)."""
        if scope["method"] in ("GET", "HEAD"):
            return receive
        watch = BodyWatch(self._settings)

        async def next_piece() -> Message:
            if watch.complete:
                return await receive()
            try:
                async with asyncio.timeout(self._settings.body_stall_s):
                    message = await receive()
            except TimeoutError:
                raise too_slow() from None
            watch.see(message)
            return message

        return next_piece


class BodyWatch:
    """How much of a body came, and since when."""

    def __init__(self, settings: Settings) -> None:
        self._least_rate = settings.body_bytes_per_s
        self._began_s = time.monotonic()
        self._received = 0
        self.complete = False

    def see(self, message: Message) -> None:
        """Count a piece; HTTPException 408 if the body is on average too slow."""
        self._received += len(message.get("body", b""))
        self.complete = message["type"] != "http.request" or not message.get("more_body", False)
        spent_s = time.monotonic() - self._began_s
        if not self.complete and spent_s > GRACE_S and self._received < self._least_rate * spent_s:
            raise too_slow()


def too_slow() -> HTTPException:
    """408. FastAPI passes its own exceptions on from where it reads a body, and no others."""
    return HTTPException(408, "The request's body came too slowly", headers={"Connection": "close"})

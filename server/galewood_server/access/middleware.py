"""Access control middleware: host names, rate limits, API keys and a minimum rate for request bodies."""

from __future__ import annotations

import asyncio
import logging
import time
from contextlib import AbstractContextManager, nullcontext
from http import HTTPStatus

from fastapi import HTTPException
from starlette.datastructures import Headers
from starlette.requests import ClientDisconnect
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from galewood_server.access.keys import check_writer, is_write
from galewood_server.access.open_connections import ADDRESS_SHARE, count_open, limited_by_descriptors
from galewood_server.access.origins import check_host, check_origin
from galewood_server.access.rates import RateLimits, client_address, client_key
from galewood_server.http import Problem, ProblemError, problem_from
from galewood_server.ops import Metrics
from galewood_server.settings import Settings

log = logging.getLogger("galewood.errors")
HEALTH_CHECKS = frozenset({"/api/health", "/api/health/ready", "/healthz"})
"""Monitoring succeeds also while other requests of its address are refused: it has a limit of its own."""
GRACE_S = 10.0


class AccessControl:
    """ASGI middleware that rejects unauthorised requests and converts uncaught exceptions to problems."""

    def __init__(self, app: ASGIApp, settings: Settings, metrics: Metrics) -> None:
        self._app = app
        self._settings = settings
        self._metrics = metrics
        self._rates = RateLimits(settings)
        self._in_progress: dict[str, int] = {}

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a request on or answer it with a problem."""
        if scope["type"] == "websocket":
            await self._open_socket(scope, receive, send)
            return
        if scope["type"] != "http":
            await self._app(scope, receive, send)
            return
        started = replaced = False
        body = _Body(scope, receive, self._settings)

        async def send_response(message: Message) -> None:
            nonlocal started, replaced
            if body.abandoned:  # nobody is there to read an answer; without one, the request counts as 499
                return
            if message["type"] == "http.response.start" and is_plain_413(message):
                started = replaced = True
                await problem_from(HTTPException(413)).response()(scope, receive, send)
            if not replaced:
                started = started or message["type"] == "http.response.start"
                await send(message)

        try:
            await self._check_access(scope)
            check_text(scope)
            with self._in_progress_of(scope):
                await self._app(scope, body.receive, send_response)
        except Exception as error:
            if body.abandoned and isinstance(error, ClientDisconnect):
                return
            if started:
                raise
            problem = problem_from(error)
            if not isinstance(error, ProblemError):
                log_failure(scope, problem, error)
            await problem.response(getattr(error, "headers", None))(scope, receive, send)

    async def _open_socket(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass a WebSocket on. Opening one counts as a read: it costs more than most requests."""
        try:
            await self._check_access(scope)
        except ProblemError as error:
            await error.problem.response(error.headers)(scope, receive, send)
        else:
            await self._app(scope, receive, send)

    def _in_progress_of(self, scope: Scope) -> AbstractContextManager[None]:
        """Count a request of an address while it is in progress. ProblemError 429 if it has too many."""
        if scope["path"] in HEALTH_CHECKS:
            return nullcontext()
        address = client_key(scope)
        most = limited_by_descriptors(self._settings.requests_per_address, ADDRESS_SHARE)
        if self._in_progress.get(address, 0) >= most:
            self._metrics.refused.labels("too-many-open-requests").inc()
            raise ProblemError(
                429,
                "too-many-open-requests",
                "Too many requests from this address are in progress",
                detail=f"The limit is {most} at a time.",
                hint="Wait until some of them are answered.",
                headers={"Retry-After": "5"},
            )
        return count_open(self._in_progress, address)

    async def _check_access(self, scope: Scope) -> None:
        try:
            await self._check(scope, client_address(scope))
        except ProblemError as error:
            self._metrics.refused.labels(error.problem.code).inc()
            raise

    async def _check(self, scope: Scope, address: str) -> None:
        headers = Headers(scope=scope)
        check_host(headers, self._settings)
        if scope["type"] == "websocket":
            check_origin(headers, self._settings)
        if not is_write(scope):
            await self._rates.count("health" if scope["path"] in HEALTH_CHECKS else "read", address)
            return
        try:
            check_writer(scope, self._settings)
        except ProblemError as error:
            if error.problem.status == 401:  # only failures count: others at this address may have the key
                await self._rates.count("wrong-key", address)
            raise
        await self._rates.count("write", address)


def log_failure(scope: Scope, problem: Problem, error: Exception) -> None:
    """Log an error: with its traceback if it is unexpected, otherwise with the kind of problem it is."""
    if problem.status == HTTPStatus.INTERNAL_SERVER_ERROR:
        log.error("%s %s failed", scope["method"], scope["path"], exc_info=error)
    else:
        log.warning("%s %s failed: %s (%s)", scope["method"], scope["path"], problem.title, error)


def is_plain_413(message: Message) -> bool:
    """Whether a response begins that Starlette's limit of the body size sends, in plain text."""
    content_type = Headers(raw=message["headers"]).get("content-type", "")
    return message["status"] == 413 and content_type.startswith("text/plain")


def check_text(scope: Scope) -> None:
    """ProblemError 422 for NUL in the path or query, which PostgreSQL and file systems refuse with errors."""
    if "\0" in scope["path"] or b"%00" in scope.get("query_string", b""):
        raise ProblemError(
            422,
            "invalid-request",
            "The request has invalid fields",
            detail="The address contains a NUL character (%00).",
            hint="See /docs for the fields and their allowed values.",
        )


class _Body:
    """The body of a request as it arrives. A stalled or too slow one ends the request (slow-loris attack)."""

    def __init__(self, scope: Scope, receive: Receive, settings: Settings) -> None:
        self._receive = receive
        self._stall_s = settings.body_stall_s
        self._monitor = None if scope["method"] in ("GET", "HEAD") else BodyRateMonitor(settings)
        self.abandoned = False
        """Whether the client of a request with a body has left; it is noticed by who waits for it."""

    async def receive(self) -> Message:
        """The next part of the body, or what comes after it. HTTPException 408."""
        if self._monitor is None:
            return await self._receive()
        if self._monitor.complete:
            message = await self._receive()
            self.abandoned = message["type"] == "http.disconnect"
            return message
        try:
            async with asyncio.timeout(self._stall_s):
                message = await self._receive()
        except TimeoutError:
            raise body_too_slow() from None
        self.abandoned = message["type"] == "http.disconnect"
        self._monitor.add(message)
        return message


class BodyRateMonitor:
    """Measures the average rate at which a request body arrives."""

    def __init__(self, settings: Settings) -> None:
        self._min_rate = settings.body_bytes_per_s
        self._began_s = time.monotonic()
        self._received = 0
        self.complete = False

    def add(self, message: Message) -> None:
        """Count a part of the body. HTTPException 408 if the average rate is too low."""
        self._received += len(message.get("body", b""))
        self.complete = message["type"] != "http.request" or not message.get("more_body", False)
        spent_s = time.monotonic() - self._began_s
        if not self.complete and spent_s > GRACE_S and self._received < self._min_rate * spent_s:
            raise body_too_slow()


def body_too_slow() -> HTTPException:
    """408 as an HTTPException: FastAPI re-raises only these from its body parser."""
    return HTTPException(408, "The request body arrived too slowly", headers={"Connection": "close"})

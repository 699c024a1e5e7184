"""uvicorn's HTTP protocol with time limits for a request's headers and for a client that reads nothing, and
with a ceiling of open connections.
"""

from __future__ import annotations

import asyncio
import logging
import socket
from http import HTTPStatus
from typing import Any

import uvicorn
from uvicorn.protocols.http.h11_impl import H11Protocol

from galewood_server.access import OpenConnections
from galewood_server.http import Problem

log = logging.getLogger("galewood")
STOPPING_PROBLEM = Problem(
    status=503,
    code="server-stopping",
    title="The server is being stopped",
    detail="The request was not finished in time.",
    hint="Try again in a minute.",
)
FULL_PROBLEM = Problem(
    status=503,
    code="too-many-connections",
    title="Too many open connections",
    detail="The server has reached its limit of connections with requests in progress.",
    hint="Try again in a few seconds.",
    retry_after_s=5,
)
ACCEPTED_AT_ONCE, LISTEN_BACKLOG = 16, 2048


class Server(uvicorn.Server):
    """Accepts few connections at a time, so that they are counted before descriptors run out.

    asyncio accepts as many connections in a row as the backlog has places. More of them wait in the kernel.
    """

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Listen, with a backlog in the kernel that is longer than what is accepted at once."""
        await super().startup(sockets)
        for listener in (one for server in self.servers for one in server.sockets):
            with listener.dup() as same:
                same.listen(LISTEN_BACKLOG)


def protocol_with_limits(
    header_s: float, write_stall_s: float, connections: OpenConnections
) -> type[H11Protocol]:
    """A protocol class that closes connections whose request headers are incomplete after `header_s` seconds,
    those whose client has not made room for more of a response for `write_stall_s` seconds, and those for
    which there is no room among `connections`.

    uvicorn limits only the time between requests: headers sent one byte per minute, or a response that is
    never read, would hold a connection and its file forever.
    """

    class LimitedProtocol(H11Protocol):
        _head_timer: asyncio.TimerHandle | None = None
        _write_timer: asyncio.TimerHandle | None = None
        _stopping = False

        def __init__(self, *arguments: Any, **named: Any) -> None:
            super().__init__(*arguments, **named)
            self._served, self.app = self.app, self._serve

        def shutdown(self) -> None:
            self._stopping = True
            super().shutdown()

        async def _serve(self, scope: Any, receive: Any, send: Any) -> None:
            """Serve a request. What the end of the server breaks off is no error, and gets no traceback."""
            cycle: Any = self.cycle
            try:
                await self._served(scope, receive, send)
            except asyncio.CancelledError:  # uvicorn's, for requests that outlast the time to stop
                log.info("%s %s was aborted: the server is stopping", scope["method"], scope["path"][:200])
                if not cycle.response_started and not cycle.disconnected:
                    await STOPPING_PROBLEM.response()(scope, receive, send)
            if self._stopping and not cycle.response_complete:
                cycle.disconnected = True
                self.transport.abort()

        def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
            super().connection_made(transport)
            if connections.admit(self, self._address, transport.get_extra_info("socket").fileno()):
                self._start_timer()
            else:
                transport.write(raw_response(FULL_PROBLEM))
                transport.close()

        def data_received(self, data: bytes) -> None:
            if self._head_timer is None and not self._is_busy():
                self._start_timer()
            super().data_received(data)
            if self._is_busy():
                connections.works(self)
                if self._head_timer:
                    self._head_timer.cancel()
                    self._head_timer = None

        def on_response_complete(self) -> None:
            connections.waits(self, self._address)
            super().on_response_complete()
            if self._is_busy():  # with a request that was sent before this one was answered
                connections.works(self)

        def handle_websocket_upgrade(self, event: Any) -> None:
            connections.closed(self)
            super().handle_websocket_upgrade(event)

        def close_waiting(self) -> None:
            self.transport.close()

        @property
        def _address(self) -> str:
            return self.client[0] if self.client else ""

        def connection_lost(self, exc: Exception | None) -> None:
            connections.closed(self)
            for timer in (self._head_timer, self._write_timer):
                if timer:
                    timer.cancel()
            super().connection_lost(exc)

        def pause_writing(self) -> None:
            # aborted, because a transport that is closed waits for its client to read the rest
            self._write_timer = self.loop.call_later(write_stall_s, self.transport.abort)
            super().pause_writing()

        def resume_writing(self) -> None:
            if self._write_timer:
                self._write_timer.cancel()
            super().resume_writing()

        def _start_timer(self) -> None:
            self._head_timer = self.loop.call_later(header_s, self._on_timeout)

        def _is_busy(self) -> bool:
            cycle: Any = self.cycle
            return cycle is not None and not cycle.response_complete

        def _on_timeout(self) -> None:
            self._head_timer = None
            upgraded = self.transport.get_protocol() is not self
            if not upgraded and not self._is_busy() and not self.transport.is_closing():
                self.transport.close()

    return LimitedProtocol


def raw_response(problem: Problem) -> bytes:
    """A problem as bytes, for a connection on which no request was read."""
    response = problem.response({"Connection": "close"})
    lines = [f"HTTP/1.1 {problem.status} {HTTPStatus(problem.status).phrase}".encode()]
    lines += [name + b": " + value for name, value in response.raw_headers]
    return b"\r\n".join([*lines, b"", bytes(response.body)])

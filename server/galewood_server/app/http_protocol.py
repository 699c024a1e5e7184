"""uvicorn's HTTP protocol with time limits for a request's headers and for a client that reads nothing."""

from __future__ import annotations

import asyncio
import logging
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol

from galewood_server.http import Problem

log = logging.getLogger("galewood")
STOPPING = Problem(
    status=503,
    code="server-stopping",
    title="The server is being stopped",
    detail="The request was not finished in time.",
    hint="Try again in a minute.",
)


def protocol_with_limit(header_s: float, write_stall_s: float) -> type[H11Protocol]:
    """A protocol class that closes connections whose request headers are incomplete after `header_s` seconds,
    and those whose client has not made room for more of a response for `write_stall_s` seconds.

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
                log.info("%s %s was broken off: the server stops", scope["method"], scope["path"][:200])
                if not cycle.response_started and not cycle.disconnected:
                    await STOPPING.response()(scope, receive, send)
            if self._stopping and not cycle.response_complete:
                cycle.disconnected = True
                self.transport.abort()

        def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
            super().connection_made(transport)
            self._start_timer()

        def data_received(self, data: bytes) -> None:
            if self._head_timer is None and not self._is_busy():
                self._start_timer()
            super().data_received(data)
            if self._is_busy() and self._head_timer:
                self._head_timer.cancel()
                self._head_timer = None

        def connection_lost(self, exc: Exception | None) -> None:
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

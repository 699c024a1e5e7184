"""uvicorn's HTTP protocol with a time limit for receiving a request's headers."""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol


def protocol_with_limit(header_s: float) -> type[H11Protocol]:
    """A protocol class that closes connections whose request headers are incomplete after `header_s` seconds.

    uvicorn limits only the time between requests: headers sent one byte per minute would hold a connection
    forever.
    """

    class LimitedProtocol(H11Protocol):
        _head_timer: asyncio.TimerHandle | None = None

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
            if self._head_timer:
                self._head_timer.cancel()
            super().connection_lost(exc)

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

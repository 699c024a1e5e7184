"""uvicorn's HTTP protocol with a limit on how long a request's head may take to arrive."""

from __future__ import annotations

import asyncio
from typing import Any

from uvicorn.protocols.http.h11_impl import H11Protocol


def protocol_with_limit(header_s: float) -> type[H11Protocol]:
    """A protocol that closes connections which open and then say nothing whole for `header_s` seconds.

    uvicorn limits the time between requests only: a head that comes a byte a minute would hold its connection
    for ever.
    """

    class LimitedProtocol(H11Protocol):
        _head_timer: asyncio.TimerHandle | None = None

        def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
            super().connection_made(transport)
            self._expect_head()

        def data_received(self, data: bytes) -> None:
            if self._head_timer is None and not self._is_busy():
                self._expect_head()
            super().data_received(data)
            if self._is_busy() and self._head_timer:
                self._head_timer.cancel()
                self._head_timer = None

        def connection_lost(self, exc: Exception | None) -> None:
            if self._head_timer:
                self._head_timer.cancel()
            super().connection_lost(exc)

        def _expect_head(self) -> None:
            self._head_timer = self.loop.call_later(header_s, self._give_up)

        def _is_busy(self) -> bool:
            cycle: Any = self.cycle
            return cycle is not None and not cycle.response_complete

        def _give_up(self) -> None:
            self._head_timer = None
            upgraded = self.transport.get_protocol() is not self
            if not upgraded and not self._is_busy() and not self.transport.is_closing():
                self.transport.close()

    return LimitedProtocol

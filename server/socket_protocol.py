"""uvicorn's WebSocket protocol with a way to let go of clients that never read."""

from __future__ import annotations

import socket
from asyncio.transports import BaseTransport
from collections.abc import Callable
from typing import Any, cast

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

UNACKNOWLEDGED_MS = 20_000
KERNEL_BYTES = 256 * 1024  # what waits here is old before it arrives; by default it may be megabytes
ABORT = "galewood.abort"


class SocketProtocol(WebSocketsSansIOProtocol):
    """Closing a socket waits until the peer has read everything; a stalled peer must be cut off instead."""

    def connection_made(self, transport: BaseTransport) -> None:
        """Let the kernel hold little, and give up on peers that take nothing for a while."""
        super().connection_made(transport)
        raw = cast(socket.socket | None, transport.get_extra_info("socket"))
        if raw is not None and raw.family in (socket.AF_INET, socket.AF_INET6):
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, KERNEL_BYTES)
            if hasattr(socket, "TCP_USER_TIMEOUT"):
                raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, UNACKNOWLEDGED_MS)

    def keepalive_timeout(self) -> None:
        """No answer to a ping: drop the connection with whatever it still had to send."""
        super().keepalive_timeout()
        self.transport.abort()

    async def run_asgi(self) -> None:
        """Hand the application an `abort` beside the usual scope."""
        cast(dict[str, Any], self.scope)["extensions"][ABORT] = {"call": self.transport.abort}
        await super().run_asgi()


def abort_of(scope: Any) -> Callable[[], None]:
    """What cuts a socket's connection at once; does nothing under another server."""
    extension: dict[str, Callable[[], None]] = scope.get("extensions", {}).get(ABORT, {})
    return extension.get("call", lambda: None)

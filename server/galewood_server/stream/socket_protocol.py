"""uvicorn's WebSocket protocol with two short cuts: ready-made frames, and letting go of deaf clients."""

from __future__ import annotations

import fcntl
import socket
import struct
import sys
from asyncio.transports import BaseTransport
from typing import Any, cast

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

UNACKNOWLEDGED_MS = 20_000
KERNEL_BYTES = 256 * 1024  # what waits here is old before it arrives; by default it may be megabytes
EXTENSION = "galewood.socket"
SIOCOUTQNSD = 0x894B  # linux/sockios.h: what a TCP socket has taken and not sent
_count = bytearray(4)
_BINARY = 0x82  # a whole message of the kind "binary" (RFC 6455, section 5.2)


def binary_frame(message: bytes) -> bytes:
    """A message as it goes over the socket: servers do not mask, so all can be sent the same bytes."""
    length = len(message)
    if length < 126:
        head = struct.pack("!BB", _BINARY, length)
    elif length < 65536:
        head = struct.pack("!BBH", _BINARY, 126, length)
    else:
        head = struct.pack("!BBQ", _BINARY, 127, length)
    return head + message


def _is_text(data: bytes) -> bool:
    try:
        data.decode()
    except UnicodeDecodeError:
        return False
    return True


class SocketProtocol(WebSocketsSansIOProtocol):
    """Closing a socket waits until the peer has read everything; a stalled peer must be cut off instead."""

    def connection_made(self, transport: BaseTransport) -> None:
        """Let the kernel hold little, and give up on peers that take nothing for a while."""
        super().connection_made(transport)
        raw = cast(socket.socket | None, transport.get_extra_info("socket"))
        tcp = raw is not None and raw.family in (socket.AF_INET, socket.AF_INET6)
        self._raw = raw if tcp and sys.platform == "linux" else None
        if raw is not None and tcp:
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, KERNEL_BYTES)
            if hasattr(socket, "TCP_USER_TIMEOUT"):
                raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, UNACKNOWLEDGED_MS)

    def keepalive_timeout(self) -> None:
        """No answer to a ping: drop the connection with whatever it still had to send."""
        super().keepalive_timeout()
        self.abort()

    def send_receive_event_to_app(self) -> None:
        """Close on text that is not UTF-8 without a traceback in the log: anybody can send some."""
        if self.curr_msg_data_type == "text" and not self.close_sent and not _is_text(b"".join(self.frames)):
            self.frames = []
            self.conn.send_close(1007)
            self.handle_parser_exception()
            return
        super().send_receive_event_to_app()

    def push(self, frame: bytes) -> None:
        """Write a frame that `binary_frame` made, whole and at once; nothing on a socket that is closing."""
        if not self.closing:
            self.transport.write(frame)

    @property
    def closing(self) -> bool:
        """Whether nothing more can be sent: either side has closed."""
        return self.close_sent or self.disconnected or self.transport.is_closing()

    @property
    def unsent_bytes(self) -> int:
        """What the peer was written and is not on its way yet, here or in the kernel."""
        return self.transport.get_write_buffer_size() + self._kernel_unsent_bytes()

    def _kernel_unsent_bytes(self) -> int:
        if self._raw is None or self._raw.fileno() < 0:
            return 0
        fcntl.ioctl(self._raw.fileno(), SIOCOUTQNSD, _count, True)
        return int.from_bytes(_count, sys.byteorder)

    def abort(self) -> None:
        """Cut the connection at once and forget what was still to be sent, here and in the kernel."""
        if self._raw is not None and self._raw.fileno() >= 0:
            self._raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.transport.abort()

    async def run_asgi(self) -> None:
        """Hand the application this protocol beside the usual scope."""
        cast(dict[str, Any], self.scope)["extensions"][EXTENSION] = {"protocol": self}
        await super().run_asgi()


def protocol_of(scope: Any) -> SocketProtocol:
    """The protocol of a socket. RuntimeError under a server that was not started with it."""
    extension: dict[str, SocketProtocol] = scope.get("extensions", {}).get(EXTENSION, {})
    if "protocol" not in extension:
        raise RuntimeError(
            "streams need uvicorn with ws=galewood_server.stream.socket_protocol.SocketProtocol"
        )
    return extension["protocol"]

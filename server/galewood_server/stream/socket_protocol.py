"""uvicorn's WebSocket protocol, extended by pre-encoded frames, a meter of what arrives, and disconnection of
stalled clients.
"""

from __future__ import annotations

import fcntl
import logging
import socket
import struct
import sys
from asyncio.transports import BaseTransport
from typing import Any, ClassVar, cast

from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

from galewood_server.stream.frame_meter import FrameMeter, SocketLimits
from galewood_server.stream.session_error import POLICY_VIOLATION

UNACKNOWLEDGED_MS = 20_000
KERNEL_BYTES = 256 * 1024  # limits latency; the default can be megabytes
EXTENSION_NAME = "galewood.socket"
LAST_WORDS_S = 1.0  # for a refused client to read why
SIOCOUTQNSD = 0x894B  # linux/sockios.h: unsent bytes in the socket's queue
_count = bytearray(4)
log = logging.getLogger("galewood.stream")
_BINARY = 0x82  # FIN and opcode "binary" (RFC 6455, section 5.2)


def binary_frame(message: bytes) -> bytes:
    """The WebSocket frame of a message. Server frames are unmasked, so all clients receive the same bytes."""
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
    """A closing handshake waits until the peer has read everything, so stalled peers are aborted instead.

    What a client sends is metered before it is parsed; above the limits the socket is closed with 1008.
    """

    limits: ClassVar[SocketLimits] = SocketLimits()
    _refused = False

    def connection_made(self, transport: BaseTransport) -> None:
        """Set a small kernel send buffer and a timeout for unacknowledged data."""
        super().connection_made(transport)
        self._meter = FrameMeter(self.limits, self.loop.time())
        raw = cast(socket.socket | None, transport.get_extra_info("socket"))
        tcp = raw is not None and raw.family in (socket.AF_INET, socket.AF_INET6)
        self._raw = raw if tcp and sys.platform == "linux" else None
        if raw is not None and tcp:
            raw.setsockopt(socket.SOL_SOCKET, socket.SO_SNDBUF, KERNEL_BYTES)
            if hasattr(socket, "TCP_USER_TIMEOUT"):
                raw.setsockopt(socket.IPPROTO_TCP, socket.TCP_USER_TIMEOUT, UNACKNOWLEDGED_MS)

    def data_received(self, data: bytes) -> None:
        """Meter and parse what arrived; discard what follows a refusal."""
        if self._refused:
            return
        # the first call is uvicorn's own: it passes the request head on
        excess = self._meter.excess(data, self.loop.time()) if self.handshake_initiated else None
        if excess:
            self._refuse(excess)
        else:
            super().data_received(data)

    def _refuse(self, reason: str) -> None:
        """Close with 1008, read no more, and abort a moment later: at once would discard the close frame."""
        self._refused = True
        if not self.handshake_complete or self.closing:
            self.abort()
            return
        log.info("refused a socket: %s", reason)
        self.stop_keepalive()
        self.transport.pause_reading()
        self.queue.put_nowait({"type": "websocket.disconnect", "code": POLICY_VIOLATION, "reason": reason})
        self.conn.send_close(POLICY_VIOLATION, reason)
        self.transport.write(b"".join(self.conn.data_to_send()))
        self.close_sent = True
        self.loop.call_later(LAST_WORDS_S, self.abort)

    def keepalive_timeout(self) -> None:
        """Abort the connection if a ping is not answered."""
        super().keepalive_timeout()
        self.abort()

    def send_receive_event_to_app(self) -> None:
        """Close on invalid UTF-8 without a traceback in the log, because any client can send it."""
        if self.curr_msg_data_type == "text" and not self.close_sent and not _is_text(b"".join(self.frames)):
            self.frames = []
            self.conn.send_close(1007)
            self.handle_parser_exception()
            return
        super().send_receive_event_to_app()

    def push(self, frame: bytes) -> None:
        """Write a frame made by `binary_frame`; does nothing if the socket is closing."""
        if not self.closing:
            self.transport.write(frame)

    @property
    def closing(self) -> bool:
        """Whether the socket is closed or closing."""
        return self.close_sent or self.disconnected or self.transport.is_closing()

    @property
    def unsent_bytes(self) -> int:
        """Number of written bytes that are still unsent, in the transport or in the kernel."""
        return self.transport.get_write_buffer_size() + self._kernel_unsent_bytes()

    def _kernel_unsent_bytes(self) -> int:
        if self._raw is None or self._raw.fileno() < 0:
            return 0
        fcntl.ioctl(self._raw.fileno(), SIOCOUTQNSD, _count, True)
        return int.from_bytes(_count, sys.byteorder)

    def abort(self) -> None:
        """Abort the connection and discard unsent data, including the kernel's."""
        if self._raw is not None and self._raw.fileno() >= 0:
            self._raw.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        self.transport.abort()

    async def run_asgi(self) -> None:
        """Add this protocol to the ASGI scope."""
        cast(dict[str, Any], self.scope)["extensions"][EXTENSION_NAME] = {"protocol": self}
        await super().run_asgi()


def metered_protocol(limits: SocketLimits) -> type[SocketProtocol]:
    """A protocol class with its own limits, for uvicorn."""
    return type("MeteredProtocol", (SocketProtocol,), {"limits": limits})


def protocol_of(scope: Any) -> SocketProtocol:
    """The SocketProtocol of an ASGI scope. RuntimeError if uvicorn was started without it."""
    extension: dict[str, SocketProtocol] = scope.get("extensions", {}).get(EXTENSION_NAME, {})
    if "protocol" not in extension:
        raise RuntimeError("streams need uvicorn with a protocol of galewood_server.stream.metered_protocol")
    return extension["protocol"]

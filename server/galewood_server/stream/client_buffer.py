"""One client's place in a forest: what it was sent, and a slot that only the newest can be in.

The slot is the socket's own buffer: while a message waits there nothing follows it, and what follows then
is the newest. So a client holds the memory of one message, and no task of its own.
"""

from __future__ import annotations

import logging
from typing import Protocol

from galewood_server.stream.frames import FrameHistory
from galewood_server.stream.latest_values import LatestValues

log = logging.getLogger("galewood.stream")


class FrameSink(Protocol):
    """What a mailbox needs of a socket (socket_protocol.SocketProtocol)."""

    @property
    def unsent_bytes(self) -> int: ...
    def push(self, frame: bytes) -> None: ...
    def abort(self) -> None: ...


class ClientBuffer:
    """Sends a client what is new to it whenever its socket has room; cuts off one that takes nothing."""

    def __init__(self, sink: FrameSink, *, streams: bool, stall_s: float) -> None:
        self.streams = streams
        self._sink = sink
        self._stall_s = stall_s
        self._read = 0
        self._tick: int | None = None
        self._unsent = 0
        self._stuck_since_s = 0.0

    def resync(self) -> None:
        """The client lost its place: the next frame is a key frame."""
        self._tick = None

    def deliver(self, latest: LatestValues, history: FrameHistory | None, now_s: float) -> None:
        """Send the news and the newest frame, unless something waits still."""
        unsent = self._sink.unsent_bytes
        if unsent:
            self._wait(unsent, now_s)
            return
        self._unsent = 0
        if latest.number != self._read:
            for frame in latest.since(self._read):
                self._sink.push(frame)
            self._read = latest.number
        if self.streams and history is not None:
            self._send_newest(history)

    def _send_newest(self, history: FrameHistory) -> None:
        frame = history.since(self._tick)
        if frame is not None:
            self._sink.push(frame)
            self._tick = history.tick

    def _wait(self, unsent: int, now_s: float) -> None:
        if unsent != self._unsent:
            self._unsent, self._stuck_since_s = unsent, now_s
        elif now_s - self._stuck_since_s > self._stall_s:
            log.info("dropped a client that does not read")
            self.cut()

    def cut(self) -> None:
        """Drop the connection with whatever it still had to send."""
        self._sink.abort()

"""Client buffer: delivers the latest values and frames of a forest to one client.

The only queue is the socket's own send buffer: nothing is added while data is unsent, and then only the
newest frame is sent. A client therefore needs the memory of at most one message and no task of its own.
"""

from __future__ import annotations

import logging
from typing import Protocol

from galewood_server.stream.frames import FrameHistory
from galewood_server.stream.latest_values import LatestValues

log = logging.getLogger("galewood.stream")


class FrameSink(Protocol):
    """The socket interface that a ClientBuffer uses (socket_protocol.SocketProtocol)."""

    @property
    def unsent_bytes(self) -> int: ...
    def push(self, frame: bytes) -> None: ...
    def abort(self) -> None: ...


class ClientBuffer:
    """Sends new values and frames when the socket is ready; disconnects a client that stops reading."""

    def __init__(self, sink: FrameSink, *, streams: bool, stall_s: float) -> None:
        self.streams = streams
        self._sink = sink
        self._stall_s = stall_s
        self._sent_number = 0
        self._tick: int | None = None
        self._unsent = 0
        self._stalled_since_s = 0.0

    def resync(self) -> None:
        """Make the next frame a key frame."""
        self._tick = None

    def deliver(self, latest: LatestValues, history: FrameHistory | None, now_s: float) -> None:
        """Send new values and the newest frame, unless earlier data is still unsent."""
        unsent = self._sink.unsent_bytes
        if unsent:
            self._check_stall(unsent, now_s)
            return
        self._unsent = 0
        if latest.number != self._sent_number:
            for frame in latest.since(self._sent_number):
                self._sink.push(frame)
            self._sent_number = latest.number
        if self.streams and history is not None:
            self._send_newest(history)

    def _send_newest(self, history: FrameHistory) -> None:
        frame = history.since(self._tick)
        if frame is not None:
            self._sink.push(frame)
            self._tick = history.tick

    def _check_stall(self, unsent: int, now_s: float) -> None:
        if unsent != self._unsent:
            self._unsent, self._stalled_since_s = unsent, now_s
        elif now_s - self._stalled_since_s > self._stall_s:
            log.info("disconnected a client that does not read")
            self.disconnect()

    def disconnect(self) -> None:
        """Abort the connection and discard unsent data."""
        self._sink.abort()

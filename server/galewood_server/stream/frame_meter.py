"""Metering of a socket's incoming bytes and frames before they are parsed.

The message rate is checked by the session, which never sees control frames and empty fragments: pings, pongs
and fragments without content cost the parser as much time as messages do.
"""

from __future__ import annotations

from dataclasses import dataclass

BURST_S = 2.0
LEAST_READ_BYTES = 1024  # what a read costs at least, however few bytes arrived
_EXTENDED = {126: 2, 127: 8}  # bytes of the extended length (RFC 6455, section 5.2)


@dataclass(frozen=True)
class SocketLimits:
    """What one socket may send on average; bursts of two seconds, and of two messages of the maximum size."""

    frames_per_s: float = 300.0
    bytes_per_s: float = 1024 * 1024
    message_bytes: int = 4 * 1024 * 1024


class FrameMeter:
    """Counts the bytes and frame heads of a stream, which may be cut anywhere, with token buckets."""

    def __init__(self, limits: SocketLimits, now_s: float) -> None:
        self._limits = limits
        self._counted_s = now_s
        self._most_frames = BURST_S * limits.frames_per_s
        self._most_bytes = BURST_S * limits.bytes_per_s + 2 * limits.message_bytes
        self._frames, self._bytes = self._most_frames, self._most_bytes
        self._head = b""  # an incomplete frame head, at most 13 bytes
        self._skipped = 0  # bytes of the current frame's payload that have not arrived

    def excess(self, data: bytes, now_s: float) -> str | None:
        """Count received bytes. Returns the exceeded limit in words, or None.

        The work is bounded by the limits: counting ends at the first frame above them.
        """
        spent_s, self._counted_s = now_s - self._counted_s, now_s
        self._frames = min(self._most_frames, self._frames + spent_s * self._limits.frames_per_s)
        self._bytes = min(self._most_bytes, self._bytes + spent_s * self._limits.bytes_per_s)
        self._bytes -= max(len(data), LEAST_READ_BYTES)
        if self._bytes < 0:
            return f"More than {self._limits.bytes_per_s / 1024:g} KiB per second"
        if not self._count_frames(data):
            return f"More than {self._limits.frames_per_s:g} frames per second"
        return None

    def _count_frames(self, data: bytes) -> bool:
        """Walk along the frame heads. False if there are more frames than allowed."""
        start = min(self._skipped, len(data))
        self._skipped -= start
        data, at = self._head + data[start:], 0
        while (end := _frame_end(data, at)) is not None:
            self._frames -= 1
            if self._frames < 0:
                return False
            at = end
        self._skipped += max(0, at - len(data))
        self._head = data[at:]
        return True


def _frame_end(data: bytes, at: int) -> int | None:
    """Where the frame that begins at `at` ends, possibly behind the data; None if its head is incomplete."""
    if len(data) - at < 2:
        return None
    masked, length = data[at + 1] >> 7, data[at + 1] & 127
    extended = _EXTENDED.get(length, 0)
    begin = at + 2 + extended + 4 * masked
    if begin > len(data):
        return None
    return begin + (int.from_bytes(data[at + 2 : at + 2 + extended]) if extended else length)

"""Recent poses of a forest and the frames encoded from them, each encoded once for all clients.

A client receives the difference to the last tick it was sent, so that a slow client misses frames but no
changes. If that tick is no longer stored or the difference does not fit, it receives a key frame.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from galewood_server.stream.socket_protocol import binary_frame
from galewood_server.stream.wire import Frame, Poses, Rows, encode_frame

KEPT_TICKS = 8
"""Number of stored ticks: clients at a quarter of the frame rate still receive differences."""

Shape = tuple[int, int, int]
"""(count, modes, quantum) of a group."""
Write = Callable[[Sequence[Poses]], None]


@dataclass
class _TickFrames:
    tick: int
    time_s: float
    made_s: float
    poses: tuple[Poses, ...]
    frames: dict[int | None, bytes] = field(default_factory=dict[int | None, bytes])


class FrameHistory:
    """Ring buffer of the last poses of a forest. Not thread-safe."""

    def __init__(self, shapes: Sequence[Shape]) -> None:
        self._quanta = [quantum for _, _, quantum in shapes]
        self._ring = [self._buffers(shapes) for _ in range(KEPT_TICKS)]
        self._difference = self._buffers(shapes)
        self._kept: dict[int, _TickFrames] = {}
        self._newest: _TickFrames | None = None

    @staticmethod
    def _buffers(shapes: Sequence[Shape]) -> tuple[Poses, ...]:
        return tuple(np.zeros((count, modes), np.int32) for count, modes, _ in shapes)

    @property
    def tick(self) -> int | None:
        """The newest tick; None before the first one."""
        return self._newest.tick if self._newest else None

    @property
    def poses(self) -> tuple[Poses, ...]:
        """The newest poses in units of quantum × modes.scale; valid for KEPT_TICKS ticks."""
        assert self._newest is not None
        return self._newest.poses

    def add(self, tick: int, time_s: float, made_s: float, write: Write) -> None:
        """Add the poses of a tick, which `write` puts into the given arrays, and encode the usual frame."""
        previous = self._newest
        poses = self._ring[tick % KEPT_TICKS]
        write(poses)
        entry = _TickFrames(tick, time_s, made_s, poses)
        self._kept = {old: kept for old, kept in self._kept.items() if tick - KEPT_TICKS < old < tick}
        self._kept[tick] = entry
        self._newest = entry
        if previous is not None and previous.tick in self._kept and previous.tick != tick:
            self.since(previous.tick)

    def since(self, tick: int | None) -> bytes | None:
        """The frame from a tick (None: a key frame) to the newest one; None if `tick` is the newest."""
        newest = self._newest
        if newest is None or tick == newest.tick:
            return None
        base = tick if tick in self._kept else None
        if base not in newest.frames:
            newest.frames[base] = binary_frame(self._encode(newest, base))
        return newest.frames[base]

    def _encode(self, newest: _TickFrames, base: int | None) -> bytes:
        values = newest.poses
        if base is not None:
            for now, old, out in zip(values, self._kept[base].poses, self._difference, strict=True):
                np.subtract(now, old, out=out)
            values = self._difference
        rows = tuple(Rows(quantum, part) for quantum, part in zip(self._quanta, values, strict=True))
        try:
            return encode_frame(Frame(newest.tick, base, newest.time_s, newest.made_s, rows))
        except ValueError:  # a difference exceeds 16 bits
            return self._encode(newest, None)

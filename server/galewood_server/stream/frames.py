"""A forest's newest poses and the frames made of them, each encoded once for all who are sent it.

A client is sent the difference to the tick that it was sent before, whichever that is: a slow one misses
frames, never a change. Where that tick is no longer kept, or the difference does not fit, it is a key frame.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np

from galewood_server.stream.socket_protocol import binary_frame
from galewood_server.stream.wire_frame import Frame, Poses, Rows, encode_frame

KEPT_TICKS = 8
"""Ticks that a difference may reach back: a client at a quarter of the rate still gets differences."""

Shape = tuple[int, int, int]
"""(count, modes, quantum) of a group."""
Write = Callable[[Sequence[Poses]], None]


@dataclass
class _Moment:
    tick: int
    time_s: float
    made_s: float
    poses: tuple[Poses, ...]
    frames: dict[int | None, bytes] = field(default_factory=dict[int | None, bytes])


class FrameHistory:
    """The last poses of a forest in buffers that are used again. One thread at a time."""

    def __init__(self, shapes: Sequence[Shape]) -> None:
        self._quanta = [quantum for _, _, quantum in shapes]
        self._ring = [self._buffers(shapes) for _ in range(KEPT_TICKS)]
        self._difference = self._buffers(shapes)
        self._kept: dict[int, _Moment] = {}
        self._newest: _Moment | None = None

    @staticmethod
    def _buffers(shapes: Sequence[Shape]) -> tuple[Poses, ...]:
        return tuple(np.zeros((count, modes), np.int32) for count, modes, _ in shapes)

    @property
    def tick(self) -> int | None:
        """The newest tick, None before the first."""
        return self._newest.tick if self._newest else None

    @property
    def poses(self) -> tuple[Poses, ...]:
        """The newest poses in units of quantum × modes.scale, valid until KEPT_TICKS later."""
        assert self._newest is not None
        return self._newest.poses

    def add(self, tick: int, time_s: float, made_s: float, write: Write) -> None:
        """Take in the poses that `write` puts into the arrays it is given; encode what most will be sent."""
        before = self._newest
        poses = self._ring[tick % KEPT_TICKS]
        write(poses)
        moment = _Moment(tick, time_s, made_s, poses)
        self._kept = {old: kept for old, kept in self._kept.items() if tick - KEPT_TICKS < old < tick}
        self._kept[tick] = moment
        self._newest = moment
        if before is not None and before.tick in self._kept and before.tick != tick:
            self.since(before.tick)

    def since(self, tick: int | None) -> bytes | None:
        """What brings a client from a tick (None: from nowhere) to the newest; None if it is there."""
        newest = self._newest
        if newest is None or tick == newest.tick:
            return None
        base = tick if tick in self._kept else None
        if base not in newest.frames:
            newest.frames[base] = binary_frame(self._encode(newest, base))
        return newest.frames[base]

    def _encode(self, newest: _Moment, base: int | None) -> bytes:
        values = newest.poses
        if base is not None:
            for now, old, out in zip(values, self._kept[base].poses, self._difference, strict=True):
                np.subtract(now, old, out=out)
            values = self._difference
        rows = tuple(Rows(quantum, part) for quantum, part in zip(self._quanta, values, strict=True))
        try:
            return encode_frame(Frame(newest.tick, base, newest.time_s, newest.made_s, rows))
        except ValueError:  # a difference that does not fit
            return self._encode(newest, None)

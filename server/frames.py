"""What one client was sent and what comes next: newest wins, deltas against the last frame sent."""

from __future__ import annotations

import asyncio

from server.wire import Frame, Poses, deltas_fit


class FrameSlot:
    """A mailbox for one frame. A slow client misses frames in between, never a change."""

    def __init__(self) -> None:
        self._newest: tuple[float, tuple[Poses, ...]] | None = None
        self._sent: tuple[Poses, ...] | None = None
        self._seq = 0
        self._filled = asyncio.Event()

    def put(self, time_s: float, poses: tuple[Poses, ...]) -> None:
        """Leave the newest poses, in place of any that were not sent yet."""
        self._newest = (time_s, poses)
        self._filled.set()

    async def take(self) -> Frame:
        """Wait for poses and turn them into the next frame for this client, taken for sent from here on."""
        await self._filled.wait()
        self._filled.clear()
        assert self._newest is not None
        (time_s, poses), seq = self._newest, self._seq
        deltas = self._deltas(poses)
        self._sent, self._seq = poses, seq + 1
        if deltas is None:
            return Frame(seq, time_s, True, poses)
        return Frame(seq, time_s, False, deltas)

    def _deltas(self, poses: tuple[Poses, ...]) -> tuple[Poses, ...] | None:
        if self._sent is None:
            return None
        deltas = tuple(now - before for now, before in zip(poses, self._sent, strict=True))
        return deltas if deltas_fit(deltas) else None

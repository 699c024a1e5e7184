"""CPU time and peak memory of a process together with its children."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from types import TracebackType
from typing import Self

import psutil

SAMPLE_INTERVAL_S = 0.1
BYTES_PER_MEGABYTE = 1 << 20


def cpu_seconds() -> float:
    """User plus system CPU time, s, of this process and of all its children, terminated or running."""
    own = psutil.Process()
    times = own.cpu_times()
    spent = times.user + times.system + times.children_user + times.children_system
    for child in own.children(recursive=True):
        try:
            times = child.cpu_times()
        except psutil.Error:
            continue  # the child has just exited
        spent += times.user + times.system + times.children_user + times.children_system
    return spent


@dataclass
class PeakMemory:
    """Peak resident memory, MB, sampled ten times a second inside a ``with`` block.

    Shared pages are counted once for each process that maps them.
    """

    parent_mb: float = 0.0
    """Peak of this process."""
    child_mb: float = 0.0
    """Peak of any single child."""
    total_mb: float = 0.0
    """Peak of the sum over this process and all its children."""
    _stop: threading.Event = field(default_factory=threading.Event)

    def sample(self) -> None:
        """Take one memory sample and update the peaks."""
        own = psutil.Process()
        children: list[float] = []
        for child in own.children(recursive=True):
            try:
                children.append(child.memory_info().rss / BYTES_PER_MEGABYTE)
            except psutil.Error:
                continue  # the child has just exited
        parent = own.memory_info().rss / BYTES_PER_MEGABYTE
        self.parent_mb = max(self.parent_mb, parent)
        self.child_mb = max([self.child_mb, *children])
        self.total_mb = max(self.total_mb, parent + sum(children))

    def __enter__(self) -> Self:
        self._thread = threading.Thread(target=self._run, daemon=True)
        self._thread.start()
        return self

    def _run(self) -> None:
        while not self._stop.wait(SAMPLE_INTERVAL_S):
            self.sample()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._stop.set()
        self._thread.join()
        self.sample()

"""What a process and all its children use: CPU time so far, and memory at one and the same time."""

from __future__ import annotations

import threading
from dataclasses import dataclass, field
from types import TracebackType
from typing import Self

import psutil

EVERY_S = 0.1
MEGABYTE = 1 << 20


def cpu_seconds() -> float:
    """User and system time of this process, its children that have ended, and those that live."""
    own = psutil.Process()
    times = own.cpu_times()
    spent = times.user + times.system + times.children_user + times.children_system
    for child in own.children(recursive=True):
        try:
            times = child.cpu_times()
        except psutil.Error:
            continue  # it has just ended
        spent += times.user + times.system + times.children_user + times.children_system
    return spent


@dataclass
class PeakMemory:
    """Resident memory, MB, looked at ten times a second inside ``with``; shared pages count each time."""

    parent_mb: float = 0.0
    """The most of this process."""
    child_mb: float = 0.0
    """The most of any one child."""
    total_mb: float = 0.0
    """The most of all of them at the same time."""
    _over: threading.Event = field(default_factory=threading.Event)

    def look(self) -> None:
        own = psutil.Process()
        children: list[float] = []
        for child in own.children(recursive=True):
            try:
                children.append(child.memory_info().rss / MEGABYTE)
            except psutil.Error:
                continue  # it has just ended
        parent = own.memory_info().rss / MEGABYTE
        self.parent_mb = max(self.parent_mb, parent)
        self.child_mb = max([self.child_mb, *children])
        self.total_mb = max(self.total_mb, parent + sum(children))

    def __enter__(self) -> Self:
        self._watcher = threading.Thread(target=self._watch, daemon=True)
        self._watcher.start()
        return self

    def _watch(self) -> None:
        while not self._over.wait(EVERY_S):
            self.look()

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self._over.set()
        self._watcher.join()
        self.look()

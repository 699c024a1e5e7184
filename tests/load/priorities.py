"""Priorities of processes, on Linux those of their threads: each has its own, inherited from its creator."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path


def set_niceness(pid: int, niceness: int) -> None:
    """Give all threads of a process a niceness. Only root can make it smaller."""
    for_all_threads(pid, lambda thread: os.setpriority(os.PRIO_PROCESS, thread, niceness))


def set_idle(pid: int) -> None:
    """Let a process run only where nothing else does."""
    for_all_threads(pid, lambda thread: os.sched_setscheduler(thread, os.SCHED_IDLE, os.sched_param(0)))


def for_all_threads(pid: int, change: Callable[[int], object]) -> None:
    """Do something to each thread, also to those that are created meanwhile. Nothing if the process ends."""
    done = set[int]()
    while new := _threads(pid) - done:
        for thread in new:
            with suppress(ProcessLookupError):
                change(thread)
        done |= new


def _threads(pid: int) -> set[int]:
    with suppress(FileNotFoundError, ProcessLookupError):
        return {int(entry.name) for entry in Path(f"/proc/{pid}/task").iterdir()}
    return set()

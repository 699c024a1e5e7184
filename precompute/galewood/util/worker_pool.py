"""The processes beside a build's own: they sample, draw and compare while it goes on.

Spawned, not forked: the build's process may hold threads and compiled code that do not survive a fork. None
outlives the build, not even one that is killed: each holds one end of a pipe and ends when the other is gone.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ProcessPoolExecutor
from importlib import import_module
from multiprocessing import get_context
from multiprocessing.connection import Connection
from types import TracebackType
from typing import ParamSpec, Self, TypeVar

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")
WARM_UP_S = 0.3
"""A process that has just started is kept for so long that the next task starts another one."""


class WorkerPool:
    """A few processes, started and warmed up at once; ``with`` ends them, and at once after an exception."""

    def __init__(self, count: int | None = None, *, warm: Sequence[str] = ()) -> None:
        """``warm`` names modules that every process imports at once."""
        context, count = get_context("spawn"), count or usable_cores()
        end, self._lifeline = context.Pipe(duplex=False)
        self._pool = ProcessPoolExecutor(count, mp_context=context, initializer=_begin, initargs=(end,))
        for _ in range(count if warm else 0):
            self._pool.submit(_warm_up, tuple(warm))

    def start(
        self, work: Callable[Arguments, Result], *args: Arguments.args, **kwargs: Arguments.kwargs
    ) -> Future[Result]:
        """Call a module's function in one of the processes, after what was started before."""
        return self._pool.submit(work, *args, **kwargs)

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if kind is not None:
            self._lifeline.close()
        self._pool.shutdown(wait=True, cancel_futures=True)
        self._lifeline.close()


def usable_cores() -> int:
    """How many cores this process may use, which can be fewer than the machine has."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _begin(end: Connection) -> None:
    threading.Thread(target=_end_with, args=(end,), daemon=True).start()


def _end_with(end: Connection) -> None:
    """Wait until the build's end of the pipe is gone; whatever is being done is then wanted by nobody."""
    try:
        end.recv_bytes()
    except (EOFError, OSError):
        os._exit(1)


def _warm_up(modules: tuple[str, ...]) -> None:
    """Import what most tasks need before the first of them arrives."""
    for module in modules:
        import_module(module)
    time.sleep(WARM_UP_S)

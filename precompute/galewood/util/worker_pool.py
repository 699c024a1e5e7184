"""A pool of worker processes that simulate, render and compare while a build runs.

loky starts the workers: they are new programs rather than forks, because the parent may hold threads and
compiled code that do not survive a fork, and they do not import the parent's main module, so that a build can
be started from a script without a ``__main__`` guard, from ``python -c`` and from a notebook. No worker
outlives its parent, even if the parent is killed: each worker holds the read end of a pipe and exits when the
write end is closed.
"""

from __future__ import annotations

import os
import threading
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future
from importlib import import_module
from multiprocessing.connection import Connection
from types import TracebackType
from typing import TYPE_CHECKING, ParamSpec, Self, TypeVar

from galewood.threads import SINGLE_THREADED

if TYPE_CHECKING:
    from loky import ProcessPoolExecutor

Arguments = ParamSpec("Arguments")
Result = TypeVar("Result")
WARM_UP_S = 0.3
"""How long a warm-up task occupies its worker, s, so that the next one goes to another process."""
WORKER_ENVIRONMENT = {"LOKY_MAX_MEMORY_LEAK_SIZE": str(1 << 50), **SINGLE_THREADED}
"""loky replaces workers that have grown by 300 MB; a model of that size is no leak."""


class WorkerPool:
    """A fixed number of worker processes, started with the first call.

    Leaving the ``with`` block cancels what has not begun, waits for running tasks and shuts the workers down;
    after an exception, running tasks are aborted.
    """

    def __init__(self, count: int | None = None, *, warm: Sequence[str] = ()) -> None:
        """``count`` workers (default: one per usable core); each first imports the modules ``warm``."""
        self._count, self._warm = count or usable_cores(), tuple(warm)
        self._starting = threading.Lock()
        self._pool: ProcessPoolExecutor | None = None
        self._lifeline: Connection | None = None
        self._futures: list[Future[object]] = []

    def _started(self) -> ProcessPoolExecutor:
        with self._starting:
            if self._pool is None:
                # loaded here, because many programs that import this package need no pool
                from loky import ProcessPoolExecutor
                from loky.backend import get_context

                context = get_context("loky")
                end, self._lifeline = context.Pipe(duplex=False)
                self._pool = ProcessPoolExecutor(
                    self._count, context=context, initializer=_initialise, initargs=(end,),
                    env=WORKER_ENVIRONMENT,
                )  # fmt: skip
                for _ in range(self._count if self._warm else 0):
                    self._pool.submit(_warm_up, self._warm)
            return self._pool

    def start(
        self, work: Callable[Arguments, Result], *args: Arguments.args, **kwargs: Arguments.kwargs
    ) -> Future[Result]:
        """Queue a call of a function in a worker and return its future."""
        future: Future[Result] = self._started().submit(work, *args, **kwargs)
        self._futures = [one for one in self._futures if not one.done()]
        self._futures.append(future)  # pyright: ignore[reportArgumentType]  # only cancelled
        return future

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        for future in self._futures:
            future.cancel()
        if self._pool is None or self._lifeline is None:
            return
        if kind is not None:
            self._lifeline.close()
        self._pool.shutdown(wait=True, kill_workers=kind is not None)
        self._lifeline.close()


def usable_cores() -> int:
    """Number of CPU cores available to this process, which may be fewer than the machine has."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _initialise(end: Connection) -> None:
    threading.Thread(target=_exit_with_parent, args=(end,), daemon=True).start()


def _exit_with_parent(end: Connection) -> None:
    """Exit as soon as the parent's end of the pipe is closed: nobody needs the running task any more."""
    try:
        end.recv_bytes()
    except (EOFError, OSError):
        os._exit(1)


def _warm_up(modules: tuple[str, ...]) -> None:
    """Import the modules that most tasks need before the first task arrives."""
    for module in modules:
        import_module(module)
    time.sleep(WARM_UP_S)

"""Heavy work that requests ask for: few at once, few waiting, and each file is made once for all of them."""

from __future__ import annotations

import asyncio
import time
from collections.abc import AsyncGenerator, Callable
from contextlib import asynccontextmanager
from pathlib import Path

from galewood.util import MeshError
from starlette.requests import HTTPConnection

from galewood_server.access.open_connections import count_open
from galewood_server.access.rates import client_key
from galewood_server.http import ProblemError

REMEMBERED_S = 600.0
"""How long a file that could not be made is not tried again: the cause may be a busy machine."""
MOST_REMEMBERED = 1000


class Turns:
    """Work of which `at_once` pieces run; `most_waiting` further requests wait, the others are refused.

    `most_of_address` limits the requests of one address among them, where anyone may ask.
    """

    def __init__(
        self, what: str, at_once: int, most_waiting: int, most_of_address: int | None = None
    ) -> None:
        self._what = what
        self._slots = asyncio.Semaphore(at_once)
        self._room = at_once + most_waiting
        self._most_of_address = self._room if most_of_address is None else most_of_address
        self._inside: dict[str, int] = {}

    @asynccontextmanager
    async def taken(self) -> AsyncGenerator[None]:
        """Wait for a turn, which lasts as long as the block. ProblemError 503 if too many wait."""
        async with self.admitted() as slots, slots:
            yield

    @asynccontextmanager
    async def admitted(self, request: HTTPConnection | None = None) -> AsyncGenerator[asyncio.Semaphore]:
        """Give a request room, so that it may receive its body; its work holds the semaphore.

        ProblemError 503 if there are too many, in total or of its address.
        """
        key = "" if request is None else client_key(request.scope)
        mine, all_inside = self._inside.get(key, 0), sum(self._inside.values())
        if all_inside >= self._room or mine >= self._most_of_address:
            raise _busy(self._what)
        with count_open(self._inside, key):
            yield self._slots


class FilesOnDemand:
    """Files that are made when they are first asked for, one after the other.

    Requests for a file that is being made wait for it and do not make it again. Reading needs no key, so the
    number of requests that wait is limited, in total and for each address. Of the files in the folder, the
    `kept` newest are kept; None: all.
    """

    def __init__(self, what: str, most_waiting: int, most_of_address: int, kept: int | None = None) -> None:
        self._what = what
        self._most_waiting = most_waiting
        self._most_of_address = most_of_address
        self._kept = kept
        self._waiting: dict[str, int] = {}
        self._slot = asyncio.Semaphore(1)
        self._under_way: dict[Path, asyncio.Task[None]] = {}
        self._failed: dict[Path, tuple[float, MeshError]] = {}

    async def have(self, target: Path, request: HTTPConnection, make: Callable[[], None]) -> None:
        """Return when the file exists; `make` writes it, in a thread.

        ProblemError 503 if too many requests wait. Raises what `make` raises; a MeshError is remembered, so
        that nobody can have the same work fail again and again.
        """
        if target.is_file():
            return
        self._raise_failed(target)
        key = client_key(request.scope)
        mine, all_waiting = self._waiting.get(key, 0), sum(self._waiting.values())
        if all_waiting >= self._most_waiting or mine >= self._most_of_address:
            raise _busy(self._what)
        with count_open(self._waiting, key):
            # the work goes on if the first client leaves: others may wait for it
            await asyncio.shield(self._under_way.get(target) or self._start(target, make))

    def _start(self, target: Path, make: Callable[[], None]) -> asyncio.Task[None]:
        task = self._under_way[target] = asyncio.create_task(self._make(target, make))
        task.add_done_callback(lambda done: self._ended(target, done))
        return task

    async def _make(self, target: Path, make: Callable[[], None]) -> None:
        async with self._slot:
            await asyncio.to_thread(make)
            if self._kept is not None:
                await asyncio.to_thread(_keep_newest, target.parent, self._kept)

    def _ended(self, target: Path, task: asyncio.Task[None]) -> None:
        del self._under_way[target]
        error = None if task.cancelled() else task.exception()  # marks it as seen if all clients have left
        if isinstance(error, MeshError):
            if len(self._failed) >= MOST_REMEMBERED:
                self._failed.clear()
            self._failed[target] = time.monotonic(), error

    def _raise_failed(self, target: Path) -> None:
        failed_s, error = self._failed.get(target, (0.0, None))
        if error is None:
            return
        if time.monotonic() - failed_s > REMEMBERED_S:
            del self._failed[target]
            return
        raise error.with_traceback(None)


def _keep_newest(folder: Path, count: int) -> None:
    """Remove all files but the newest."""
    files = sorted(folder.glob("[!.]*"), key=lambda path: path.stat().st_mtime)
    for path in files[:-count]:
        path.unlink(missing_ok=True)


def _busy(what: str) -> ProblemError:
    """503 for a request that would wait too long."""
    title, headers = f"Too many {what} are waiting", {"Retry-After": "20"}
    return ProblemError(503, "busy", title, hint="Try again shortly.", headers=headers)

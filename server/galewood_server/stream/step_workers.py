"""Step workers: threads that each step their forests TICK_HZ times per second."""

from __future__ import annotations

import asyncio
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor

from galewood.constants import TICK_HZ

from galewood_server.stream.live_forest import LiveForest

LATE_S = 0.25


class StepWorker:
    """The forests of one thread. If overloaded, their time runs slower; other workers are unaffected."""

    def __init__(self, threads: ThreadPoolExecutor) -> None:
        self.forests: set[LiveForest] = set()
        self.in_work = False
        """Whether frames are due and not sent yet."""
        self._threads = threads
        self._work: asyncio.Task[None] | None = None

    @property
    def tree_count(self) -> int:
        """Number of trees stepped per tick."""
        return sum(forest.tree_count for forest in self.forests)

    def add(self, forest: LiveForest) -> None:
        """Add a forest."""
        self.forests.add(forest)
        if self._work is None or self._work.done():
            self._work = asyncio.create_task(self._run())

    async def _run(self) -> None:
        loop = asyncio.get_running_loop()
        due_s = loop.time()
        while self.forests:
            due_s = max(due_s + 1 / TICK_HZ, loop.time() - LATE_S)
            await asyncio.sleep(due_s - loop.time())
            forests = tuple(self.forests)
            self.in_work = True
            try:
                await loop.run_in_executor(self._threads, _compute, forests, due_s)
                now_s = loop.time()
                for forest in forests:
                    forest.deliver(now_s)
            finally:
                self.in_work = False


def _compute(forests: Sequence[LiveForest], made_s: float) -> None:
    for forest in forests:
        forest.compute(made_s)

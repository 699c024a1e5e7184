"""All forests being played: private ones end with their client, shared ones a while after their last."""

from __future__ import annotations

import asyncio
import logging
import os
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from galewood.table import Table, TableError
from galewood.wind import WindState

from galewood_server.settings import Settings
from galewood_server.storage import TableCache
from galewood_server.stream.client_buffer import ClientBuffer, FrameSink
from galewood_server.stream.live_forest import LiveForest
from galewood_server.stream.refusal import BUSY, Refusal
from galewood_server.stream.step_workers import StepWorker
from galewood_server.stream.wire import Forest

if TYPE_CHECKING:
    from galewood_server.stream.forest import ForestStepper

log = logging.getLogger("galewood.stream")


@dataclass(frozen=True)
class Subscription:
    """A client's place in a forest."""

    forest: LiveForest
    client_buffer: ClientBuffer


def cores() -> int:
    """Processors that this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Forests:
    """Finds, founds and ends forests. In the event loop, apart from what is slow."""

    def __init__(self, settings: Settings, table_cache: TableCache) -> None:
        self._settings = settings
        self._table_cache = table_cache
        self._shared: dict[str, LiveForest] = {}
        self._founding = asyncio.Lock()
        threads = cores()
        steppers = ThreadPoolExecutor(threads, thread_name_prefix="stepper")
        self._workers = [StepWorker(steppers) for _ in range(threads)]

    @property
    def count(self) -> int:
        """Forests that are played now."""
        return sum(len(worker.forests) for worker in self._workers)

    @property
    def tree_count(self) -> int:
        """Trees that are simulated now."""
        return sum(worker.tree_count for worker in self._workers)

    async def join(self, plan: Forest, wind: WindState, sink: FrameSink) -> Subscription:
        """Give a client its place in the forest it asks for. Refusal."""
        client_buffer = ClientBuffer(
            sink, streams=plan.mode == "stream", stall_s=self._settings.socket_stall_s
        )
        if plan.share is None:
            forest = await self._found(plan, wind)
        else:
            # One at a time: of two who come first together, one founds and the other joins.
            async with self._founding:
                forest = await self._join_shared(plan.share, plan, wind)
        forest.add(client_buffer, asyncio.get_running_loop().time())
        return Subscription(forest, client_buffer)

    def leave(self, subscription: Subscription) -> None:
        """A client goes. A private forest goes with it, a shared one waits a while for others."""
        forest = subscription.forest
        forest.members.discard(subscription.client_buffer)
        if forest.members:
            return
        if forest.share is None:
            self._end(forest)
        else:
            self._end_later(forest)

    async def _join_shared(self, share: str, plan: Forest, wind: WindState) -> LiveForest:
        forest = self._shared.get(share)
        if forest is None:
            self._make_room()
            forest = await self._found(plan, wind)
            self._shared[share] = forest
            return forest
        bare = not forest.plan.groups and bool(plan.groups)
        if bare or (plan.replant and not forest.same_trees(plan)):
            await self._replant(forest, plan)
        elif forest.needs_stepper and plan.mode == "stream":
            await self._begin_simulation(forest, plan)
        return forest

    async def _begin_simulation(self, forest: LiveForest, plan: Forest) -> None:
        """Somebody streams where all had tables; the places are the forest's or, if it has none, theirs."""
        grid_placements = forest.plan if len(forest.plan.trees) else plan
        if grid_placements.groups and grid_placements.groups == forest.plan.groups:
            stepper = await self._stepper(forest, grid_placements)
            forest.plan = replace(forest.plan, trees=grid_placements.trees)
            forest.set_stepper(stepper)

    async def _replant(self, forest: LiveForest, plan: Forest) -> None:
        simulated = plan.mode == "stream" or (forest.streamed and len(plan.trees) > 0)
        forest.replant(plan, await self._stepper(forest, plan) if simulated else None)

    async def _found(self, plan: Forest, wind: WindState) -> LiveForest:
        from galewood_server.stream.forest import ForestClock

        clock = ForestClock(wind, plan.time_s)
        forest = LiveForest(plan, clock, asyncio.get_running_loop().time())
        if plan.mode == "stream" and plan.groups:
            forest.set_stepper(await self._stepper(forest, plan))
        min(self._workers, key=lambda worker: (worker.tree_count, len(worker.forests))).add(forest)
        return forest

    async def _stepper(self, forest: LiveForest, plan: Forest) -> ForestStepper:
        room = self._settings.server_trees - self.tree_count
        if len(plan.trees) > room:
            raise Refusal("server-full", "This server plays as many trees as it may", "Try later.", BUSY)
        return await asyncio.to_thread(lambda: forest.make_stepper(self._tables(plan), plan))

    def _tables(self, plan: Forest) -> list[Table]:
        try:
            return [self._table_cache.take(group.table) for group in plan.groups]
        except (FileNotFoundError, TableError) as error:
            log.warning("a table cannot be used: %s", error)
            raise Refusal("no-such-table", "A table of this forest cannot be used") from None

    def _make_room(self) -> None:
        if len(self._shared) < self._settings.shared_forests:
            return
        for forest in list(self._shared.values()):
            if not forest.members:
                self._end(forest)
                return
        raise Refusal("too-many-forests", "This server plays as many shared forests as it may", "", BUSY)

    def _end_later(self, forest: LiveForest) -> None:
        loop = asyncio.get_running_loop()
        forest.empty_since_s = loop.time()
        loop.call_later(self._settings.shared_forest_idle_s, self._end_if_deserted, forest)

    def _end_if_deserted(self, forest: LiveForest) -> None:
        if forest.members:
            return
        now_s = asyncio.get_running_loop().time()
        if self._founding.locked():  # somebody may be about to join it
            self._end_later(forest)
        elif now_s - forest.empty_since_s >= self._settings.shared_forest_idle_s - 0.01:
            self._end(forest)

    def _end(self, forest: LiveForest) -> None:
        for worker in self._workers:
            worker.forests.discard(forest)
        if forest.share is not None and self._shared.get(forest.share) is forest:
            del self._shared[forest.share]

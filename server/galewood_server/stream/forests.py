"""All running forests: private ones end with their client, shared ones some time after their last client."""

from __future__ import annotations

import asyncio
import logging
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from galewood.table import TableError

from galewood_server.settings import Settings
from galewood_server.storage import DamagedFileError, TableCache
from galewood_server.stream.client_buffer import ClientBuffer, FrameSink
from galewood_server.stream.live_forest import LiveForest
from galewood_server.stream.session_error import TRY_AGAIN_LATER, SessionError
from galewood_server.stream.step_workers import StepWorker
from galewood_server.stream.tree_budget import EDDIES_WORK, WIND_WORK, TreeBudget, WorkRates, work_of
from galewood_server.stream.wire import Forest

if TYPE_CHECKING:
    from galewood.motion.wind import Wind, WindState
    from galewood.table import Compliance, Table

    from galewood_server.stream.forest import ForestStepper

log = logging.getLogger("galewood.stream")
RecordsOf = Callable[[str], str | None]
"""The records file of a table, both by their hashes; None: there is none."""
ComplianceOf = Callable[[str], str | None]
"""The compliance file of a table's tree, both by their hashes; None: there is none."""


@dataclass(frozen=True)
class Subscription:
    """A client's subscription to a forest."""

    forest: LiveForest
    client_buffer: ClientBuffer


def cores() -> int:
    """Number of CPU cores available to this process."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


class Forests:
    """Creates, shares and ends forests. Runs in the event loop, except for slow operations."""

    def __init__(
        self,
        settings: Settings,
        table_cache: TableCache,
        records_of: RecordsOf,
        compliance_of: ComplianceOf = lambda table_sha256: None,
    ) -> None:
        self._settings = settings
        self._compliance_of = compliance_of
        self._table_cache = table_cache
        self._records_of = records_of
        self._shared: dict[str, LiveForest] = {}
        self._join_lock = asyncio.Lock()
        self._budget = TreeBudget(settings.server_trees, settings.address_trees)
        self._rates = WorkRates(settings.address_trees_per_s)
        threads = cores()
        steppers = ThreadPoolExecutor(threads, thread_name_prefix="stepper")
        self._workers = [StepWorker(steppers) for _ in range(threads)]

    @property
    def frames_in_work(self) -> bool:
        """Whether frames of any forest are due and not sent yet."""
        return any(worker.in_work for worker in self._workers)

    @property
    def count(self) -> int:
        """Number of running forests."""
        return sum(len(worker.forests) for worker in self._workers)

    @property
    def tree_count(self) -> int:
        """Number of simulated trees."""
        return sum(worker.tree_count for worker in self._workers)

    @property
    def shares(self) -> set[str]:
        """Names of the shared forests."""
        return set(self._shared)

    def end_shared(self, share: str) -> None:
        """End a shared forest that another server has taken; its clients are disconnected and come back."""
        forest = self._shared.get(share)
        if forest is not None:
            forest.disconnect_clients()
            self._end(forest)

    def has_table(self, sha256: str) -> bool:
        """Whether a table is in memory, so that no store need be asked for it."""
        return self._table_cache.has(sha256)

    async def admit(self, plan: Forest, address: str) -> None:
        """Wait until the work for a forest request may be done. SessionError."""
        if plan.mode == "stream":
            self._check_size(plan)
        await self._rates.take(address, work_of(plan))

    async def change_wind(self, forest: LiveForest, wind: Wind, address: str) -> None:
        """Change a forest's wind, as soon as its gusts are computed. SessionError."""
        if forest.lacks(wind):
            await self._rates.take(address, EDDIES_WORK if wind.model == "navier-stokes" else WIND_WORK)
            await asyncio.to_thread(forest.prepare_wind, wind)
        forest.change_wind(wind)

    async def join(self, plan: Forest, wind: WindState, sink: FrameSink, address: str = "") -> Subscription:
        """Subscribe a client to the requested forest. SessionError."""
        if not self._steps(plan):
            plan = replace(plan, trees=np.empty((0, 4), np.float32))  # nothing here asks where they are
        client_buffer = ClientBuffer(
            sink, streams=plan.mode == "stream", stall_s=self._settings.socket_stall_s
        )
        if plan.share is None:
            forest = await self._create(plan, wind, address)
        else:
            # serialised, so that of two concurrent first clients one creates the forest and the other joins
            async with self._join_lock:
                forest = await self._join_shared(plan.share, plan, wind, address)
        forest.add(client_buffer, asyncio.get_running_loop().time())
        return Subscription(forest, client_buffer)

    def leave(self, subscription: Subscription) -> None:
        """End a subscription. A private forest ends with it, a shared one after `shared_forest_idle_s`."""
        forest = subscription.forest
        forest.clients.discard(subscription.client_buffer)
        forest.release(subscription.client_buffer)
        if forest.clients:
            return
        if forest.share is None:
            self._end(forest)
        else:
            self._end_later(forest)

    async def _join_shared(self, share: str, plan: Forest, wind: WindState, address: str) -> LiveForest:
        forest = self._shared.get(share)
        if forest is None:
            self._evict_empty_forest()
            forest = await self._create(plan, wind, address)
            self._shared[share] = forest
            return forest
        empty = not forest.plan.groups and bool(plan.groups)
        if empty or (plan.replant and not forest.same_trees(plan)):
            await self._replant(forest, plan, address)
        elif plan.mode == "stream":
            self._check_size(forest.plan)
            if forest.needs_stepper:
                await self._start_simulation(forest, plan, address)
        return forest

    def _steps(self, plan: Forest) -> bool:
        """Whether a forest is small enough to be stepped here. Larger ones are played by their clients."""
        return plan.tree_count <= self._settings.forest_trees

    def _check_size(self, plan: Forest) -> None:
        """SessionError if a forest cannot be streamed because it is played by its clients."""
        if not self._steps(plan):
            count, most = plan.tree_count, self._settings.forest_trees
            raise SessionError(
                "too-many-trees",
                f"A forest of {count:,} trees is played by the browsers: up to {most:,} are streamed",
                'Request mode "table", and compute the motion from the tables.',
            )

    async def _start_simulation(self, forest: LiveForest, plan: Forest, address: str) -> None:
        """Start the simulation for the first streaming client, with the forest's trees.

        If the forest does not know their places, the client's trees have them, unless they are others.
        """
        source = forest.plan if len(forest.plan.trees) else plan
        if source.groups and forest.is_described_by(source):
            forest.simulate(source.trees, await self._stepper(forest, source, address))

    async def _replant(self, forest: LiveForest, plan: Forest, address: str) -> None:
        simulated = plan.mode == "stream" or (forest.streamed and len(plan.trees) > 0)
        forest.replant(plan, await self._stepper(forest, plan, address) if simulated else None)
        if not simulated:
            self._budget.restore(forest, None)
            forest.disconnect_clients(streaming=True)  # when they come back, they hear how it is played

    async def _create(self, plan: Forest, wind: WindState, address: str) -> LiveForest:
        from galewood_server.stream.forest import ForestClock

        clock = ForestClock(wind, plan.time_s)
        forest = LiveForest(plan, clock, asyncio.get_running_loop().time())
        if plan.mode == "stream" and plan.groups:
            forest.set_stepper(await self._stepper(forest, plan, address))
        min(self._workers, key=lambda worker: (worker.tree_count, len(worker.forests))).add(forest)
        return forest

    async def _stepper(self, forest: LiveForest, plan: Forest, address: str) -> ForestStepper:
        before = self._budget.held(forest)
        self._budget.reserve(forest, address, len(plan.trees))
        try:
            return await asyncio.to_thread(
                lambda: forest.make_stepper(self._tables(plan), plan, self._compliances(plan))
            )
        except BaseException:
            self._budget.restore(forest, before)
            raise

    def _compliances(self, plan: Forest) -> list[Compliance | None]:
        return [self._compliance(group.table) for group in plan.groups]

    def _compliance(self, table_sha256: str) -> Compliance | None:
        sha256 = self._compliance_of(table_sha256)
        try:
            return self._table_cache.take_compliance(sha256) if sha256 else None
        except (FileNotFoundError, DamagedFileError, TableError) as error:
            log.warning("a compliance file is missing or unreadable: %s", error)
            return None

    def _tables(self, plan: Forest) -> list[Table]:
        try:
            if plan.method == "paper":
                return [self._with_records(group.table) for group in plan.groups]
            return [self._table_cache.take(group.table) for group in plan.groups]
        except (FileNotFoundError, DamagedFileError, TableError) as error:
            log.warning("a table is missing or unreadable: %s", error)
            raise SessionError("no-such-table", "A table of this forest is missing or unreadable") from None

    def _with_records(self, table_sha256: str) -> Table:
        table = self._table_cache.take(table_sha256, self._records_of(table_sha256))
        if table.paper is None:
            raise SessionError(
                "no-records",
                "The paper's method is still being computed for this tree",
                "Wait until its job is done, or choose the default method.",
                TRY_AGAIN_LATER,
            )
        return table

    def _evict_empty_forest(self) -> None:
        if len(self._shared) < self._settings.shared_forests:
            return
        for forest in list(self._shared.values()):
            if not forest.clients:
                self._end(forest)
                return
        raise SessionError(
            "too-many-forests", "This server has reached its limit of shared forests", "", TRY_AGAIN_LATER
        )

    def _end_later(self, forest: LiveForest) -> None:
        loop = asyncio.get_running_loop()
        forest.empty_since_s = loop.time()
        loop.call_later(self._settings.shared_forest_idle_s, self._end_if_empty, forest)

    def _end_if_empty(self, forest: LiveForest) -> None:
        if forest.clients:
            return
        now_s = asyncio.get_running_loop().time()
        if self._join_lock.locked():  # a client may be about to join it
            self._end_later(forest)
        elif now_s - forest.empty_since_s >= self._settings.shared_forest_idle_s - 0.01:
            self._end(forest)

    def _end(self, forest: LiveForest) -> None:
        self._budget.restore(forest, None)
        for worker in self._workers:
            worker.forests.discard(forest)
        if forest.share is not None and self._shared.get(forest.share) is forest:
            del self._shared[forest.share]

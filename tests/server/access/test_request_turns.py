"""Requests begin one after the other, not while frames are computed and sent, and addresses take turns."""

from __future__ import annotations

import asyncio
from collections.abc import Coroutine
from concurrent.futures import ThreadPoolExecutor
from typing import Any, cast

from galewood_server.access import RequestTurns
from galewood_server.access.request_turns import LONGEST_S
from galewood_server.stream.live_forest import LiveForest
from galewood_server.stream.step_workers import StepWorker
from starlette.types import Receive, Scope, Send


class Requests:
    """Requests to an application that notes who begins, in which turn of the event loop."""

    def __init__(self) -> None:
        self.frames_in_work = False
        self.began: list[str] = []
        self.turns: list[int] = []
        self._turn = 0
        self._app = RequestTurns(self._begin, lambda: self.frames_in_work)

    async def _begin(self, scope: Scope, receive: Receive, send: Send) -> None:
        self.began.append(scope["name"])
        self.turns.append(self._turn)

    def start(self, address: str, name: str, kind: str = "http") -> asyncio.Task[None]:
        scope = {"type": kind, "client": (address, 1), "name": name}

        async def unused(*arguments: Any) -> Any:
            raise AssertionError(arguments)

        return asyncio.create_task(self._app(scope, unused, unused))

    async def count_turns(self) -> None:
        while True:
            self._turn += 1
            await asyncio.sleep(0)

    def run(self, work: Coroutine[Any, Any, None]) -> None:
        async def counted() -> None:
            counting = asyncio.create_task(self.count_turns())
            await work
            counting.cancel()

        asyncio.run(counted())


def test_one_request_begins_in_a_turn_of_the_loop() -> None:
    of = Requests()

    async def work() -> None:
        await asyncio.gather(*(of.start("10.0.0.1", str(k)) for k in range(5)))
        await asyncio.sleep(0.01)
        await of.start("10.0.0.1", "later")

    of.run(work())
    assert of.began == ["0", "1", "2", "3", "4", "later"]
    assert len(set(of.turns)) == 6


def test_no_request_begins_while_frames_are_in_work() -> None:
    of = Requests()

    async def work() -> None:
        of.frames_in_work = True
        waiting = [of.start("10.0.0.1", str(k), kind) for k, kind in enumerate(("http", "websocket"))]
        await asyncio.sleep(0)
        await asyncio.sleep(0)
        assert not of.began
        of.frames_in_work = False
        await asyncio.gather(*waiting)

    of.run(work())
    assert of.began == ["0", "1"]


def test_streams_that_are_never_done_leave_turns_to_requests() -> None:
    of = Requests()
    spent_s = 0.0

    async def work() -> None:
        nonlocal spent_s
        of.frames_in_work = True
        begin_s = asyncio.get_running_loop().time()
        await asyncio.gather(*(of.start("10.0.0.1", str(k)) for k in range(4)))
        spent_s = asyncio.get_running_loop().time() - begin_s

    of.run(work())
    assert of.began == ["0", "1", "2", "3"]
    assert spent_s > 3 * LONGEST_S


def test_addresses_take_turns() -> None:
    of = Requests()

    async def work() -> None:
        many = [of.start("10.0.0.1", f"many {k}") for k in range(6)]
        few = [of.start(f"10.0.0.{k}", f"one of {k}") for k in (2, 3)]
        await asyncio.gather(*many, *few)

    of.run(work())
    assert of.began[0] == "many 0"
    assert {"one of 2", "one of 3"} < set(of.began[:4])
    assert [name for name in of.began if name.startswith("many")] == [f"many {k}" for k in range(6)]


def test_a_request_that_is_cancelled_takes_no_turn() -> None:
    of = Requests()

    async def work() -> None:
        tasks = [of.start("10.0.0.1", str(k)) for k in range(4)]
        await asyncio.sleep(0)
        tasks[2].cancel()
        await asyncio.gather(*tasks, return_exceptions=True)
        await of.start("10.0.0.2", "next")

    of.run(work())
    assert of.began == ["0", "1", "3", "next"]


def test_other_events_need_no_turn() -> None:
    of = Requests()

    async def work() -> None:
        of.frames_in_work = True
        await of.start("10.0.0.1", "start of the server", "lifespan")

    of.run(work())
    assert of.began == ["start of the server"]


class WatchedForest:
    """Notes whether the frames count as in work while they are computed and sent."""

    tree_count = 1

    def __init__(self, worker: StepWorker) -> None:
        self._worker = worker
        self.seen: list[bool] = []

    def compute(self, made_s: float) -> None:
        self.seen.append(self._worker.in_work)

    def deliver(self, now_s: float) -> None:
        self.seen.append(self._worker.in_work)
        self._worker.forests.clear()


def test_frames_are_in_work_until_they_are_sent() -> None:
    async def work() -> list[bool]:
        with ThreadPoolExecutor(1) as threads:
            worker = StepWorker(threads)
            forest = WatchedForest(worker)
            worker.add(cast(LiveForest, forest))
            before = worker.in_work
            while worker.forests:
                await asyncio.sleep(0.005)
            await asyncio.sleep(0)
            return [before, *forest.seen, worker.in_work]

    assert asyncio.run(work()) == [False, True, True, False]

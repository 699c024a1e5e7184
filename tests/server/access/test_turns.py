"""Heavy work on demand: made once for all who ask, few at once, few waiting."""

from __future__ import annotations

import asyncio
import os
import threading
from pathlib import Path

import anyio
import pytest
from galewood.util import MeshError
from galewood_server.access import FilesOnDemand, Turns
from galewood_server.http import ProblemError
from starlette.requests import HTTPConnection


def request(address: str) -> HTTPConnection:
    return HTTPConnection({"type": "http", "client": (address, 1), "headers": []})


class Work:
    """Writes a file once it may, and counts how often it was asked to."""

    def __init__(self, target: Path, error: Exception | None = None) -> None:
        self.target = target
        self.count = 0
        self.may_end = threading.Event()
        self._error = error

    def __call__(self) -> None:
        self.count += 1
        assert self.may_end.wait(60)
        if self._error:
            raise self._error
        self.target.touch()


def started(files: FilesOnDemand, work: Work, *addresses: str) -> list[asyncio.Task[None]]:
    return [asyncio.create_task(files.have(work.target, request(address), work)) for address in addresses]


async def settled() -> None:
    """Let every task run until it waits for something else."""
    for _ in range(10):
        await asyncio.sleep(0)


def test_a_file_is_made_once_for_all_even_if_the_first_client_leaves(tmp_path: Path) -> None:
    async def run() -> None:
        files, work = FilesOnDemand("files", 8, 8), Work(tmp_path / "a")
        first, *others = started(files, work, "10.0.0.1", "10.0.0.2", "10.0.0.3")
        await settled()
        first.cancel()
        work.may_end.set()
        await asyncio.gather(*others)
        await files.have(work.target, request("10.0.0.4"), work)
        assert work.count == 1

    anyio.run(run)


def test_one_file_is_made_at_a_time(tmp_path: Path) -> None:
    async def run() -> None:
        files = FilesOnDemand("files", 8, 8)
        works = [Work(tmp_path / name) for name in "abc"]
        tasks = [task for work in works for task in started(files, work, "10.0.0.1")]
        for number, work in enumerate(works):
            while not work.count:
                await asyncio.sleep(0.001)
            assert [other.count for other in works[number + 1 :]] == [0] * (len(works) - number - 1)
            work.may_end.set()
        await asyncio.gather(*tasks)

    anyio.run(run)


def test_few_requests_wait_and_fewer_of_one_address(tmp_path: Path) -> None:
    async def run() -> None:
        files, work = FilesOnDemand("files", 3, 2), Work(tmp_path / "a")
        tasks = started(files, work, "10.0.0.1", "10.0.0.1")
        await settled()
        with pytest.raises(ProblemError) as refused:
            await files.have(work.target, request("10.0.0.1"), work)
        assert refused.value.problem.status == 503 and refused.value.headers
        assert "Retry-After" in refused.value.headers
        tasks += started(files, work, "10.0.0.2")
        await settled()
        with pytest.raises(ProblemError):
            await files.have(work.target, request("10.0.0.3"), work)
        work.may_end.set()
        await asyncio.gather(*tasks)
        another = Work(tmp_path / "b")
        another.may_end.set()
        await files.have(another.target, request("10.0.0.1"), another)

    anyio.run(run)


def test_what_cannot_be_made_is_not_tried_again_and_again(tmp_path: Path) -> None:
    async def run() -> None:
        files = FilesOnDemand("files", 8, 8)
        work = Work(tmp_path / "a", MeshError("bad", "malformed", "It is bad."))
        work.may_end.set()
        for _ in range(3):
            with pytest.raises(MeshError):
                await files.have(work.target, request("10.0.0.1"), work)
        assert work.count == 1
        full = Work(tmp_path / "b", OSError("no space"))
        full.may_end.set()
        for _ in range(2):
            with pytest.raises(OSError, match="no space"):
                await files.have(full.target, request("10.0.0.1"), full)
        assert full.count == 2

    anyio.run(run)


def test_few_requests_wait_for_a_turn() -> None:
    async def run() -> None:
        turns, may_end = Turns("imports", at_once=1, most_waiting=1), asyncio.Event()

        async def work() -> None:
            async with turns.taken():
                await may_end.wait()

        tasks = [asyncio.create_task(work()) for _ in range(2)]
        await settled()
        with pytest.raises(ProblemError) as refused:
            await work()
        assert refused.value.problem.code == "busy"
        may_end.set()
        await asyncio.gather(*tasks)
        await work()

    anyio.run(run)


def test_requests_that_are_received_count_and_few_of_one_address() -> None:
    async def run() -> None:
        turns = Turns("conversions", at_once=1, most_waiting=2, most_of_address=2)
        may_end, at_work = asyncio.Event(), 0

        async def work(address: str) -> None:
            nonlocal at_work
            async with turns.admitted(request(address)) as slots:
                await may_end.wait()  # the body arrives
                async with slots:
                    at_work += 1
                    assert at_work == 1
                    await settled()
                    at_work -= 1

        tasks = [asyncio.create_task(work("10.0.0.1")) for _ in range(2)]
        await settled()
        with pytest.raises(ProblemError) as refused:
            await work("10.0.0.1")
        assert refused.value.problem.code == "busy"
        tasks.append(asyncio.create_task(work("10.0.0.2")))
        await settled()
        with pytest.raises(ProblemError):
            await work("10.0.0.3")
        may_end.set()
        await asyncio.gather(*tasks)
        await work("10.0.0.1")

    anyio.run(run)


def test_of_some_files_only_the_newest_are_kept(tmp_path: Path) -> None:
    async def run() -> None:
        files = FilesOnDemand("files", 8, 8, kept=2)
        for age, name in enumerate("abcd"):
            work = Work(tmp_path / name)
            work.may_end.set()
            await files.have(work.target, request("10.0.0.1"), work)
            os.utime(work.target, (age, age))
        assert sorted(path.name for path in tmp_path.iterdir()) == ["c", "d"]

    anyio.run(run)

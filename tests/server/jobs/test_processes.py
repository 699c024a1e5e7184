"""Child processes of the service end with whoever started them."""

from __future__ import annotations

import asyncio
from typing import Any

import psutil
import pytest
from galewood_server.jobs import processes
from galewood_server.jobs.processes import start_module

from tests.server.support.server_process import wait_until


def children() -> list[psutil.Process]:
    return psutil.Process().children(recursive=True)


def test_a_process_that_starts_while_its_caller_is_cancelled_is_ended(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    create, exists = asyncio.create_subprocess_exec, asyncio.Event()

    async def created_slowly(*arguments: Any, **options: Any) -> asyncio.subprocess.Process:
        process = await create(*arguments, **options)
        exists.set()
        await asyncio.sleep(0.2)
        return process

    monkeypatch.setattr(asyncio, "create_subprocess_exec", created_slowly)

    async def cancelled_while_it_starts() -> None:
        task = asyncio.create_task(start_module("code", environment={}))  # waits for commands
        await exists.wait()
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task

    before = {process.pid for process in children()}
    asyncio.run(cancelled_while_it_starts())
    assert not [process for process in children() if process.pid not in before]


def test_a_frozen_guard_is_killed_with_its_program(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(processes, "FROZEN_S", 0.1)

    async def stopped_while_frozen() -> list[psutil.Process]:
        process = await start_module("code", environment={})
        guard = psutil.Process(process.pid)
        family = await asyncio.to_thread(wait_until, guard.children)
        guard.suspend()
        await process.stop()
        return family

    family = asyncio.run(stopped_while_frozen())
    psutil.wait_procs(family, 60)
    assert not any(one.is_running() for one in family)


def test_lines_reach_the_program() -> None:
    async def talk() -> bytes:
        process = await start_module("code", "-q", environment={}, listen=True)
        process.send_line("print(6 * 7)")
        line = await process.read_line()
        await process.stop()
        return line

    assert asyncio.run(talk()) == b">>> 42\n"

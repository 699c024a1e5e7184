"""Child processes of the service end with whoever started them."""

from __future__ import annotations

import asyncio
from typing import Any

import psutil
import pytest
from galewood_server.jobs.processes import start_module


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
        task = asyncio.create_task(start_module("pdb", environment={}))  # waits for commands
        await exists.wait()
        task.cancel()
        with pytest.raises(asyncio.CancelledError):
            await task

    before = {process.pid for process in children()}
    asyncio.run(cancelled_while_it_starts())
    assert not [process for process in children() if process.pid not in before]

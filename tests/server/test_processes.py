"""Child processes of the service end with whoever started them."""

from __future__ import annotations

import asyncio
import subprocess
import sys
from pathlib import Path
from typing import Any

import psutil
import pytest
from galewood_server.jobs.processes import kill_tree, start_module

from tests.server.conftest import wait_until


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


STARTING = """
import subprocess, sys, time
{first}
# like a process that multiprocessing spawns: it reads from its parent what it is to do
child = [sys.executable, "-ISc", "import sys; sys.stdin.read(1) or sys.exit('the parent has gone')"]
children = [subprocess.Popen(child, stdin=subprocess.PIPE) for _ in range(12)]
print("started", flush=True)
{last}
"""


def starting_children(log: Path, first: str, last: str) -> subprocess.Popen[bytes]:
    """A process whose children all wait for what they are to do; it and they write errors to `log`."""
    with log.open("wb") as errors:
        process = subprocess.Popen(
            [sys.executable, "-c", STARTING.format(first=first, last=last)],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=errors,
        )
    assert process.stdout and process.stdout.readline() == b"started\n"
    return process


def test_children_that_are_starting_are_killed_without_a_word(tmp_path: Path) -> None:
    process = starting_children(tmp_path / "log", "", "time.sleep(600)")
    family = psutil.Process(process.pid).children()
    assert len(family) == 12
    kill_tree(process.pid)
    process.communicate()
    wait_until(lambda: not any(one.is_running() for one in family))
    assert (tmp_path / "log").read_text() == ""


def test_a_process_ends_with_its_parent_while_its_children_start(tmp_path: Path) -> None:
    first = "from galewood_server.jobs.processes import die_with_parent; die_with_parent()"
    more = "while not time.sleep(0.02): children.append(subprocess.Popen(child, stdin=subprocess.PIPE))"
    process = starting_children(tmp_path / "log", first, more)
    family = psutil.Process(process.pid).children()
    process.communicate()  # closes its standard input and waits
    wait_until(lambda: not any(one.is_running() for one in family))
    assert (tmp_path / "log").read_text() == ""

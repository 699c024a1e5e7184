"""Child processes that end with their parent, including their own children."""

from __future__ import annotations

import asyncio
import os
import sys
import threading
from concurrent.futures import Future
from contextlib import suppress
from pathlib import Path
from typing import NoReturn

import psutil
from galewood.threads import SINGLE_THREADED

NICENESS = 10
"""Of child processes, so that streams go on beside them; from the start, because imports take seconds."""
LOWER = 5
"""By how much `lower_priority` lowers it."""
SEARCHES = 10
"""How often descendants are searched at most: once finds them all, unless they start new ones meanwhile."""


def kill_tree(pid: int) -> None:
    """Kill a process and its descendants.

    All are stopped first, from the parent down, so that none starts new ones and none notices the end of
    another: a child that is just starting reads from its parent, and would otherwise report a broken pipe.
    """
    with suppress(psutil.NoSuchProcess):
        process = psutil.Process(pid)
        process.suspend()
        _kill_descendants(process)
        process.kill()


def _kill_descendants(process: psutil.Process) -> None:
    """Suspend all descendants of a process, also those that start meanwhile, then kill the youngest first."""
    found: dict[psutil.Process, None] = {}
    for _ in range(SEARCHES):
        new = [one for one in process.children(recursive=True) if one not in found]
        if not new:
            break
        for one in new:
            found[one] = None
            with suppress(psutil.NoSuchProcess):
                one.suspend()
    for one in reversed(found):
        with suppress(psutil.NoSuchProcess):
            one.kill()


def _end_with_descendants() -> NoReturn:
    """Kill the descendants of this process, then end it.

    Other threads go on meanwhile and may start further processes. Those find no parent when they start, so
    what they write to standard error is of no interest.
    """
    with Path(os.devnull).open("w") as nowhere:
        os.dup2(nowhere.fileno(), 2)
    _kill_descendants(psutil.Process())
    os._exit(1)


def die_with_parent() -> Future[str]:
    """In a child process: exit with all descendants when the parent closes standard input or dies.

    The result is the first line that the parent sends (`send_line`).
    """
    line: Future[str] = Future()

    def watch() -> None:
        received = b""
        while chunk := os.read(0, 1024):
            received += chunk
            if b"\n" in received and not line.done():
                line.set_result(received.partition(b"\n")[0].decode())
        _end_with_descendants()

    threading.Thread(target=watch, name="die-with-parent", daemon=True).start()
    return line


def lower_priority() -> None:
    """Lower the priority of this process and of its children further."""
    this = psutil.Process()
    for process in (this, *this.children(recursive=True)):
        try:
            process.nice(min(process.nice() + LOWER, 19))
        except psutil.NoSuchProcess:
            continue


def send_line(process: asyncio.subprocess.Process, text: str) -> None:
    """Send a line to a child process, unless it has ended."""
    if process.returncode is None and process.stdin and not process.stdin.is_closing():
        process.stdin.write(text.encode() + b"\n")


async def start_module(
    module: str, *arguments: str, environment: dict[str, str], listen: bool = False
) -> asyncio.subprocess.Process:
    """Start `python -m module` at low priority in a new session, so that Ctrl-C reaches only the server.

    Its standard output is piped if `listen`, otherwise discarded; standard error is inherited. A process that
    starts while the caller is cancelled is ended again.
    """
    starting = asyncio.ensure_future(
        asyncio.create_subprocess_exec(
            "nice",
            f"-n{NICENESS}",
            sys.executable,
            "-m",
            module,
            *arguments,
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE if listen else asyncio.subprocess.DEVNULL,
            env={**environment, **SINGLE_THREADED},
            start_new_session=True,
        )
    )
    try:
        return await asyncio.shield(starting)
    except asyncio.CancelledError:
        await stop(await starting)
        raise


async def stop(process: asyncio.subprocess.Process, patience_s: float = 0.0) -> None:
    """End a child process by closing its standard input; kill it after `patience_s`."""
    if process.returncode is None and process.stdin:
        process.stdin.close()
    try:
        async with asyncio.timeout(patience_s):
            await process.wait()
    except TimeoutError:
        kill_tree(process.pid)
        await process.wait()

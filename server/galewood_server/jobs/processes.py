"""Child processes that never outlive their parent, and parents that leave no grandchildren behind."""

from __future__ import annotations

import asyncio
import os
import sys
import threading

import psutil
from galewood.threads import SINGLE_THREADED


def kill_tree(pid: int) -> None:
    """Kill a process and everything it started, the parent first so that it starts nothing more."""
    try:
        process = psutil.Process(pid)
        family = [process, *process.children(recursive=True)]
    except psutil.NoSuchProcess:
        return
    for member in family:
        try:
            member.kill()
        except psutil.NoSuchProcess:
            continue


def die_with_parent() -> None:
    """In a child: when the parent closes our standard input, by will or by death, end with our children."""

    def watch() -> None:
        while os.read(0, 1024):
            pass
        for child in psutil.Process().children(recursive=True):
            try:
                child.kill()
            except psutil.NoSuchProcess:
                continue
        os._exit(1)

    threading.Thread(target=watch, name="die-with-parent", daemon=True).start()


async def start_module(
    module: str, *arguments: str, environment: dict[str, str], listen: bool = False
) -> asyncio.subprocess.Process:
    """Start `python -m module` in a session of its own, so that a Ctrl-C reaches only the server.

    Its output is read by us if `listen`, else thrown away (mesh libraries chatter); its errors go to our log.
    """
    return await asyncio.create_subprocess_exec(
        sys.executable,
        "-m",
        module,
        *arguments,
        stdin=asyncio.subprocess.PIPE,
        stdout=asyncio.subprocess.PIPE if listen else asyncio.subprocess.DEVNULL,
        env={**environment, **SINGLE_THREADED},
        start_new_session=True,
    )


async def stop(process: asyncio.subprocess.Process, patience_s: float = 0.0) -> None:
    """End a child: by closing its input, and after `patience_s` by force."""
    if process.returncode is None and process.stdin:
        process.stdin.close()
    try:
        async with asyncio.timeout(patience_s):
            await process.wait()
    except TimeoutError:
        kill_tree(process.pid)
        await process.wait()

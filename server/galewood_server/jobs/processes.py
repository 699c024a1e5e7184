"""Child processes of the service: jobs and the cluster, which end with the server."""

from __future__ import annotations

import asyncio
import sys
from contextlib import suppress

import psutil
from galewood.threads import SINGLE_THREADED
from galewood.util import FROZEN_S, Lifeline

CHILD_NICENESS = 10
"""Of child processes, so that streams go on beside them; from the start, because imports take seconds."""
PRIORITY_DECREASE = 5
"""By how much `lower_priority` lowers it."""


class ChildProcess:
    """A running program below a guard (galewood.util.guard)."""

    def __init__(self, guard: asyncio.subprocess.Process, lifeline: Lifeline) -> None:
        self._guard = guard
        self._lifeline = lifeline

    @property
    def pid(self) -> int:
        """The process id of the guard, the parent of the program."""
        return self._guard.pid

    @property
    def returncode(self) -> int | None:
        """The exit code of the program, or minus its signal; None while it runs."""
        return self._guard.returncode

    async def wait(self) -> None:
        """Wait until the program has ended."""
        await self._guard.wait()

    async def read_line(self) -> bytes:
        """The next line of its standard output (`listen`)."""
        assert self._guard.stdout
        return await self._guard.stdout.readline()

    def send_line(self, text: str) -> None:
        """Send a line to its standard input, unless it has ended."""
        stdin = self._guard.stdin
        if self.returncode is None and stdin and not stdin.is_closing():
            stdin.write(text.encode() + b"\n")

    async def stop(self) -> None:
        """End the program and its descendants; afterwards none of them is left."""
        self._lifeline.close()
        try:
            async with asyncio.timeout(FROZEN_S):
                await self._guard.wait()
        except TimeoutError:
            with suppress(ProcessLookupError):
                self._guard.kill()
            await self._guard.wait()


async def start_module(
    module: str, *arguments: str, environment: dict[str, str], listen: bool = False
) -> ChildProcess:
    """Start `python -m module` at low priority in a new session, so that Ctrl-C reaches only the server.

    Its standard output is piped if `listen`, otherwise discarded; standard error is inherited. A process that
    starts while the caller is cancelled is ended again.
    """
    lifeline = Lifeline()
    starting = asyncio.ensure_future(
        asyncio.create_subprocess_exec(
            *lifeline.command([sys.executable, "-m", module, *arguments], CHILD_NICENESS),
            stdin=asyncio.subprocess.PIPE,
            stdout=asyncio.subprocess.PIPE if listen else asyncio.subprocess.DEVNULL,
            env={**environment, **SINGLE_THREADED},
            start_new_session=True,
            pass_fds=(lifeline.read_end,),
        )
    )
    try:
        guard = await asyncio.shield(starting)
    except asyncio.CancelledError:
        await ChildProcess(await starting, lifeline).stop()
        raise
    lifeline.started()
    return ChildProcess(guard, lifeline)


def lower_priority() -> None:
    """Lower the priority of this process and of its children further."""
    this = psutil.Process()
    for process in (this, *this.children(recursive=True)):
        try:
            process.nice(min(process.nice() + PRIORITY_DECREASE, 19))
        except psutil.NoSuchProcess:
            continue

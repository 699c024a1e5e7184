"""Starts child processes that end with this process, whatever ends it, and with them all that they started.

This is the one way in which the library and the service start programs; see guard.py for how it is done.
"""

from __future__ import annotations

import os
import select
import stat
import subprocess
import sys
import threading
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from types import TracebackType
from typing import IO, ClassVar, Self
from weakref import WeakSet

import psutil

FROZEN_S = 30.0
"""Time after which a guard that does not end is frozen, and killed, s; it ends within a second."""
GUARD_SCRIPT = Path(__file__).with_name("guard.py")


class Lifeline:
    """The pipe whose end tells a guard to end its descendants: `read_end` is for the guard alone.

    Closed when nothing refers to it any more, when it is told so, and by the kernel when this process ends.
    """

    def __init__(self) -> None:
        self.read_end, self._write_end = os.pipe()

    def command(self, program: Sequence[str], niceness: int = 0) -> list[str]:
        """The command of a guard that runs `program`; it must inherit `read_end` (`pass_fds`)."""
        return [sys.executable, "-IS", str(GUARD_SCRIPT), str(self.read_end), str(niceness), *program]

    def started(self) -> None:
        """Close the guard's end in this process."""
        if self.read_end >= 0:
            os.close(self.read_end)
            self.read_end = -1

    def close(self) -> None:
        """Let the guard end its descendants."""
        self.started()
        if self._write_end >= 0:
            os.close(self._write_end)
            self._write_end = -1

    def __del__(self) -> None:
        self.close()


class AbortedError(RuntimeError):
    """`GuardedProcess.end_all` has ended the process that a thread was waiting for."""


class GuardedProcess:
    """A program and its descendants, which end with the ``with`` block."""

    _running: ClassVar[WeakSet[GuardedProcess]] = WeakSet()
    _lock: ClassVar[threading.Lock] = threading.Lock()

    def __init__(
        self,
        program: Sequence[str],
        *,
        cwd: Path,
        environment: Mapping[str, str],
        errors: IO[bytes],
        conversing: bool = False,
    ) -> None:
        """Start a program in a new session; standard error goes to a file.

        Its standard input and output are pipes if it is ``conversing``; otherwise it has neither.
        """
        self._broken_off = False
        self._lifeline = Lifeline()
        ends = subprocess.PIPE if conversing else subprocess.DEVNULL
        try:
            self._guard = subprocess.Popen(
                self._lifeline.command(program), cwd=cwd, env=environment, stdin=ends, stdout=ends,
                stderr=errors, start_new_session=True, pass_fds=(self._lifeline.read_end,), bufsize=0,
            )  # fmt: skip
        except BaseException:
            self._lifeline.close()
            raise
        self._lifeline.started()
        with self._lock:
            self._running.add(self)

    def send_line(self, text: str) -> None:
        """Send a line to a conversing program. BrokenPipeError if it has ended."""
        assert self._guard.stdin
        self._guard.stdin.write(text.encode() + b"\n")

    def read_line(self, timeout_s: float) -> str:
        """The next line of a conversing program, which is short and written as a whole; empty: it has ended.

        subprocess.TimeoutExpired.
        """
        assert self._guard.stdout
        if not select.select([self._guard.stdout], [], [], timeout_s)[0]:
            raise subprocess.TimeoutExpired(self._guard.args, timeout_s)
        return self._guard.stdout.readline().decode()

    def wait(self, timeout_s: float) -> int:
        """The exit code, or minus the number of the signal that ended it.

        subprocess.TimeoutExpired; AbortedError after `end_all`.
        """
        code = self._guard.wait(timeout_s)
        if self._broken_off:
            raise AbortedError
        return code

    def unlinked_bytes(self) -> int:
        """Size of the files without a name that the program and its descendants hold open."""
        return sum(
            _unlinked_bytes(one.pid) for one in psutil.Process(self._guard.pid).children(recursive=True)
        )

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> None:
        """End the program and its descendants; afterwards none of them is left."""
        with self._lock:
            self._lifeline.close()
            self._running.discard(self)
        try:
            self._guard.wait(FROZEN_S)
        except subprocess.TimeoutExpired:
            self._guard.kill()
            self._guard.wait()
        for end in (self._guard.stdin, self._guard.stdout):
            if end:
                end.close()

    @classmethod
    def end_all(cls) -> None:
        """End those that threads of this process wait for now; none of them is left afterwards."""
        with cls._lock:
            running = list(cls._running)
        for one in running:
            one._broken_off = True
            one.close()


def _unlinked_bytes(pid: int) -> int:
    total = 0
    with suppress(OSError):  # it has just ended, or there is no /proc
        for descriptor in Path(f"/proc/{pid}/fd").iterdir():
            with suppress(OSError):  # closed meanwhile
                file = descriptor.stat()
                total += file.st_size if stat.S_ISREG(file.st_mode) and file.st_nlink == 0 else 0
    return total

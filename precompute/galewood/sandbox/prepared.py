"""Functions that a process keeps loaded, so that a call need not wait for the libraries."""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
import threading
from pathlib import Path

from galewood.sandbox.arrays import Arrays
from galewood.sandbox.limited_process import (
    TIMED_OUT,
    TOO_MUCH_WRITTEN,
    Ended,
    Limits,
    end_of_stderr,
    environment_in,
    in_folder,
    run_child,
    run_limited,
    wait_limited,
)
from galewood.util import FROZEN_S, GuardedProcess


class PreparedFunction:
    """``run_limited`` of one function in forks of a process that has loaded it (fork_server.py).

    One call at a time: a call meanwhile, or before ``prepare``, starts a process of its own. Thread-safe.
    """

    def __init__(self, target: str) -> None:
        """``target``: "module:function", of a module with a function ``warm_up``."""
        self._target = target
        self._turn = threading.Lock()
        self._server: GuardedProcess | None = None

    def prepare(self) -> None:
        """Start the process that loads the function, unless it runs."""
        with self._turn:
            self._server = self._server or self._start()

    def _start(self) -> GuardedProcess:
        program = [sys.executable, "-m", "galewood.sandbox.fork_server", self._target]
        folder = Path(tempfile.gettempdir())
        with open(2, "wb", closefd=False) as errors:
            return GuardedProcess(
                program, cwd=folder, environment=environment_in(folder), errors=errors, conversing=True
            )

    def run(self, arguments: Arrays, limits: Limits, *, what: str) -> Arrays:
        """Call the function; raises as ``run_limited``."""
        if not self._turn.acquire(blocking=False):
            return run_limited(self._target, arguments, limits, what=what)
        try:
            return in_folder(lambda folder: self._ask(folder, limits), arguments, limits, what)
        finally:
            self._turn.release()

    def _ask(self, folder: Path, limits: Limits) -> Ended:
        if (server := self._server) is None:
            return run_child(self._target, folder, limits)

        def answer(timeout_s: float) -> int:
            line = server.read_line(timeout_s)
            if not line:
                server.wait(FROZEN_S)  # raises AbortedError if it was ended on purpose
                raise BrokenPipeError
            return int(line)

        request = {"folder": str(folder), "memory_bytes": limits.memory_bytes, "cpu_s": limits.cpu_s}
        try:
            server.send_line(json.dumps(request))
            code = wait_limited(answer, server, folder, limits)
        except (BrokenPipeError, ValueError, subprocess.TimeoutExpired):  # it has ended, for want of memory
            self._end(server)
            return run_child(self._target, folder, limits)
        if code in (TIMED_OUT, TOO_MUCH_WRITTEN):
            self._end(server)
            self._server = self._start()
        return code, end_of_stderr(folder)

    def _end(self, server: GuardedProcess) -> None:
        server.close()
        self._server = None

    def close(self) -> None:
        """End the process."""
        with self._turn:
            if self._server:
                self._end(self._server)

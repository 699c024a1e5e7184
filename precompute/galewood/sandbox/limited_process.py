"""Functions run in a child process with limits on memory and CPU time, so that a bad mesh cannot crash the
caller. A wall-time limit stops children that hang; it is so long that a busy machine does not reach it.

The child also ends with the caller, whatever ends that. Arguments and results are passed as arrays in .npz
files (no pickles). The child's current directory is a temporary folder, the only one it may write to, and it
has no network access (on platforms where confinement.py supports this).
"""

from __future__ import annotations

import logging
import os
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from galewood.sandbox.arrays import Arrays
from galewood.sandbox.results import (
    UntrustworthyError,
    open_untrusted,
    read_arrays,
    read_error,
    remove_folder,
    written_bytes,
)
from galewood.util import Cancelled, GuardedProcess, MeshError, shown_text

log = logging.getLogger("galewood.import")

KEPT_ENVIRONMENT = ("PATH", "LANG", "LD_LIBRARY_PATH", "NUMBA_CACHE_DIR", "VIRTUAL_ENV", "SYSTEMROOT")
THREAD_COUNT_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
REFUSED_EXIT_CODE = 3  # exit code if the function raised a MeshError
OUT_OF_MEMORY = 4
TIMED_OUT, TOO_MUCH_WRITTEN = -signal.SIGALRM, -signal.SIGXFSZ
FOLDER_CHECK_S = 1.0
"""Time between two looks at the size of what the child has written, s."""
STDERR_FILE = "stderr"
STDERR_BYTES = 4000
"""How much of the end of the child's standard error is searched for the cause of its end."""
LOGGED_CHARACTERS = 1000
"""How much of that end is logged."""
WALL_S_PER_CPU_S = 10.0  # a child gets at least a tenth of a processor on any machine that is of use


@dataclass(frozen=True)
class Limits:
    """Limits of a child: address space (bytes), CPU time (s) of all threads, wall time (s), files (bytes).

    They are limits of all that the child does, because it cannot start processes. Imported libraries alone
    take about 1.5 GB of address space. Without a wall time the child has WALL_S_PER_CPU_S times its CPU time.
    """

    memory_bytes: int = 4 << 30
    cpu_s: int = 120
    wall_s: float | None = None
    folder_bytes: int = 4 << 30

    @property
    def patience_s(self) -> float:
        """Wall time after which the child is stopped."""
        return WALL_S_PER_CPU_S * self.cpu_s if self.wall_s is None else self.wall_s


def run_limited(
    target: str, arguments: Arrays, limits: Limits, *, what: str, wanted: Callable[[], bool] = lambda: True
) -> Arrays:
    """Call `target` ("module:function", Arrays to Arrays) in a child process and return its result.

    Raises the MeshError that the function raised, or a MeshError that says that the child exceeded a limit,
    was killed or crashed; `what` names the work in that message. Once the result is no longer `wanted`, the
    child is ended, and Cancelled raised.
    """
    return in_folder(lambda folder: run_child(target, folder, limits, wanted), arguments, limits, what)


Ended = tuple[int, str]
"""Exit code of a child, and the end of what it wrote to standard error."""


def in_folder(run: Callable[[Path], Ended], arguments: Arrays, limits: Limits, what: str) -> Arrays:
    """The result of a child that `run` runs in a new folder with these arguments; as `run_limited`."""
    folder = Path(tempfile.mkdtemp(prefix="galewood-"))
    try:
        np.savez(folder / "in.npz", allow_pickle=False, **arguments)
        code, stderr = run(folder)
        if code == 0:
            return read_arrays(folder / "out.npz", limits.folder_bytes)
        if code == REFUSED_EXIT_CODE:
            raise read_error(folder / "error.json")
        log.warning(
            "%s ended with exit code %d: %s",
            what,
            code,
            shown_text(stderr[-LOGGED_CHARACTERS:], LOGGED_CHARACTERS),
        )
        raise _failure(code, stderr, limits, what)
    except UntrustworthyError as error:
        raise _crashed(what, f"gave no valid result ({error})") from error
    finally:
        remove_folder(folder)


def run_child(target: str, folder: Path, limits: Limits, wanted: Callable[[], bool] = lambda: True) -> Ended:
    """Run a child of its own in its folder."""
    module = "galewood.sandbox.child"
    program = [sys.executable, "-m", module, target, str(limits.memory_bytes), str(limits.cpu_s)]
    environment = environment_in(folder)
    with (
        (folder / STDERR_FILE).open("w+b") as errors,
        GuardedProcess(program, cwd=folder, environment=environment, errors=errors) as child,
    ):
        code = wait_limited(_while_wanted(child.wait, wanted), child, folder, limits)
    return code, end_of_stderr(folder)


def _while_wanted(wait: Callable[[float], int], wanted: Callable[[], bool]) -> Callable[[float], int]:
    def waited(timeout_s: float) -> int:
        if not wanted():
            raise Cancelled
        return wait(timeout_s)

    return waited


def environment_in(folder: Path) -> dict[str, str]:
    """The environment variables of a child whose home is a folder."""
    environment = {k: os.environ[k] for k in KEPT_ENVIRONMENT if k in os.environ}
    environment |= dict.fromkeys(THREAD_COUNT_VARIABLES, "1")
    return environment | {
        "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
        "HOME": str(folder),
        "PYTHONDONTWRITEBYTECODE": "1",
    }


def end_of_stderr(folder: Path) -> str:
    """The end of what a child in this folder wrote to standard error."""
    with open_untrusted(folder / STDERR_FILE) as errors:
        errors.seek(max(errors.seek(0, os.SEEK_END) - STDERR_BYTES, 0))
        return errors.read(STDERR_BYTES).decode(errors="replace")


def wait_limited(wait: Callable[[float], int], child: GuardedProcess, folder: Path, limits: Limits) -> int:
    """What `wait` returns, which raises TimeoutExpired after its time; or TIMED_OUT, TOO_MUCH_WRITTEN."""
    end_s = time.monotonic() + limits.patience_s
    while (left_s := end_s - time.monotonic()) > 0:
        try:
            return wait(min(FOLDER_CHECK_S, left_s))
        except subprocess.TimeoutExpired:
            if written_bytes(folder) + child.unlinked_bytes() > limits.folder_bytes:
                return TOO_MUCH_WRITTEN
    return TIMED_OUT


def _failure(code: int, stderr: str, limits: Limits, what: str) -> MeshError:
    if code == OUT_OF_MEMORY or "bad_alloc" in stderr or "MemoryError" in stderr:
        megabytes = limits.memory_bytes >> 20
        return MeshError(
            "out-of-memory",
            "unsuitable",
            f"{what} needed more than {megabytes} MB of memory.",
            "Reduce the number of faces and try again.",
        )
    if code == TIMED_OUT:
        return MeshError(
            "timed-out",
            "unsuitable",
            f"{what} took longer than {limits.patience_s:g} s.",
            "Reduce the number of faces and try again.",
        )
    if code == TOO_MUCH_WRITTEN:
        return MeshError(
            "too-much-written",
            "unsuitable",
            f"{what} wrote more than {limits.folder_bytes >> 20} MB of temporary files.",
            "Reduce the number of faces and try again.",
        )
    if code == -signal.SIGXCPU:
        return MeshError(
            "cpu-time",
            "unsuitable",
            f"{what} used more than {limits.cpu_s} s of CPU time.",
            "Reduce the number of faces and try again.",
        )
    if code == -signal.SIGKILL:
        return MeshError(
            "killed",
            "unsuitable",
            f"{what} was stopped by the system, most likely because memory ran out.",
            "Try again with a smaller mesh.",
        )
    how = f"crashed ({signal.strsignal(-code)})" if code < 0 else f"failed (exit code {code})"
    return _crashed(what, how)


def _crashed(what: str, how: str) -> MeshError:
    return MeshError(
        "crashed",
        "unsuitable",
        f"{what} {how}: the file is damaged, or built in a way that its reader cannot handle.",
        "Repair the mesh in a modelling program, export it as GLB (glTF Binary) and try again.",
    )

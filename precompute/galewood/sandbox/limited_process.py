"""Functions run in a child process with limits on memory and CPU time, so that a bad mesh cannot crash the
caller. A wall-time limit stops children that hang; it is so long that a busy machine does not reach it.

Arguments and results are passed as arrays in .npz files (no pickles). The child's current directory is a
temporary folder, the only one it may write to, and it has no network access (on platforms where
confinement.py supports this).
"""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from galewood.util import MeshError

Arrays = dict[str, NDArray[Any]]
KEPT_ENVIRONMENT = ("PATH", "LANG", "LD_LIBRARY_PATH", "NUMBA_CACHE_DIR", "VIRTUAL_ENV", "SYSTEMROOT")
THREAD_COUNT_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
REFUSED = 3  # exit code if the function raised a MeshError
OUT_OF_MEMORY = 4
WALL_S_PER_CPU_S = 10.0  # a child gets at least a tenth of a processor on any machine that is of use


@dataclass(frozen=True)
class Limits:
    """Resource limits of a child: address space (bytes), CPU time of all threads (s), wall time (s).

    Imported libraries alone take about 1.5 GB of address space. Without a wall time the child has
    WALL_S_PER_CPU_S times its CPU time.
    """

    memory_bytes: int = 4 << 30
    cpu_s: int = 120
    wall_s: float | None = None

    @property
    def patience_s(self) -> float:
        """Wall time after which the child is stopped."""
        return WALL_S_PER_CPU_S * self.cpu_s if self.wall_s is None else self.wall_s


def run_limited(target: str, arguments: Arrays, limits: Limits, *, what: str) -> Arrays:
    """Call `target` ("module:function", Arrays to Arrays) in a child process and return its result.

    Raises the MeshError that the function raised, or a MeshError that says that the child exceeded a limit,
    was killed or crashed; `what` names the work in that message.
    """
    with tempfile.TemporaryDirectory(prefix="galewood-") as folder:
        np.savez(Path(folder, "in.npz"), allow_pickle=False, **arguments)
        code, stderr = _wait(_start(target, Path(folder), limits), limits, Path(folder, "stderr"))
        if code == 0:
            with np.load(Path(folder, "out.npz"), allow_pickle=False) as result:
                return {name: result[name] for name in result.files}
        if code == REFUSED:
            raise MeshError(**json.loads(Path(folder, "error.json").read_text()))
        raise _failure(code, stderr, limits, what)


def _start(target: str, folder: Path, limits: Limits) -> subprocess.Popen[bytes]:
    environment = {k: os.environ[k] for k in KEPT_ENVIRONMENT if k in os.environ}
    environment |= dict.fromkeys(THREAD_COUNT_VARIABLES, "1")
    environment |= {
        "PYTHONPATH": os.pathsep.join(path for path in sys.path if path),
        "HOME": str(folder),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    command = [
        sys.executable,
        "-m",
        "galewood.sandbox.child",
        target,
        str(limits.memory_bytes),
        str(limits.cpu_s),
    ]
    with Path(folder, "stderr").open("wb") as stderr:
        return subprocess.Popen(
            command, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL, stderr=stderr, start_new_session=True,
        )  # fmt: skip


def _wait(child: subprocess.Popen[bytes], limits: Limits, stderr: Path) -> tuple[int, str]:
    try:
        code = child.wait(timeout=limits.patience_s)
    except subprocess.TimeoutExpired:
        code = -signal.SIGALRM
    finally:
        if child.poll() is None:
            child.kill()
            child.wait()
    return code, stderr.read_text(errors="replace")[-4000:]


def _failure(code: int, stderr: str, limits: Limits, what: str) -> MeshError:
    if code == OUT_OF_MEMORY or "bad_alloc" in stderr or "MemoryError" in stderr:
        megabytes = limits.memory_bytes >> 20
        return MeshError(
            "out-of-memory",
            "unsuitable",
            f"{what} needed more than {megabytes} MB of memory.",
            "Reduce the number of faces and try again.",
        )
    if code == -signal.SIGALRM:
        return MeshError(
            "timed-out",
            "unsuitable",
            f"{what} took longer than {limits.patience_s:g} s.",
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
    return MeshError(
        "crashed",
        "unsuitable",
        f"{what} failed (exit code {code}).",
        "Repair the mesh in a modelling program and try again.",
    )

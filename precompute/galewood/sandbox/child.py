"""The child process of ``run_limited``: sets the limits, confines itself, then runs the function.

``python -m galewood.sandbox.child MODULE:FUNCTION MEMORY_BYTES CPU_S`` reads in.npz in the current folder and
writes out.npz, or error.json if the function raised a MeshError.
"""

from __future__ import annotations

import json
import os
import resource
import sys
import tempfile
from collections.abc import Callable, Sequence
from importlib import import_module
from pathlib import Path

import numpy as np

from galewood.sandbox.arrays import Arrays
from galewood.sandbox.confinement import confine
from galewood.sandbox.limited_process import OUT_OF_MEMORY, REFUSED_EXIT_CODE
from galewood.util import MeshError

FILE_BYTES = 2 << 30
"""Maximum size of a file written by the child; the largest mesh gives some 1.3 GB of results."""
OPEN_FILES = 256
NEW_THREADS = 256
"""How many threads a user may have beyond those of the whole machine when a child starts."""


def main(target: str, memory_bytes: int, cpu_s: int) -> int:
    """Set the resource limits and run ``target`` ("module:function"); returns the exit code."""
    limit_resources(memory_bytes, cpu_s)
    try:
        kernels = _private_kernel_cache(Path.cwd())
        module, _, name = target.partition(":")
        function: Callable[[Arrays], Arrays] = getattr(import_module(module), name)
    except MemoryError:
        return OUT_OF_MEMORY
    return run_confined(function, kernels)


def run_confined(function: Callable[[Arrays], Arrays], readable: Sequence[str]) -> int:
    """Confine this process to its current folder and call a function there; returns the exit code.

    ``readable`` lists folders that it may also read.
    """
    try:
        _write_no_kernels()
        os.environ["TMPDIR"] = tempfile.tempdir = str(Path.cwd())
        confine(Path.cwd(), readable=readable)
        with np.load("in.npz", allow_pickle=False) as data:
            result = function({key: data[key] for key in data.files})
        np.savez("out.npz", allow_pickle=False, **result)
    except MemoryError:
        return OUT_OF_MEMORY
    except MeshError as error:
        problem = {"code": error.code, "reason": error.reason, "title": error.title, "hint": error.hint}
        Path("error.json").write_text(json.dumps(problem))
        return REFUSED_EXIT_CODE
    return 0


def _write_no_kernels() -> None:
    """Let numba keep kernels that it compiles here in memory: a confined process cannot write its cache."""
    caching = sys.modules.get("numba.core.caching")
    if caching:
        caching.Cache.save_overload = _discard


def _discard(*_: object) -> None: ...


def limit_resources(memory_bytes: int, cpu_s: int) -> None:
    """Set limits that count for all that the child does, as it cannot start processes."""
    _lower(resource.RLIMIT_AS, memory_bytes)
    _lower(resource.RLIMIT_CPU, cpu_s, cpu_s + 5)
    _lower(resource.RLIMIT_CORE, 0)
    _lower(resource.RLIMIT_FSIZE, FILE_BYTES)
    _lower(resource.RLIMIT_NOFILE, OPEN_FILES)
    _lower(resource.RLIMIT_MEMLOCK, 0)
    if sys.platform == "linux":
        # counts all threads of the user, wherever they are; the kernel does not apply it to root
        _lower(resource.RLIMIT_NPROC, _threads_of_machine() + NEW_THREADS)
        _lower(resource.RLIMIT_MSGQUEUE, 0)


def _lower(limit: int, soft: int, hard: int | None = None) -> None:
    """Set a limit, which may be lower already."""
    present = resource.getrlimit(limit)[1]
    highest = present if present != resource.RLIM_INFINITY else sys.maxsize
    resource.setrlimit(limit, (min(soft, highest), min(soft if hard is None else hard, highest)))


def _threads_of_machine() -> int:
    """proc_loadavg(5): "0.20 0.18 0.12 RUNNABLE/ALL LAST_PID"."""
    return int(Path("/proc/loadavg").read_text().split()[3].partition("/")[2])


def _private_kernel_cache(folder: Path) -> list[str]:
    """Redirect the Numba cache to this folder, with links to the shared kernels; returns the readable paths.

    Compiled kernels are read from the shared cache but never written there: the parent executes whatever code
    it finds in that cache.
    """
    shared = os.environ.get("NUMBA_CACHE_DIR")
    if not shared:
        return []
    os.environ["NUMBA_CACHE_DIR"] = str(folder / "kernels")
    for file in Path(shared).resolve().glob("*/*.nb[ic]"):
        link = folder / "kernels" / file.parent.name / file.name
        link.parent.mkdir(parents=True, exist_ok=True)
        link.symlink_to(file)
    return [shared]


if __name__ == "__main__":
    sys.exit(main(sys.argv[1], int(sys.argv[2]), int(sys.argv[3])))

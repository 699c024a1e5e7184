"""The child process of ``run_limited``: sets the limits, confines itself, then runs the function.

``python -m galewood.sandbox.child MODULE:FUNCTION MEMORY_BYTES CPU_S`` reads in.npz in the current folder and
writes out.npz, or error.json if the function raised a MeshError.
"""

from __future__ import annotations

import json
import os
import resource
import sys
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

import numpy as np

from galewood.sandbox.confinement import confine
from galewood.sandbox.limited_process import OUT_OF_MEMORY, REFUSED, Arrays
from galewood.util import MeshError

FILE_BYTES = 4 << 30  # maximum size of a file written by the child


def main(target: str, memory_bytes: int, cpu_s: int) -> int:
    """Set the resource limits and run ``target`` ("module:function"); returns the exit code."""
    resource.setrlimit(resource.RLIMIT_AS, (memory_bytes, memory_bytes))
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_s, cpu_s + 5))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    resource.setrlimit(resource.RLIMIT_FSIZE, (FILE_BYTES, FILE_BYTES))
    try:
        kernels = _private_kernel_cache(Path.cwd())
        module, _, name = target.partition(":")
        function: Callable[[Arrays], Arrays] = getattr(import_module(module), name)
        confine(Path.cwd(), readable=kernels)
        with np.load("in.npz", allow_pickle=False) as data:
            result = function({key: data[key] for key in data.files})
        np.savez("out.npz", allow_pickle=False, **result)
    except MemoryError:
        return OUT_OF_MEMORY
    except MeshError as error:
        problem = {"code": error.code, "reason": error.reason, "title": error.title, "hint": error.hint}
        Path("error.json").write_text(json.dumps(problem))
        return REFUSED
    return 0


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

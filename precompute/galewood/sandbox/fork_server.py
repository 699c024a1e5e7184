"""A process that has loaded a function, and forks for each call of it: ``prepared.py`` starts and asks it.

``python -m galewood.sandbox.fork_server MODULE:FUNCTION`` loads the module and calls its ``warm_up``. Then it
reads requests (a line of JSON: folder, memory_bytes, cpu_s) and answers each with the exit code of the fork
that served it. It never reads what the forks are given: these confine themselves, as ``child.py`` does,
before they open it.
"""

from __future__ import annotations

import json
import os
import sys
import traceback
from collections.abc import Callable
from importlib import import_module
from pathlib import Path
from typing import Any, NoReturn

from galewood.sandbox.arrays import Arrays
from galewood.sandbox.child import limit_resources, run_confined
from galewood.sandbox.limited_process import STDERR_FILE

FAILED_EXIT_CODE = 1


def main(target: str) -> None:
    """Load ``target`` ("module:function") and serve requests until standard input ends."""
    name, _, function = target.partition(":")
    module = import_module(name)
    module.warm_up()
    while line := sys.stdin.buffer.readline():
        request = json.loads(line)
        child = os.fork()
        if child == 0:
            _serve(getattr(module, function), request)
        _, status = os.waitpid(child, 0)
        sys.stdout.write(f"{os.waitstatus_to_exitcode(status)}\n")
        sys.stdout.flush()


def _serve(function: Callable[[Arrays], Arrays], request: dict[str, Any]) -> NoReturn:
    """Answer one request in this fork, which has no way to talk to the parent but its exit code."""
    code = FAILED_EXIT_CODE
    try:
        folder = Path(request["folder"])
        _detach(folder)
        limit_resources(request["memory_bytes"], request["cpu_s"])
        kernels = os.environ.get("NUMBA_CACHE_DIR")
        code = run_confined(function, [kernels] if kernels else [])
    except BaseException:
        traceback.print_exc()
        sys.stderr.flush()
    finally:
        os._exit(code)


def _detach(folder: Path) -> None:
    """Work in a folder, with standard error in a file there, and without input and output."""
    os.chdir(folder)
    os.environ["HOME"] = str(folder)
    nothing = os.open(os.devnull, os.O_RDWR)
    errors = os.open(STDERR_FILE, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    for source, descriptor in ((nothing, 0), (nothing, 1), (errors, 2)):
        os.dup2(source, descriptor)
    os.close(nothing)
    os.close(errors)


if __name__ == "__main__":
    main(sys.argv[1])

"""Whether numba's cache holds the compiled kernels of this version, and who compiles them if not.

Compiling takes longer than a build. Whoever needs the kernels first compiles them all, under a lock, and
leaves a mark in the cache; other processes wait for the lock. No numerical library is loaded here.
"""

from __future__ import annotations

import fcntl
import os
import platform
from collections.abc import Callable
from importlib.metadata import version
from pathlib import Path

from galewood.util.atomic_file import write_atomically

PACKAGE = Path(__file__).parents[1]
MARK_FILE, LOCK_FILE = "galewood-kernels", "galewood-kernels.lock"


def kernels_compiled() -> bool:
    """Whether the cache holds the kernels; also true where nothing can be cached, so that nobody waits."""
    folder = _cache_folder()
    return folder is None or _is_marked(folder)


def compile_once(compile_all: Callable[[], None]) -> None:
    """Call `compile_all` unless the cache holds the kernels. Waits while another process compiles them."""
    folder = _cache_folder()
    if folder is None:
        compile_all()
        return
    with (folder / LOCK_FILE).open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not _is_marked(folder):
            compile_all()
            write_atomically(folder / MARK_FILE, _state().encode())


def _cache_folder() -> Path | None:
    """Where numba writes compiled kernels; None if it cannot, or writes to a folder of the user."""
    given = os.environ.get("NUMBA_CACHE_DIR")
    folder = Path(given) if given else PACKAGE / "__pycache__"
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return folder if os.access(folder, os.W_OK) else None


def _is_marked(folder: Path) -> bool:
    try:
        return (folder / MARK_FILE).read_bytes() == _state().encode()
    except OSError:
        return False


def _state() -> str:
    """What compiled kernels depend on: numba discards those of sources with another time of change."""
    kernels = (file for file in PACKAGE.rglob("*.py") if b"numba" in file.read_bytes())
    newest_ns = max(file.stat().st_mtime_ns for file in kernels)
    return f"numba {version('numba')} Python {platform.python_version()} {platform.machine()} {newest_ns}"

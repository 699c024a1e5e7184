"""Whether numba's cache holds the compiled kernels of this version, and who compiles them if not.

Compiling takes longer than a build. Whoever needs the kernels first compiles them all, under a lock, and
leaves a mark in the cache; other processes wait for the lock. No numerical library is loaded here. The cache
of another processor is not recognised: numba then compiles again when a kernel is first used.
"""

from __future__ import annotations

import fcntl
import hashlib
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
            if not _mark(folder).startswith(_constants_hash()):
                _remove_kernels(folder)
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


def _mark(folder: Path) -> str:
    try:
        return (folder / MARK_FILE).read_text()
    except OSError:
        return ""


def _is_marked(folder: Path) -> bool:
    return _mark(folder) == _state()


def _constants_hash() -> str:
    """Kernels contain the values of shared constants, and numba does not notice that one has changed."""
    return hashlib.sha256((PACKAGE / "constants.py").read_bytes()).hexdigest()


def _remove_kernels(folder: Path) -> None:
    """Remove what numba has cached of the library, in this folder or beside the sources."""
    for source in _kernel_sources():
        cached = f"{source.stem}.*.nb[ic]"
        beside = source.parent.glob(f"__pycache__/{cached}")
        for file in (*folder.glob(f"{source.parent.name}_*/{cached}"), *beside):
            file.unlink(missing_ok=True)


def _kernel_sources() -> list[Path]:
    return [file for file in PACKAGE.rglob("*.py") if b"numba" in file.read_bytes()]


def _state() -> str:
    """What compiled kernels depend on: numba discards those of sources with another time of change."""
    newest_ns = max(file.stat().st_mtime_ns for file in _kernel_sources())
    system = f"numba {version('numba')} Python {platform.python_version()} {platform.machine()}"
    return f"{_constants_hash()} {system} {newest_ns}"

"""Storage quota: limits on the stored bytes and on the remaining disk space."""

from __future__ import annotations

import os
import shutil
import threading
import time
from pathlib import Path

from galewood_server.http import ProblemError
from galewood_server.settings import Settings
from galewood_server.storage import STORE_NAMES

POLL_S = 10.0
FOLDERS = (*STORE_NAMES, "cache")
_lock = threading.Lock()
_measured: dict[Path, tuple[float, int]] = {}


def stored_bytes(settings: Settings) -> int:
    """Bytes in the data folder's stores and cache, measured at most every ten seconds."""
    folder = settings.data_dir.resolve()
    with _lock:
        now_s = time.monotonic()
        measured = _measured.get(folder)
        if measured is None or now_s - measured[0] > POLL_S:
            measured = _measured[folder] = (now_s, sum(_size(folder / name) for name in FOLDERS))
        return measured[1]


def count_stored(settings: Settings, size: int) -> None:
    """Add newly stored bytes to the last measurement, so that a burst of uploads cannot exceed the quota."""
    folder = settings.data_dir.resolve()
    with _lock:
        if folder in _measured:
            measured_s, total = _measured[folder]
            _measured[folder] = (measured_s, total + size)


def check_quota(settings: Settings, size: int) -> None:
    """Raise ProblemError 507 if `size` more bytes would exceed the quota or leave too little disk space."""
    limit = settings.stored_bytes
    if limit and stored_bytes(settings) + size > limit:
        raise ProblemError(
            507,
            "quota-reached",
            "The storage quota is reached",
            detail=f"The quota is {limit >> 20} MB.",
            hint="Delete trees that are no longer needed, or ask the operator for a larger quota.",
        )
    if shutil.disk_usage(settings.data_dir).free < settings.free_bytes + size:
        raise ProblemError(507, "disk-full", "The server's disk is nearly full", hint="Try again later.")


def _size(folder: Path) -> int:
    total = 0
    for parent, _, names in os.walk(folder):
        for name in names:
            try:
                total += os.lstat(os.path.join(parent, name)).st_blocks * 512  # noqa: PTH118
            except OSError:
                continue  # running builds change the cache meanwhile
    return total

"""Room for uploads: what is stored may not outgrow its share, nor fill the disk."""

from __future__ import annotations

import os
import shutil
import threading
import time
from pathlib import Path

from galewood_server.http import ProblemError
from galewood_server.settings import Settings
from galewood_server.storage import KINDS

LOOK_S = 10.0
FOLDERS = (*KINDS, "cache")
_lock = threading.Lock()
_looked: dict[Path, tuple[float, int]] = {}


def stored_bytes(settings: Settings) -> int:
    """Bytes that uploads and builds left in the data folder; a walk, at most every ten seconds."""
    folder = settings.data_dir.resolve()
    with _lock:
        now_s = time.monotonic()
        seen = _looked.get(folder)
        if seen is None or now_s - seen[0] > LOOK_S:
            seen = _looked[folder] = (now_s, sum(_size(folder / name) for name in FOLDERS))
        return seen[1]


def note_stored(settings: Settings, size: int) -> None:
    """Count bytes that were stored since the last walk, so that a burst of uploads cannot slip past it."""
    folder = settings.data_dir.resolve()
    with _lock:
        if folder in _looked:
            at_s, total = _looked[folder]
            _looked[folder] = (at_s, total + size)


def need_room(settings: Settings, size: int) -> None:
    """ProblemError 507 if `size` more bytes would pass the quota or leave too little of the disk."""
    limit = settings.stored_bytes
    if limit and stored_bytes(settings) + size > limit:
        raise ProblemError(
            507,
            "quota-reached",
            "The service holds as much as it may",
            detail=f"The quota is {limit >> 20} MB.",
            hint="Delete trees that are no longer needed, or ask the operator for more room.",
        )
    if shutil.disk_usage(settings.data_dir).free < settings.free_bytes + size:
        raise ProblemError(
            507, "disk-full", "The disk of the service is nearly full", hint="Try again later."
        )


def _size(folder: Path) -> int:
    total = 0
    for parent, _, names in os.walk(folder):
        for name in names:
            try:
                total += os.lstat(os.path.join(parent, name)).st_blocks * 512  # noqa: PTH118
            except OSError:
                continue  # a build's cache changes while we look
    return total

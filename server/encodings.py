"""Compressed copies of immutable files, made once, on the first request that can take one, and kept."""

from __future__ import annotations

import gzip
import threading
from collections.abc import Callable
from pathlib import Path
from typing import Literal

import zstandard

from server.storage import write_atomically

Coding = Literal["zstd", "gzip"]
PREFERRED: tuple[Coding, ...] = ("zstd", "gzip")
ZSTD_LEVEL, GZIP_LEVEL = 15, 9
_locks: dict[str, threading.Lock] = {}
_locks_lock = threading.Lock()


def coding_of(accept_encoding: str) -> Coding | None:
    """The best coding that a client takes (RFC 9110, section 12.5.3); None for the plain bytes."""
    weights = dict(_weight(part) for part in accept_encoding.lower().split(",") if part.strip())
    offered: list[tuple[float, Coding]] = [
        (weights.get(name, weights.get("*", 0.0)), name) for name in PREFERRED
    ]
    weight, best = max(offered, key=lambda one: one[0])
    return best if weight > 0 and weight >= weights.get("identity", 0.0) else None


def _weight(part: str) -> tuple[str, float]:
    name, _, parameter = part.strip().partition(";")
    key, _, value = parameter.strip().partition("=")
    try:
        return name.strip(), float(value) if key.strip() == "q" else 1.0
    except ValueError:
        return name.strip(), 0.0


def encoded_file(folder: Path, sha256: str, coding: Coding, read: Callable[[], bytes]) -> Path:
    """The compressed copy of a file, made now if it is not there; `read` gives the plain bytes."""
    target = folder / coding / sha256[:2] / sha256
    with _lock_of(f"{coding}-{sha256}"):
        if not target.is_file():
            write_atomically(target, _compress(read(), coding))
    return target


def forget_encoded(folder: Path, sha256: str) -> None:
    """Remove the compressed copies of a file."""
    for coding in PREFERRED:
        (folder / coding / sha256[:2] / sha256).unlink(missing_ok=True)


def _compress(data: bytes, coding: Coding) -> bytes:
    if coding == "zstd":
        return zstandard.ZstdCompressor(level=ZSTD_LEVEL).compress(data)
    return gzip.compress(data, GZIP_LEVEL, mtime=0)


def _lock_of(name: str) -> threading.Lock:
    with _locks_lock:
        return _locks.setdefault(name, threading.Lock())

"""Compressed copies of immutable files, created once after the first request that accepts them."""

from __future__ import annotations

import gzip
import logging
import threading
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Literal, TypeVar

import zstandard
from galewood.util import write_atomically

Coding = Literal["zstd", "gzip"]
Name = TypeVar("Name", bound=str)
PREFERRED_CODINGS: tuple[Coding, ...] = ("zstd", "gzip")
ZSTD_LEVEL, GZIP_LEVEL = 12, 6
_lock = threading.Lock()
_under_way: set[Path] = set()
_compressor = ThreadPoolExecutor(1, thread_name_prefix="compress")
log = logging.getLogger("galewood.encodings")


def coding_of(accept_encoding: str) -> Coding | None:
    """The preferred coding of an Accept-Encoding header for stored files; None: uncompressed."""
    return preferred_coding(accept_encoding, PREFERRED_CODINGS)


def preferred_coding(accept_encoding: str, offered: Sequence[Name]) -> Name | None:
    """The coding to send by an Accept-Encoding header (RFC 9110, section 12.5.3); None: uncompressed.

    Of several that the client likes equally, the first one offered.
    """
    weights = dict(_weight(part) for part in accept_encoding.lower().split(",") if part.strip())
    weighted = [(weights.get(name, weights.get("*", 0.0)), name) for name in offered]
    weight, best = max(weighted, key=lambda one: one[0], default=(0.0, None))
    return best if weight > 0 and weight >= weights.get("identity", 0.0) else None


def _weight(part: str) -> tuple[str, float]:
    name, _, parameter = part.strip().partition(";")
    key, _, value = parameter.strip().partition("=")
    try:
        return name.strip(), float(value) if key.strip() == "q" else 1.0
    except ValueError:
        return name.strip(), 0.0


def encoded_file(folder: Path, sha256: str, coding: Coding, read: Callable[[], bytes]) -> Path | None:
    """The compressed copy of a file, or None if it does not exist yet; its creation is then started in the
    background, so that requests do not wait for it. `read` returns the uncompressed bytes."""
    target = folder / coding / sha256[:2] / sha256
    if target.is_file():
        return target
    with _lock:
        begin = target not in _under_way
        _under_way.add(target)
    if begin:
        _compressor.submit(_make, target, coding, read)
    return None


def _make(target: Path, coding: Coding, read: Callable[[], bytes]) -> None:
    try:
        write_atomically(target, _compress(read(), coding))
    except OSError as error:  # disk full or file removed meanwhile: the next request tries again
        log.warning("%s could not be compressed: %s", target.name, error)
    finally:
        with _lock:
            _under_way.discard(target)


def _compress(data: bytes, coding: Coding) -> bytes:
    if coding == "zstd":
        return zstandard.ZstdCompressor(level=ZSTD_LEVEL).compress(data)
    return gzip.compress(data, GZIP_LEVEL, mtime=0)

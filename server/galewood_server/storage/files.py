"""Content-addressed files: a file is named by the SHA-256 of its bytes and appears whole or not at all."""

from __future__ import annotations

import hashlib
import re
import time
from collections.abc import Iterator
from pathlib import Path

from galewood.util import write_whole

_HASH = re.compile(r"[0-9a-f]{64}")


def is_hash(name: str) -> bool:
    """Whether a name is a SHA-256 in lower-case hex, hence safe as a file name."""
    return _HASH.fullmatch(name) is not None


class FileStore:
    """One folder of immutable files under `root`, spread over 256 sub-folders by the hash's first byte."""

    def __init__(self, root: Path) -> None:
        self.root = root
        root.mkdir(parents=True, exist_ok=True)

    def path(self, sha256: str) -> Path:
        """Where a file is or would be. ValueError if the name is no hash."""
        if not is_hash(sha256):
            raise ValueError("not a SHA-256 in hex")
        return self.root / sha256[:2] / sha256

    def has(self, sha256: str) -> bool:
        """Whether the file is stored."""
        return is_hash(sha256) and self.path(sha256).is_file()

    def size(self, sha256: str) -> int | None:
        """Bytes of a stored file; None if there is none."""
        return self.path(sha256).stat().st_size if self.has(sha256) else None

    def put(self, data: bytes) -> str:
        """Store bytes and return their SHA-256; storing the same bytes again is free."""
        sha256 = hashlib.sha256(data).hexdigest()
        target = self.path(sha256)
        if not target.is_file():
            write_whole(target, data)
        return sha256

    def get(self, sha256: str) -> bytes:
        """The stored bytes. FileNotFoundError if there are none."""
        return self.path(sha256).read_bytes()

    def get_anew(self, sha256: str) -> bytes:
        """As `get`, from where the file is kept, whatever copies there are. FileNotFoundError."""
        return self.get(sha256)

    def age_s(self, sha256: str) -> float:
        """Seconds since the file was stored; 0 if it is not there."""
        return file_age_s(self.path(sha256))

    def names(self) -> Iterator[str]:
        """The hash of every stored file."""
        return (path.name for path in self.root.glob("??/*") if is_hash(path.name))

    def remove(self, sha256: str) -> None:
        """Forget a file; one that is not there is forgotten already."""
        self.path(sha256).unlink(missing_ok=True)


def file_age_s(path: Path) -> float:
    """Seconds since a file was written; 0 if it is not there."""
    try:
        return time.time() - path.stat().st_mtime
    except OSError:
        return 0.0

"""Content-addressed files: a file is named by the SHA-256 of its bytes and appears whole or not at all."""

from __future__ import annotations

import hashlib
import os
import re
import tempfile
from pathlib import Path

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
            write_atomically(target, data)
        return sha256

    def get(self, sha256: str) -> bytes:
        """The stored bytes. FileNotFoundError if there are none."""
        return self.path(sha256).read_bytes()

    def remove(self, sha256: str) -> None:
        """Forget a file; one that is not there is forgotten already."""
        self.path(sha256).unlink(missing_ok=True)


def write_atomically(target: Path, data: bytes) -> None:
    """Write beside the target, flush to disk, then rename: a reader or a crash never meets a torn file."""
    target.parent.mkdir(parents=True, exist_ok=True)
    handle, name = tempfile.mkstemp(dir=target.parent, prefix=".part-")
    try:
        with os.fdopen(handle, "wb") as file:
            file.write(data)
            file.flush()
            os.fsync(file.fileno())
        Path(name).replace(target)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


class Stores:
    """The kinds of file the service keeps, apart so that no URL of one kind reaches another."""

    def __init__(self, data_dir: Path) -> None:
        self.sources = FileStore(data_dir / "sources")
        self.meshes = FileStore(data_dir / "meshes")
        self.tables = FileStore(data_dir / "tables")
        self.models = FileStore(data_dir / "models")
        self.pictures = FileStore(data_dir / "pictures")
        self.results = FileStore(data_dir / "results")

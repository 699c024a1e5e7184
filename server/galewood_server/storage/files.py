"""Content-addressed file stores: files are named by the SHA-256 of their bytes and written atomically."""

from __future__ import annotations

import hashlib
import logging
import re
import time
from collections.abc import Iterator
from pathlib import Path

from galewood.util import write_atomically

log = logging.getLogger("galewood.files")
_HASH = re.compile(r"[0-9a-f]{64}")


def is_hash(name: str) -> bool:
    """Whether a name is a SHA-256 in lower-case hex and therefore a safe file name."""
    return _HASH.fullmatch(name) is not None


class DamagedFileError(OSError):
    """The content of a stored file does not match its hash."""

    def __init__(self, kind: str, sha256: str) -> None:
        """`kind`: the name of its store."""
        super().__init__(f"the stored file {kind}/{sha256} is damaged: its content does not match its hash")
        self.kind = kind


class FileStore:
    """Immutable files under `root`, in 256 sub-folders named by the first byte of the hash."""

    def __init__(self, root: Path) -> None:
        self.root = root
        self._intact: dict[str, tuple[int, int]] = {}
        root.mkdir(parents=True, exist_ok=True)

    def path(self, sha256: str) -> Path:
        """The path of a file, which may not exist. ValueError if the name is not a hash."""
        if not is_hash(sha256):
            raise ValueError("not a SHA-256 in hex")
        return self.root / sha256[:2] / sha256

    def has(self, sha256: str) -> bool:
        """Whether the file is stored."""
        return is_hash(sha256) and self.path(sha256).is_file()

    def size(self, sha256: str) -> int | None:
        """Size of a stored file in bytes; None if it does not exist."""
        return self.path(sha256).stat().st_size if self.has(sha256) else None

    def put(self, data: bytes) -> str:
        """Store bytes and return their SHA-256. Existing files are not written again, unless damaged."""
        sha256 = hashlib.sha256(data).hexdigest()
        target = self.path(sha256)
        if not target.is_file() or not self.is_intact(sha256):
            write_atomically(target, data)
        return sha256

    def get(self, sha256: str) -> bytes:
        """The stored bytes. FileNotFoundError, DamagedFileError."""
        data = self.path(sha256).read_bytes()
        # these bytes are checked, not the file before or after: it may be damaged or replaced meanwhile
        if hashlib.sha256(data).hexdigest() != sha256:
            raise self._damaged(sha256)
        return data

    def check(self, sha256: str) -> None:
        """Raise DamagedFileError, and log it, if a stored file's content does not match its name.

        FileNotFoundError.
        """
        if not self.is_intact(sha256):
            raise self._damaged(sha256)

    def _damaged(self, sha256: str) -> DamagedFileError:
        log.error("the stored file %s/%s is damaged", self.root.name, sha256)
        return DamagedFileError(self.root.name, sha256)

    def is_intact(self, sha256: str) -> bool:
        """Whether a stored file's content matches its name. It is read again only after it has changed."""
        path = self.path(sha256)
        state = path.stat()
        seen = (state.st_size, state.st_mtime_ns)
        if self._intact.get(sha256) == seen:
            return True
        with path.open("rb") as file:
            intact = hashlib.file_digest(file, "sha256").hexdigest() == sha256
        if intact:
            self._intact[sha256] = seen
        return intact

    def get_from_origin(self, sha256: str) -> bytes:
        """The stored bytes, damaged or not, bypassing local copies. FileNotFoundError."""
        return self.path(sha256).read_bytes()

    def age_s(self, sha256: str) -> float:
        """Seconds since the file was stored; 0 if it does not exist."""
        return file_age_s(self.path(sha256))

    def names(self) -> Iterator[str]:
        """The hash of every stored file."""
        return (path.name for path in self.root.glob("??/*") if is_hash(path.name))

    def remove(self, sha256: str) -> None:
        """Remove a file if it exists."""
        self.path(sha256).unlink(missing_ok=True)


def file_age_s(path: Path) -> float:
    """Seconds since a file was written; 0 if it does not exist."""
    try:
        return time.time() - path.stat().st_mtime
    except OSError:
        return 0.0

"""File stores in an object store (S3-compatible and others), with local copies of files that were read.

Names are content hashes, so local copies never become stale. Existence is always checked in the bucket,
because another server may have removed the file.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any, cast

import obstore
from galewood.util import write_atomically
from obstore.store import from_url

from galewood_server.storage.files import FileStore, is_hash

_list_objects: Callable[..., Any] = getattr(obstore, "list")  # noqa: B009  (its stubs are incomplete)
TIMEOUT_S = 30
RETRY_S = 20


def open_bucket(url: str) -> Any:
    """Open a bucket by its URL: s3://bucket/prefix, with AWS_… environment variables for credentials, region
    and endpoint, or file:///folder for servers that share a disk.
    """
    if url.startswith("file:"):
        return from_url(url, mkdir=True)
    return from_url(
        url,
        client_options={
            "timeout": timedelta(seconds=TIMEOUT_S),
            "allow_http": os.environ.get("AWS_ALLOW_HTTP", "").lower() == "true",
        },
        retry_config={"max_retries": 8, "retry_timeout": timedelta(seconds=RETRY_S)},
    )


def stored(bucket: Any, key: str) -> int | None:
    """Size of an object in bytes; None if it does not exist."""
    try:
        return int(obstore.head(bucket, key)["size"])
    except FileNotFoundError:
        return None


def fetch(bucket: Any, key: str) -> bytes:
    """The bytes of an object. FileNotFoundError."""
    return bytes(obstore.get(bucket, key).bytes())


def list_keys(bucket: Any, prefix: str) -> list[str]:
    """The keys of all objects with a prefix."""
    pages = cast(Iterable[Sequence[Mapping[str, Any]]], _list_objects(bucket, prefix=prefix))
    return [str(item["path"]) for page in pages for item in page]


class BucketStore(FileStore):
    """One kind of file under a prefix of the bucket."""

    def __init__(self, bucket: Any, prefix: str, copies: Path) -> None:
        super().__init__(copies)
        self._bucket = bucket
        self._prefix = prefix

    def path(self, sha256: str) -> Path:
        """The path of a local copy, fetched if necessary. FileNotFoundError, ValueError."""
        copy = super().path(sha256)
        if not copy.is_file():
            write_atomically(copy, fetch(self._bucket, self._key(sha256)))
        return copy

    def has(self, sha256: str) -> bool:
        """Whether the bucket contains the file."""
        return self.size(sha256) is not None

    def size(self, sha256: str) -> int | None:
        """Size of a stored file in bytes; None if it does not exist."""
        return stored(self._bucket, self._key(sha256)) if is_hash(sha256) else None

    def put(self, data: bytes) -> str:
        """Store bytes and return their SHA-256. Uploads are atomic."""
        sha256 = hashlib.sha256(data).hexdigest()
        if not self.has(sha256):
            obstore.put(self._bucket, self._key(sha256), data)
        return sha256

    def get_from_origin(self, sha256: str) -> bytes:
        """The bytes in the bucket; replaces the local copy. FileNotFoundError."""
        super().path(sha256).unlink(missing_ok=True)
        return super().get_from_origin(sha256)

    def age_s(self, sha256: str) -> float:
        """Seconds since the file was stored; 0 if it does not exist."""
        try:
            stored_at: datetime = obstore.head(self._bucket, self._key(sha256))["last_modified"]
        except FileNotFoundError:
            return 0.0
        return (datetime.now(UTC) - stored_at).total_seconds()

    def names(self) -> Iterator[str]:
        """The hash of every stored file."""
        for key in list_keys(self._bucket, self._prefix):
            name = key.rsplit("/", 1)[-1]
            if is_hash(name):
                yield name

    def remove(self, sha256: str) -> None:
        """Remove a file and its local copy."""
        if stored(self._bucket, self._key(sha256)) is not None:
            obstore.delete(self._bucket, self._key(sha256))
        super().path(sha256).unlink(missing_ok=True)

    def _key(self, sha256: str) -> str:
        return f"{self._prefix}/{sha256[:2]}/{sha256}"

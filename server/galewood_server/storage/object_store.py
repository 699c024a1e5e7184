"""Files in a bucket of an S3-compatible (or another) object store, with copies of what was read on disk.

A name is the hash of its content, so a copy never goes stale; whether a file is still stored is always asked
of the bucket, as another server may have removed it.
"""

from __future__ import annotations

import hashlib
import os
from collections.abc import Iterator
from datetime import UTC, datetime, timedelta
from pathlib import Path
from typing import Any

import obstore
from galewood.util import write_whole
from obstore.store import from_url

from galewood_server.storage.files import FileStore, is_hash

TIMEOUT_S = 30
RETRY_S = 20


def open_bucket(url: str) -> Any:
    """A bucket by its URL: s3://bucket/prefix, with keys, region and endpoint from AWS_… in the environment;
    or file:///folder, for servers that share a disk.
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
    """Bytes of an object; None if there is none."""
    try:
        return int(obstore.head(bucket, key)["size"])
    except FileNotFoundError:
        return None


def fetch(bucket: Any, key: str) -> bytes:
    """The bytes of an object. FileNotFoundError."""
    return bytes(obstore.get(bucket, key).bytes())


class BucketStore(FileStore):
    """One kind of file under a prefix of the bucket."""

    def __init__(self, bucket: Any, prefix: str, copies: Path) -> None:
        super().__init__(copies)
        self._bucket = bucket
        self._prefix = prefix

    def path(self, sha256: str) -> Path:
        """A copy on this machine's disk, fetched if need be. FileNotFoundError, ValueError."""
        copy = super().path(sha256)
        if not copy.is_file():
            write_whole(copy, fetch(self._bucket, self._key(sha256)))
        return copy

    def has(self, sha256: str) -> bool:
        """Whether the bucket has the file."""
        return self.size(sha256) is not None

    def size(self, sha256: str) -> int | None:
        """Bytes of a stored file; None if there is none."""
        return stored(self._bucket, self._key(sha256)) if is_hash(sha256) else None

    def put(self, data: bytes) -> str:
        """Store bytes; an upload appears whole or not at all."""
        sha256 = hashlib.sha256(data).hexdigest()
        if not self.has(sha256):
            obstore.put(self._bucket, self._key(sha256), data)
        return sha256

    def get_anew(self, sha256: str) -> bytes:
        """The bytes in the bucket; a copy here is put right. FileNotFoundError."""
        super().path(sha256).unlink(missing_ok=True)
        return self.get(sha256)

    def age_s(self, sha256: str) -> float:
        """Seconds since the bucket got the file; 0 if it is not there."""
        try:
            stored_at: datetime = obstore.head(self._bucket, self._key(sha256))["last_modified"]
        except FileNotFoundError:
            return 0.0
        return (datetime.now(UTC) - stored_at).total_seconds()

    def names(self) -> Iterator[str]:
        """The hash of every stored file."""
        for page in obstore.list(self._bucket, prefix=self._prefix):
            for item in page:
                name = str(item["path"]).rsplit("/", 1)[-1]
                if is_hash(name):
                    yield name

    def remove(self, sha256: str) -> None:
        """Forget a file and its copy here."""
        if stored(self._bucket, self._key(sha256)) is not None:
            obstore.delete(self._bucket, self._key(sha256))
        super().path(sha256).unlink(missing_ok=True)

    def _key(self, sha256: str) -> str:
        return f"{self._prefix}/{sha256[:2]}/{sha256}"

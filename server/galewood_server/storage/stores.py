"""Every kind of file that the service keeps, in the data folder or in a bucket."""

from __future__ import annotations

from pathlib import Path

from galewood_server.storage.files import FileStore

KINDS = ("sources", "meshes", "tables", "models", "pictures", "results")


class Stores:
    """The kinds of file the service keeps, apart so that no URL of one kind reaches another.

    In the data folder, or by a URL in a bucket (`object_store.py`) that several servers share.
    """

    def __init__(self, data_dir: Path, url: str | None = None) -> None:
        """`url` such as s3://bucket/prefix; its credentials come from the environment."""
        self._named = (
            _in_bucket(url, data_dir) if url else {kind: FileStore(data_dir / kind) for kind in KINDS}
        )
        self.sources = self._named["sources"]
        self.meshes = self._named["meshes"]
        self.tables = self._named["tables"]
        self.models = self._named["models"]
        self.pictures = self._named["pictures"]
        self.results = self._named["results"]

    def named(self, kind: str) -> FileStore:
        """A store by its kind's name. KeyError."""
        return self._named[kind]


def _in_bucket(url: str, data_dir: Path) -> dict[str, FileStore]:
    from galewood_server.storage.object_store import BucketStore, open_bucket

    bucket = open_bucket(url)
    return {kind: BucketStore(bucket, kind, data_dir / "store-cache" / kind) for kind in KINDS}

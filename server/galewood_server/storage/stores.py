"""The file stores of the service, in the data folder or in a bucket."""

from __future__ import annotations

from pathlib import Path

from galewood_server.storage.files import FileStore

CONTENT_OF_STORE = {
    "sources": "uploaded file",
    "meshes": "mesh",
    "imports": "imported tree",
    "tables": "table",
    "records": "records",
    "compliances": "compliance",
    "models": "model",
    "pictures": "picture",
    "results": "result",
}
"""Name of a store -> what one of its files is called in messages."""
STORE_NAMES = tuple(CONTENT_OF_STORE)


class Stores:
    """One store per kind of file, in the data folder or in a bucket shared by several servers.

    Separate stores ensure that a URL of one kind cannot reach files of another.
    """

    def __init__(self, data_dir: Path, url: str | None = None) -> None:
        """`url`: bucket such as s3://bucket/prefix; its credentials are in the environment."""
        self._named = (
            _in_bucket(url, data_dir) if url else {kind: FileStore(data_dir / kind) for kind in STORE_NAMES}
        )
        self.sources = self._named["sources"]
        self.meshes = self._named["meshes"]
        self.imports = self._named["imports"]
        self.tables = self._named["tables"]
        self.records = self._named["records"]
        self.compliances = self._named["compliances"]
        self.models = self._named["models"]
        self.pictures = self._named["pictures"]
        self.results = self._named["results"]

    def named(self, kind: str) -> FileStore:
        """A store by its name, one of STORE_NAMES. KeyError."""
        return self._named[kind]


def _in_bucket(url: str, data_dir: Path) -> dict[str, FileStore]:
    from galewood_server.storage.object_store import BucketStore, open_bucket

    bucket = open_bucket(url)
    return {kind: BucketStore(bucket, kind, data_dir / "store-cache" / kind) for kind in STORE_NAMES}

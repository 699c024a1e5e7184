"""In-memory cache of decoded tables."""

from __future__ import annotations

import threading
from collections import OrderedDict

from galewood.table import Table, decode

from galewood_server.storage.files import FileStore


class TableCache:
    """LRU cache of decoded tables, shared by all clients. Thread-safe."""

    def __init__(self, store: FileStore, capacity: int = 16) -> None:
        self._store = store
        self._capacity = capacity
        self._tables: OrderedDict[str, Table] = OrderedDict()
        self._lock = threading.Lock()

    def take(self, sha256: str) -> Table:
        """A table by its hash. FileNotFoundError, TableError."""
        with self._lock:
            if sha256 not in self._tables:
                self._tables[sha256] = decode(self._store.get(sha256))
            self._tables.move_to_end(sha256)
            while len(self._tables) > self._capacity:
                self._tables.popitem(last=False)
            return self._tables[sha256]

"""In-memory cache of decoded tables."""

from __future__ import annotations

import threading
from collections import OrderedDict

from galewood.table import Compliance, Table, decode, decode_compliance, with_records

from galewood_server.storage.stores import Stores


class TableCache:
    """LRU cache of decoded tables, shared by all clients. Thread-safe."""

    def __init__(self, stores: Stores, capacity: int = 16) -> None:
        self._stores = stores
        self._capacity = capacity
        self._tables: OrderedDict[str, Table] = OrderedDict()
        self._compliances: OrderedDict[str, Compliance] = OrderedDict()
        self._lock = threading.Lock()

    def has(self, sha256: str) -> bool:
        """Whether a table is in memory."""
        with self._lock:
            return sha256 in self._tables

    def take(self, sha256: str, records_sha256: str | None = None) -> Table:
        """A table by its hash, with the records of the given file unless it holds them itself.

        FileNotFoundError, TableError.
        """
        with self._lock:
            if sha256 not in self._tables:
                self._tables[sha256] = decode(self._stores.tables.get(sha256))
            if records_sha256 and self._tables[sha256].paper is None:
                records = self._stores.records.get(records_sha256)
                self._tables[sha256] = with_records(self._tables[sha256], records, sha256)
            self._tables.move_to_end(sha256)
            while len(self._tables) > self._capacity:
                self._tables.popitem(last=False)
            return self._tables[sha256]

    def take_compliance(self, sha256: str) -> Compliance:
        """A compliance file by its hash. FileNotFoundError, TableError."""
        with self._lock:
            if sha256 not in self._compliances:
                self._compliances[sha256] = decode_compliance(self._stores.compliances.get(sha256))
            self._compliances.move_to_end(sha256)
            while len(self._compliances) > self._capacity:
                self._compliances.popitem(last=False)
            return self._compliances[sha256]

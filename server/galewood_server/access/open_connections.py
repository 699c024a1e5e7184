"""Ceilings of what is open at once: HTTP connections in total, requests in progress of each address.

Both are lowered to shares of the file descriptors that the process may have (RLIMIT_NOFILE): without a
ceiling, whoever opens connections and sends nothing takes all of them. Sockets and event streams have
ceilings of their own (api/connections.py).
"""

from __future__ import annotations

import resource
from collections.abc import Generator
from contextlib import contextmanager
from typing import Protocol

RESERVED_DESCRIPTORS = 64  # for the database, files and libraries
SPARE_DESCRIPTORS = 96
"""Left when the last connection is admitted: those above, and some for connections not yet counted."""
CONNECTION_SHARE = 0.5  # of the descriptors: each connection may need another one, for the file it is sent
ADDRESS_SHARE = 0.375


def limited_by_descriptors(ceiling: int, share: float) -> int:
    """A ceiling of open connections, lowered to a share of the process's file descriptors."""
    descriptors = _descriptors()
    if descriptors is None:
        return ceiling
    return max(1, min(ceiling, int((descriptors - RESERVED_DESCRIPTORS) * share)))


def _descriptors() -> int | None:
    """How many file descriptors the process may have; None if there is no limit."""
    soft, _ = resource.getrlimit(resource.RLIMIT_NOFILE)
    return None if soft == resource.RLIM_INFINITY else soft


@contextmanager
def count_open(counts: dict[str, int], address: str) -> Generator[None]:
    """Count what an address has open while the block runs."""
    counts[address] = counts.get(address, 0) + 1
    try:
        yield
    finally:
        counts[address] -= 1
        if not counts[address]:
            del counts[address]


class Connection(Protocol):
    """An HTTP connection (app/http_protocol.py)."""

    def close_waiting(self) -> None:
        """Close the connection, which waits for a request or the rest of its head."""
        ...


class OpenConnections:
    """All open HTTP connections, and of these the ones that wait for a request, the longest first.

    If there are too many, the one that has waited longest makes room: of the same address if that has any, so
    that an address which opens many loses its own first. Browsers open an idle connection again when needed
    and never send a request head slowly.
    """

    def __init__(self, ceiling: int) -> None:
        self._ceiling = ceiling
        self._open = set[Connection]()
        self._waiting: dict[Connection, str] = {}
        self._of_address: dict[str, dict[Connection, None]] = {}

    def __len__(self) -> int:
        return len(self._open)

    def admit(self, connection: Connection, address: str, descriptor: int) -> bool:
        """Whether there is room for a new connection, which then waits for a request.

        The caller closes it if there is none. `descriptor` is its number: the lowest that was free.
        """
        if self._full(descriptor) and not self._make_room(address):
            return False
        self._open.add(connection)
        self.waits(connection, address)
        return True

    def waits(self, connection: Connection, address: str) -> None:
        """A connection waits for a request from now on."""
        if connection in self._open:
            self._waiting[connection] = address
            self._of_address.setdefault(address, {})[connection] = None

    def works(self, connection: Connection) -> None:
        """A connection has got a request."""
        address = self._waiting.pop(connection, None)
        if address is not None:
            mine = self._of_address[address]
            del mine[connection]
            if not mine:
                del self._of_address[address]

    def closed(self, connection: Connection) -> None:
        """A connection was closed, or became a socket."""
        self.works(connection)
        self._open.discard(connection)

    def _full(self, descriptor: int) -> bool:
        descriptors = _descriptors()
        if descriptors is not None and descriptor >= descriptors - SPARE_DESCRIPTORS:
            return True
        return len(self._open) >= limited_by_descriptors(self._ceiling, CONNECTION_SHARE)

    def _make_room(self, address: str) -> bool:
        """Close the connection that has waited longest. False if none waits."""
        longest = next(iter(self._of_address.get(address, self._waiting)), None)
        if longest is None:
            return False
        self.closed(longest)
        longest.close_waiting()
        return True

"""State shared by all parts of a running server process."""

from __future__ import annotations

import asyncio
import threading
from dataclasses import dataclass, field
from typing import Annotated, cast

from fastapi import Depends
from starlette.requests import HTTPConnection

from galewood_server.access import FilesOnDemand, MeshImporter, Turns
from galewood_server.peers import ForestOwners
from galewood_server.settings import Settings
from galewood_server.storage import Sessions, Stores
from galewood_server.stream import Forests


@dataclass
class Service:
    """Settings, database sessions, file stores, running forests and synchronisation of one process."""

    settings: Settings
    sessions: Sessions
    stores: Stores
    forests: Forests
    owners: ForestOwners
    server_name: str
    importer: MeshImporter
    loop: asyncio.AbstractEventLoop
    imports: Turns
    upload_slots: asyncio.Semaphore
    # held while a file and the database row that references it are added or removed together
    files_lock: threading.Lock = field(default_factory=threading.Lock)
    # set when a job is queued or cancelled, so that the supervisor reacts before its next poll
    jobs_changed: asyncio.Event = field(default_factory=asyncio.Event)
    # each takes seconds of a processor; none of them keeps another one or an upload waiting
    exports: FilesOnDemand = field(default_factory=lambda: FilesOnDemand("exports", 8, 4, kept=32))
    pictures: FilesOnDemand = field(default_factory=lambda: FilesOnDemand("pictures", 128, 32))
    inventories: FilesOnDemand = field(default_factory=lambda: FilesOnDemand("inventories", 128, 32, kept=4))
    # files that anyone may have converted; those that are being received count among the waiting ones
    conversions: Turns = field(default_factory=lambda: Turns("conversions", 1, 7, most_of_address=2))
    # open connections by address
    socket_addresses: dict[str, int] = field(default_factory=dict[str, int])
    event_addresses: dict[str, int] = field(default_factory=dict[str, int])

    def wake_supervisor(self) -> None:
        """Notify the supervisor that a job was queued or cancelled. Thread-safe."""
        self.loop.call_soon_threadsafe(self.jobs_changed.set)

    @property
    def sockets(self) -> int:
        """Number of open WebSockets."""
        return sum(self.socket_addresses.values())

    @property
    def event_streams(self) -> int:
        """Number of open event streams."""
        return sum(self.event_addresses.values())


def service_of(connection: HTTPConnection) -> Service:
    """The Service of the application that received a request or a WebSocket."""
    return cast(Service, connection.app.state.service)


async def _service_of(connection: HTTPConnection) -> Service:
    return service_of(connection)  # not in a thread, as FastAPI calls functions that are not asynchronous


ServiceDep = Annotated[Service, Depends(_service_of)]

"""What every part of the running service shares."""

from __future__ import annotations

import asyncio
import threading
from dataclasses import dataclass, field
from typing import Annotated, cast

from fastapi import Depends
from starlette.requests import HTTPConnection

from galewood_server.access import MeshImporter
from galewood_server.settings import Settings
from galewood_server.storage import Sessions, Stores
from galewood_server.stream import Forests


@dataclass
class Service:
    """Settings, database and files, with the signals between the parts of one process."""

    settings: Settings
    sessions: Sessions
    stores: Stores
    forests: Forests
    server_name: str
    importer: MeshImporter
    loop: asyncio.AbstractEventLoop
    import_slots: asyncio.Semaphore
    upload_slots: asyncio.Semaphore
    # held while a file and the row that names it come or go together
    files_lock: threading.Lock = field(default_factory=threading.Lock)
    # set when a job was queued or cancelled, so that the supervisor need not wait for its next look
    jobs_changed: asyncio.Event = field(default_factory=asyncio.Event)
    socket_addresses: dict[str, int] = field(default_factory=dict[str, int])

    def wake_supervisor(self) -> None:
        """Say that a job was queued or cancelled; from any thread."""
        self.loop.call_soon_threadsafe(self.jobs_changed.set)

    @property
    def sockets(self) -> int:
        """Open WebSockets."""
        return sum(self.socket_addresses.values())


def service_of(connection: HTTPConnection) -> Service:
    """The service behind a request or a socket."""
    return cast(Service, connection.app.state.service)


ServiceHere = Annotated[Service, Depends(service_of)]

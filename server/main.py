"""The service: what it is made of, how it starts and how it ends."""

from __future__ import annotations

import asyncio
import fcntl
import logging
from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager
from importlib.metadata import version
from pathlib import Path
from typing import TextIO

import uvicorn
from fastapi import FastAPI
from sqlalchemy import func, select

from server import artefacts, comparisons, errors, events, jobs, species, stream, trees, winds
from server.context import Service, ServiceHere
from server.database import migrate, open_database
from server.forests import Forests
from server.intake import Intake, limited_intake
from server.models import ACTIVE, Job, Tree
from server.page import Page
from server.schemas import Health
from server.settings import Settings
from server.shelf import TableShelf
from server.socket_protocol import SocketProtocol
from server.storage import Stores
from server.supervisor import Supervisor

log = logging.getLogger("galewood")
VERSION = version("galewood")
GRACE_S = 5


def create_app(settings: Settings, intake: Intake | None = None) -> FastAPI:
    """The application; `intake` reads an upload (bytes, filename, options), a parameter for the tests."""

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncGenerator[None]:
        lock = await asyncio.to_thread(_lock, settings.data_dir)
        await asyncio.to_thread(migrate, settings.database)
        app.state.service = service = _service(settings, intake or limited_intake(settings))
        app.state.feed = events.ChangeFeed(service)
        tasks = [
            asyncio.create_task(work)
            for work in (Supervisor(service).run(), app.state.feed.run(), species.register(service))
        ]
        try:
            yield
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            lock.close()

    app = FastAPI(title="Galewood", version=VERSION, lifespan=lifespan)
    errors.install(app)
    for part in (trees, jobs, comparisons, winds, events, artefacts, stream):
        app.include_router(part.router)
    app.add_api_route("/healthz", health, tags=["service"])
    app.mount("/", Page(settings.page_dir))
    return app


def _service(settings: Settings, intake: Intake) -> Service:
    stores = Stores(settings.data_dir)
    return Service(
        settings=settings,
        sessions=open_database(settings.database),
        stores=stores,
        forests=Forests(settings, TableShelf(stores.tables)),
        server_name=f"galewood {VERSION}",
        intake=intake,
        loop=asyncio.get_running_loop(),
        intake_slots=asyncio.Semaphore(settings.concurrent_intakes),
    )


def _lock(data_dir: Path) -> TextIO:
    """Hold the data folder; RuntimeError if another server does."""
    data_dir.mkdir(parents=True, exist_ok=True)
    handle = (data_dir / ".lock").open("w")
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        handle.close()
        raise RuntimeError(
            f"another server is using {data_dir}; set GALEWOOD_DATA_DIR to a folder of its own"
        ) from None
    return handle


def health(service: ServiceHere) -> Health:
    """Whether the service answers, and how much it holds."""
    with service.sessions() as session:
        return Health(
            status="ok",
            version=VERSION,
            trees=session.scalar(select(func.count(Tree.id))) or 0,
            ready=session.scalar(select(func.count(Tree.id)).where(Tree.table_sha256.is_not(None))) or 0,
            jobs_active=session.scalar(select(func.count(Job.id)).where(Job.state.in_(ACTIVE))) or 0,
            sockets=service.sockets,
        )


def run(app: FastAPI, settings: Settings) -> None:
    """Answer until interrupted."""
    uvicorn.run(
        app,
        host=settings.host,
        port=settings.port,
        ws=SocketProtocol,
        ws_max_size=settings.socket_message_bytes,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=GRACE_S,
        server_header=False,
        access_log=False,
    )

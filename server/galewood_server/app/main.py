"""Assembles the service and runs it."""

from __future__ import annotations

import asyncio
import fcntl
import hashlib
import logging
import sys
import time
from collections.abc import AsyncGenerator
from concurrent.futures import Executor, ThreadPoolExecutor
from contextlib import ExitStack, asynccontextmanager, suppress
from functools import partial
from pathlib import Path
from threading import Thread
from typing import TextIO

import uvicorn
from fastapi import Depends, FastAPI
from galewood.pipeline.results import shipped_tables
from galewood.util import GuardedProcess

from galewood_server.access import (
    AccessControl,
    LimitedImporter,
    MeshImporter,
    OpenConnections,
    RequestTurns,
    Turns,
)
from galewood_server.api import ROUTERS, VERSION, ChangeFeed, ServiceCollector
from galewood_server.app import builtin_trees, docs_page, startup_warnings
from galewood_server.app.compression import CompressedJson
from galewood_server.app.cross_origin import allow_cross_origin
from galewood_server.app.headers import SecurityHeaders
from galewood_server.app.http_protocol import ACCEPTED_AT_ONCE, Server, protocol_with_limits
from galewood_server.app.kernels import compile_kernels
from galewood_server.app.openapi import describe
from galewood_server.app.page import Page
from galewood_server.app.start_failures import check_address, with_clear_failures
from galewood_server.app.temporary_files import temporary_files_in
from galewood_server.context import Service
from galewood_server.http import install_error_handlers, refuse_unknown_queries
from galewood_server.jobs import Supervisor
from galewood_server.ops import Metrics, Tracing, configure_logging
from galewood_server.peers import ForestOwners
from galewood_server.settings import Settings
from galewood_server.storage import (
    StartError,
    Stores,
    TableCache,
    compliance_of,
    migrate,
    open_database,
    records_of,
)
from galewood_server.stream import Forests, SocketLimits, metered_protocol, warm_up

log = logging.getLogger("galewood")
NOT_STARTED = 3
"""Exit status of a server that could not start, as of uvicorn."""
THREAD_CHECK_S = 0.02
"""Time between two looks at what threads still do at the end, s."""


def create_app(settings: Settings, importer: MeshImporter | None = None) -> FastAPI:
    """Create the application. `importer` replaces the sandboxed mesh import in tests."""

    @asynccontextmanager
    async def lifespan(app: FastAPI) -> AsyncGenerator[None]:
        threads = ThreadPoolExecutor(thread_name_prefix="galewood")
        asyncio.get_running_loop().set_default_executor(threads)
        stack = ExitStack()  # closed last, because the tasks' children use the folder
        stack.enter_context(await asyncio.to_thread(_lock, settings.data_dir))
        stack.enter_context(temporary_files_in(settings.temporary_dir))
        await asyncio.to_thread(migrate, settings.database)
        limited = LimitedImporter(settings)
        app.state.service = service = _service(settings, importer or limited)
        app.state.feed = ChangeFeed(service)
        app.state.metrics.registry.register(ServiceCollector(service))
        await asyncio.to_thread(builtin_trees.register, service)
        if settings.peer_url:  # clients that lost another server are not to wait for this one's first forest
            await asyncio.to_thread(_warm_up, service)
            await service.owners.warm_up()
        tasks = [
            asyncio.create_task(work)
            for work in (
                Supervisor(service).run(),
                _prepare(settings, None if importer else limited),
                app.state.feed.run(),
                service.owners.run(),
                builtin_trees.queue_outdated_uploads(service),
                asyncio.to_thread(startup_warnings.log_startup_warnings, settings),
            )
        ]
        try:
            yield
        finally:
            for task in tasks:
                task.cancel()
            await asyncio.gather(*tasks, return_exceptions=True)
            await end_threads(threads, settings.shutdown_s)
            limited.close()
            stack.close()

    app = FastAPI(
        title="Galewood",
        version=VERSION,
        lifespan=lifespan,
        docs_url=None,
        redoc_url=None,
        redirect_slashes=False,
        generate_unique_id_function=lambda route: route.name,  # generated clients name their functions so
    )
    app.state.metrics = metrics = Metrics(VERSION)
    install_error_handlers(app, [route for router in ROUTERS for route in router.routes])
    for router in ROUTERS:
        app.include_router(router, dependencies=[Depends(refuse_unknown_queries)])
    describe(app)
    docs_page.install(app)
    app.mount("/", Page(settings.page_dir))
    # the middleware added last handles a request first
    app.add_middleware(CompressedJson)
    app.add_middleware(AccessControl, settings=settings, metrics=metrics)
    app.add_middleware(
        SecurityHeaders,
        frame_ancestors=[*settings.frame_ancestors, *settings.allowed_origins],
        varies_by_origin=bool(settings.allowed_origins),
    )
    allow_cross_origin(app, settings.allowed_origins)
    app.add_middleware(RequestTurns, frames_in_work=lambda: _frames_in_work(app))
    app.add_middleware(Tracing, metrics=metrics)
    return app


def _frames_in_work(app: FastAPI) -> bool:
    """Whether frames of any forest are due and not sent yet; an application that is not started has none."""
    service: Service | None = getattr(app.state, "service", None)
    return service is not None and service.forests.frames_in_work


async def _prepare(settings: Settings, importer: LimitedImporter | None) -> None:
    """Compile the kernels, if they are not, and load what the first upload needs."""
    await compile_kernels(settings)
    if importer and settings.prepare:
        await asyncio.to_thread(importer.prepare)


async def end_threads(threads: Executor, patience_s: float) -> None:
    """End the threads of cancelled tasks and requests, with the processes that they wait for.

    uvicorn ends this process by a signal as soon as the application has shut down, which waits for no thread.
    The event loop's own method to wait for its threads is not used: in Python 3.11 it logs an error when the
    loop is closed before the threads have ended.
    """
    ending = Thread(target=threads.shutdown, daemon=True)
    ending.start()
    end_s = time.monotonic() + patience_s
    while ending.is_alive() and time.monotonic() < end_s:
        GuardedProcess.end_all()  # again and again, because a thread may start the next
        await asyncio.sleep(THREAD_CHECK_S)


def _service(settings: Settings, importer: MeshImporter) -> Service:
    stores = Stores(settings.data_dir, settings.store_url)
    sessions = open_database(settings.database)
    forests = Forests(
        settings, TableCache(stores), partial(records_of, sessions), partial(compliance_of, sessions)
    )
    return Service(
        settings=settings,
        sessions=sessions,
        stores=stores,
        forests=forests,
        owners=ForestOwners(
            sessions, settings.peer_url, settings.lease_s, lambda: forests.shares, forests.end_shared
        ),
        server_name=f"galewood {VERSION}",
        importer=importer,
        loop=asyncio.get_running_loop(),
        imports=Turns("imports", settings.concurrent_imports, settings.concurrent_uploads),
        upload_slots=asyncio.Semaphore(settings.concurrent_uploads),
    )


def _warm_up(service: Service) -> None:
    """Do once what the first client of a streamed forest would wait for."""
    for file in list(shipped_tables(service.settings.species_dir).values())[:1]:
        table = file.read_bytes()
        warm_up(table)
        service.stores.tables.has(hashlib.sha256(table).hexdigest())  # connects to the bucket


def _lock(data_dir: Path) -> TextIO:
    """Lock the data folder. StartError if another server uses it."""
    data_dir.mkdir(parents=True, exist_ok=True)
    handle = (data_dir / ".lock").open("w")
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        handle.close()
        raise StartError(
            f"Another server is using {data_dir}: set GALEWOOD_DATA_DIR to a different folder."
        ) from None
    return handle


def run(app: FastAPI, settings: Settings) -> None:
    """Serve until interrupted, then finish open requests. Exits with NOT_STARTED if the start fails."""
    configure_logging(settings)
    try:
        check_address(settings.host, settings.port)
    except StartError as error:
        log.error("%s", error)
        sys.exit(NOT_STARTED)
    config = uvicorn.Config(
        with_clear_failures(app, settings),
        host=settings.host,
        port=settings.port,
        backlog=ACCEPTED_AT_ONCE,
        http=protocol_with_limits(
            settings.header_s, settings.write_stall_s, OpenConnections(settings.connections)
        ),
        ws=metered_protocol(
            SocketLimits(
                settings.socket_frames_per_s, settings.socket_bytes_per_s, settings.socket_message_bytes
            )
        ),
        ws_max_size=settings.socket_message_bytes,
        ws_per_message_deflate=False,
        timeout_graceful_shutdown=settings.shutdown_s,
        forwarded_allow_ips=settings.trusted_proxies,
        log_config=None,
        server_header=False,
        access_log=False,
    )
    server = Server(config)
    with suppress(KeyboardInterrupt):
        server.run()
    if not server.started:
        sys.exit(NOT_STARTED)

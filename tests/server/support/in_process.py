"""The application in the process of the test, without a socket: for tests that look into it."""

from __future__ import annotations

from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager
from pathlib import Path
from typing import Any

import httpx
from fastapi import FastAPI
from galewood_server.access import MeshImporter
from galewood_server.app.main import create_app
from galewood_server.settings import Settings

from tests.server.support.fake_server import fake_importer
from tests.server.support.server_process import FAKE_JOB, empty_database


@asynccontextmanager
async def application(
    folder: Path, importer: MeshImporter = fake_importer, **given: Any
) -> AsyncGenerator[tuple[FastAPI, httpx.AsyncClient]]:
    """A started application with an empty database in the folder, and a local client of it."""
    (folder / "galewood.sqlite").write_bytes(empty_database())
    settings: dict[str, Any] = {
        "data_dir": folder,
        "builtin_trees": False,
        "prepare": False,
        "scheduler_url": "tcp://127.0.0.1:9",
        "job_module": FAKE_JOB,
        **given,
    }
    app = create_app(Settings(**settings), importer)
    transport = httpx.ASGITransport(app, client=("127.0.0.1", 5))
    async with (
        app.router.lifespan_context(app),
        httpx.AsyncClient(transport=transport, base_url="http://localhost:8000") as api,
    ):
        yield app, api

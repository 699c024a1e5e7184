"""A disk that is full when a revised mesh is stored: 507, and the tree is as before."""

from __future__ import annotations

import errno
from pathlib import Path
from typing import Any

import anyio
import httpx
import pytest
from galewood_server.app.main import create_app
from galewood_server.settings import Settings
from galewood_server.storage import FileStore

from tests.server.conftest import empty_database
from tests.server.fake_server import fake_importer


def no_space(*_: object) -> str:
    raise OSError(errno.ENOSPC, "No space left on device")


def test_patch_and_upload_on_a_full_disk_are_507(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "galewood.sqlite").write_bytes(empty_database())
    given: dict[str, Any] = {
        "data_dir": tmp_path,
        "builtin_trees": False,
        "scheduler_url": "tcp://127.0.0.1:9",
    }
    app = create_app(Settings(**given), fake_importer)

    async def run() -> None:
        transport = httpx.ASGITransport(app, client=("127.0.0.1", 5))
        async with (
            app.router.lifespan_context(app),
            httpx.AsyncClient(transport=transport, base_url="http://localhost:8000") as api,
        ):
            tree = (await api.post("/api/trees", files={"file": ("a.obj", b"a tree")})).json()
            path = f"/api/trees/{tree['id']}"
            monkeypatch.setattr(FileStore, "put", no_space)
            answers = [
                await api.patch(path, json={"height_m": 7.0, "name": "renamed"}),
                await api.post("/api/trees", files={"file": ("b.obj", b"another")}),
            ]
            for answer in answers:
                assert (answer.status_code, answer.json()["code"]) == (507, "disk-full")
            assert (await api.get(path)).json() == tree

    anyio.run(run)

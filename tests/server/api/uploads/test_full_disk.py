"""A disk that is full when a revised mesh is stored: 507, and the tree is as before."""

from __future__ import annotations

import errno
from pathlib import Path

import anyio
import pytest
from galewood_server.storage import FileStore

from tests.server.support.in_process import application


def no_space(*_: object) -> str:
    raise OSError(errno.ENOSPC, "No space left on device")


def test_patch_and_upload_on_a_full_disk_are_507(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    async def run() -> None:
        async with application(tmp_path) as (_, api):
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

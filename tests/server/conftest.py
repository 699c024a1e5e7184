"""Fixtures: server processes, stopped after the test."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from pathlib import Path

import pytest

from tests.server.support.server_process import FAKE_JOB, FAKE_SERVER, Server, fake_service


@pytest.fixture
def start_server(tmp_path: Path) -> Iterator[Callable[..., Server]]:
    """Start servers that share one data folder; builds and mesh import are fakes by default."""
    servers: list[Server] = []

    def start(module: str = FAKE_SERVER, **environment: str) -> Server:
        (tmp_path / "data").mkdir(exist_ok=True)
        fake = {"GALEWOOD_JOB_MODULE": FAKE_JOB} if "fake" in module else {}
        server = Server(tmp_path / "data", module, {**fake, **environment})
        servers.append(server)
        return server.start()

    yield start
    for server in servers:
        server.stop()


@pytest.fixture(scope="session")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    """One server for all files whose tests leave nothing in it; the others define their own."""
    with fake_service(tmp_path_factory.mktemp("server")) as running:
        yield running

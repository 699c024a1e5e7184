"""A real server process on a free port with a data folder of its own, ended with the test."""

from __future__ import annotations

import os
import signal
import socket
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import httpx
import psutil
import pytest

REPOSITORY = Path(__file__).resolve().parents[2]
# fake builds need no cluster: none is started, and nobody calls this address
NO_CLUSTER = {"GALEWOOD_SCHEDULER_URL": "tcp://127.0.0.1:9"}


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def wait_until(holds: Callable[[], Any], timeout_s: float = 30.0, every_s: float = 0.05) -> Any:
    end_s = time.monotonic() + timeout_s
    while time.monotonic() < end_s:
        value = holds()
        if value:
            return value
        time.sleep(every_s)
    raise AssertionError(f"did not happen within {timeout_s} s")


@dataclass
class Server:
    """A server process; `stop` ends it kindly, `kill` as a crash would."""

    data_dir: Path
    module: str
    environment: dict[str, str] = field(default_factory=dict)
    port: int = field(default_factory=free_port)
    process: subprocess.Popen[bytes] | None = None

    @property
    def url(self) -> str:
        return f"http://127.0.0.1:{self.port}"

    @property
    def socket_url(self) -> str:
        return f"ws://127.0.0.1:{self.port}/ws/forest"

    def start(self, *arguments: str) -> Server:
        environment = {
            **os.environ,
            "GALEWOOD_DATA_DIR": str(self.data_dir),
            "PORT": str(self.port),
            "GALEWOOD_WORKERS": "1",
            "GALEWOOD_BUILTIN_SPECIES": "false",
            "GALEWOOD_CLUSTER_IDLE_S": "1000",
            **self.environment,
        }
        with (self.data_dir.parent / "server.log").open("ab") as log:
            self.process = subprocess.Popen(
                [sys.executable, "-m", self.module, *arguments],
                env=environment, cwd=REPOSITORY, stdout=log, stderr=log,
            )  # fmt: skip
        wait_until(self._answers, 60)
        return self

    def _answers(self) -> bool:
        assert self.process and self.process.poll() is None, self.log()
        try:
            return httpx.get(f"{self.url}/healthz", timeout=5).status_code == 200
        except httpx.TransportError:
            return False

    def log(self) -> str:
        return (self.data_dir.parent / "server.log").read_text(errors="replace")

    def family(self) -> list[psutil.Process]:
        assert self.process
        return psutil.Process(self.process.pid).children(recursive=True)

    def stop(self, how: signal.Signals = signal.SIGTERM) -> None:
        if self.process and self.process.poll() is None:
            self.process.send_signal(how)
            self.process.wait(20)

    def kill(self) -> None:
        self.stop(signal.SIGKILL)

    def client(self) -> httpx.Client:
        return httpx.Client(base_url=self.url, timeout=60)


@pytest.fixture
def start_server(tmp_path: Path) -> Iterator[Callable[..., Server]]:
    """Start servers that share one data folder; builds and intake are fakes unless told otherwise."""
    servers: list[Server] = []

    def start(module: str = "tests.server.fake_server", **environment: str) -> Server:
        (tmp_path / "data").mkdir(exist_ok=True)
        fake = {"GALEWOOD_JOB_MODULE": "tests.server.fake_job"} if "fake" in module else {}
        server = Server(tmp_path / "data", module, {**fake, **environment})
        servers.append(server)
        return server.start()

    yield start
    for server in servers:
        server.stop()

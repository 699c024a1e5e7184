"""A real server process on a free port with its own data folder."""

from __future__ import annotations

import hashlib
import http.client
import os
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Generator
from contextlib import contextmanager
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import httpx
import psutil
import psycopg
from galewood.util.guarded_process import GUARD_SCRIPT
from galewood_server.storage.database import migrate

REPOSITORY = Path(__file__).resolve().parents[3]
FAKE_SERVER = "tests.server.support.fake_server"
FAKE_JOB = "tests.server.support.fake_job"
"""Modules that run in place of `galewood serve` and of a build."""
# fake builds need no cluster: with an external address, none is started
NO_CLUSTER = {"GALEWOOD_SCHEDULER_URL": "tcp://127.0.0.1:9"}


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return int(probe.getsockname()[1])


def wait_until(holds: Callable[[], Any], timeout_s: float = 120.0, every_s: float = 0.05) -> Any:
    end_s = time.monotonic() + timeout_s
    while time.monotonic() < end_s:
        value = holds()
        if value:
            return value
        time.sleep(every_s)
    raise AssertionError(f"did not happen within {timeout_s} s")


def shared_services(folder: Path) -> dict[str, str]:
    """Under `make test-distributed`: settings for a separate PostgreSQL database and bucket prefix."""
    postgres, store = os.environ.get("GALEWOOD_TEST_POSTGRES"), os.environ.get("GALEWOOD_TEST_STORE")
    if not postgres or not store:
        return {}
    name = "t" + hashlib.sha256(str(folder).encode()).hexdigest()[:12]
    with psycopg.connect(f"{postgres}/postgres", autocommit=True) as connection:
        if not connection.execute("SELECT 1 FROM pg_database WHERE datname = %s", (name,)).fetchone():
            connection.execute(f'CREATE DATABASE "{name}"'.encode())
    return {"GALEWOOD_DATABASE_URL": f"{postgres}/{name}", "GALEWOOD_STORE_URL": f"{store}/{name}"}


@cache
def empty_database() -> bytes:
    """A migrated SQLite database: a server that finds one does not load Alembic."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "empty.sqlite")
        migrate(f"sqlite:///{path}")
        return path.read_bytes()


@dataclass
class Server:
    """A server process; `stop` ends it gracefully, `kill` simulates a crash."""

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

    def variables(self) -> dict[str, str]:
        """Environment of the server and of processes that use its data."""
        return {
            **os.environ,
            "GALEWOOD_DATA_DIR": str(self.data_dir),
            "PORT": str(self.port),
            "GALEWOOD_WORKERS": "1",
            "GALEWOOD_BUILTIN_TREES": "false",
            "GALEWOOD_CLUSTER_IDLE_S": "1000",
            "GALEWOOD_PREPARE": "false",
            **shared_services(self.data_dir),
            **self.environment,
        }

    def start(self, *arguments: str) -> Server:
        self.launch(*arguments)
        try:
            wait_until(self._answers, 300)
        except AssertionError:
            self.stop()
            raise
        return self

    def launch(self, *arguments: str) -> None:
        """Start the process without waiting for an answer."""
        database = self.data_dir / "galewood.sqlite"
        if "fake" in self.module and not database.exists():  # the real one makes its own
            database.write_bytes(empty_database())
        with (self.data_dir.parent / "server.log").open("ab") as log:
            self.process = subprocess.Popen(
                [sys.executable, "-m", self.module, *arguments],
                env=self.variables(), cwd=REPOSITORY, stdout=log, stderr=log,
            )  # fmt: skip

    def _answers(self) -> bool:
        assert self.process and self.process.poll() is None, self.log()
        # asked many times while a server starts: httpx would load all certificates each time
        connection = http.client.HTTPConnection("127.0.0.1", self.port, timeout=5)
        try:
            connection.request("GET", "/healthz")
            return connection.getresponse().status == 200
        except (OSError, http.client.HTTPException):
            return False
        finally:
            connection.close()

    def log(self) -> str:
        return (self.data_dir.parent / "server.log").read_text(errors="replace")

    def family(self) -> list[psutil.Process]:
        assert self.process
        return psutil.Process(self.process.pid).children(recursive=True)

    def descendants(self) -> list[psutil.Process]:
        """All processes that were started by this server, found by their settings and folder.

        Unlike `family`, it finds those whose parent has gone.
        """
        found: list[psutil.Process] = []
        for process in psutil.process_iter():
            try:
                settings, folder = process.environ().get("GALEWOOD_DATA_DIR", ""), process.cwd()
                if str(self.data_dir) in (settings, *map(str, Path(folder).parents)):
                    found.append(process)
            except (psutil.Error, OSError):  # it has ended
                continue
        return [one for one in found if one.status() != psutil.STATUS_ZOMBIE]

    def stop(self, how: signal.Signals = signal.SIGTERM) -> None:
        if self.process and self.process.poll() is None:
            self.process.send_signal(how)
            self.process.wait(300)

    def kill(self) -> None:
        self.stop(signal.SIGKILL)

    def client(self) -> httpx.Client:
        return httpx.Client(base_url=self.url, timeout=240)


def command_line(process: psutil.Process) -> list[str]:
    """The command line of a process; empty if it has ended, and for guards, which name their program's."""
    try:
        words = process.cmdline()
    except psutil.NoSuchProcess:  # also raised for zombies
        return []
    return [] if str(GUARD_SCRIPT) in words else words


@contextmanager
def fake_service(folder: Path, **environment: str) -> Generator[Server]:
    """A server with fake builds and mesh import in this folder, for all tests of a module."""
    (folder / "data").mkdir()
    settings = {"GALEWOOD_JOB_MODULE": FAKE_JOB, **NO_CLUSTER, **environment}
    server = Server(folder / "data", FAKE_SERVER, settings).start()
    yield server
    server.stop()

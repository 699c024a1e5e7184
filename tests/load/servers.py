"""The servers under load, and what stands before them: a client's choice of a server, as a proxy makes it."""

from __future__ import annotations

import contextlib
import itertools
import os
import random
import signal
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass, field
from importlib.machinery import SourceFileLoader
from pathlib import Path
from types import ModuleType

import httpx
import psutil
from galewood_server.access.keys import new_key
from galewood_server.settings import Settings
from galewood_server.storage import Stores

from tests.load.priorities import set_niceness
from tests.load.proxy import proxy
from tests.load.wire_client import Target

REPOSITORY = Path(__file__).resolve().parents[2]
SHIPPED = REPOSITORY / "assets" / "species" / "shipped"
STARTED_WITHIN_S = 180.0
STARTING_NICENESS = 15 if os.geteuid() == 0 else 0
"""A server that starts has a machine of its own elsewhere; only root can raise the priority again."""


def free_port() -> int:
    """A free port of the loopback interface, below those of connections: a server returns to its own."""
    while True:
        port = random.randrange(20_000, 30_000)
        with socket.socket() as probe, contextlib.suppress(OSError):
            probe.bind(("127.0.0.1", port))
            return port


@dataclass
class Node:
    """One server process with a data folder of its own."""

    folder: Path
    environment: dict[str, str]
    port: int = field(default_factory=free_port)
    process: subprocess.Popen[bytes] | None = None
    starting: bool = False

    def start(self) -> None:
        """Start the process; `wait` waits for it."""
        self.folder.mkdir(parents=True, exist_ok=True)
        environment = {**self.environment, "GALEWOOD_DATA_DIR": str(self.folder), "PORT": str(self.port)}
        if "GALEWOOD_DATABASE_URL" in environment:
            environment["GALEWOOD_PEER_URL"] = f"http://127.0.0.1:{self.port}"
        with (self.folder / "server.log").open("ab") as log:
            self.process = subprocess.Popen(
                [sys.executable, "-m", "galewood_server.cli.main", "serve"],
                env=environment, cwd=REPOSITORY, stdout=log, stderr=log,
            )  # fmt: skip
        os.setpriority(os.PRIO_PROCESS, self.process.pid, STARTING_NICENESS)  # threads inherit it
        self.starting = True

    def started(self) -> None:
        """The server answers: give it the priority of the others."""
        if self.starting and self.process and self.process.poll() is None and STARTING_NICENESS:
            set_niceness(self.process.pid, 0)
        self.starting = False

    @property
    def ready(self) -> bool:
        """Whether the server answers."""
        try:
            return httpx.get(f"http://127.0.0.1:{self.port}/api/health", timeout=5).status_code == 200
        except httpx.HTTPError:
            return False

    def wait(self) -> None:
        """Wait until the server answers. RuntimeError if it ends or takes too long."""
        end_s = time.monotonic() + STARTED_WITHIN_S
        while not self.ready:
            if self.process is None or self.process.poll() is not None or time.monotonic() > end_s:
                raise RuntimeError(f"a server did not start: {self.log()[-2000:]}")
            time.sleep(0.2)

    def log(self) -> str:
        """What the server has written."""
        return (self.folder / "server.log").read_text(errors="replace")

    def stop(self, how: signal.Signals = signal.SIGTERM) -> None:
        """End the process."""
        if self.process and self.process.poll() is None:
            self.process.send_signal(how)
            self.process.wait(60)


@dataclass
class Fleet:
    """Servers that share everything but their data folders."""

    nodes: list[Node]
    key: str
    table: str
    mesh: str
    may_fail: bool
    proxy_port: int | None = None
    down: set[int] = field(default_factory=set[int])
    """Ports that do not answer, for clients without a proxy."""

    def __post_init__(self) -> None:
        self._turns = itertools.count()

    def next(self) -> Target:
        """The proxy, or any server that answers, one after the other."""
        if self.proxy_port is not None:
            return Target(self.proxy_port, self.key, self.table, self.mesh, self.may_fail)
        up = [node for node in self.nodes if node.port not in self.down] or self.nodes
        return self.target(up[next(self._turns) % len(up)])

    def target(self, node: Node) -> Target:
        """A server as its clients know it."""
        return Target(node.port, self.key, self.table, self.mesh, self.may_fail)

    @property
    def processes(self) -> list[psutil.Process]:
        """The servers' processes."""
        running = [node.process for node in self.nodes if node.process and node.process.poll() is None]
        return [psutil.Process(process.pid) for process in running]

    def complaints(self) -> list[str]:
        """Lines of the logs that should not be there."""
        lines = [line for node in self.nodes for line in node.log().splitlines()]
        return [line for line in lines if "Traceback" in line or "a forest failed" in line]


@contextmanager
def fleet(count: int, distributed: bool, proxy_program: str | None = None) -> Generator[Fleet]:
    """Start servers; with `distributed` on one PostgreSQL, one S3-compatible store and one Dask cluster.

    `proxy_program` is Caddy, to be started in front of them.
    """
    if not (Settings().page_dir / "index.html").exists():
        raise SystemExit("the page is not built: run `make build`, or set GALEWOOD_PAGE_DIR")
    key, key_hash = new_key()
    with ExitStack() as stack:
        folder = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="galewood-load-")))
        environment = {
            **os.environ,
            "HOST": "127.0.0.1",
            "GALEWOOD_API_KEYS": key_hash,
            "GALEWOOD_TRUSTED_PROXIES": "127.0.0.1",  # each client plays a visitor with an address of its own
            "GALEWOOD_BUILTIN_TREES": "false",
            "GALEWOOD_REPLACED_FILES_S": "60",
        }
        if distributed:
            environment |= _shared_services(stack, folder)
        stores = Stores(folder / "server-0", environment.get("GALEWOOD_STORE_URL"))
        table = stores.tables.put((SHIPPED / "maple.table").read_bytes())
        mesh = stores.meshes.put((SHIPPED / "maple.glb").read_bytes())
        nodes = [Node(folder / f"server-{k}", environment) for k in range(count)]
        for node in nodes:
            stack.callback(node.stop)
            node.start()
        for node in nodes:
            node.wait()
            node.started()
        port = free_port() if proxy_program else None
        if proxy_program and port:
            stack.enter_context(proxy(proxy_program, folder, port, [node.port for node in nodes]))
        yield Fleet(nodes, key, table, mesh, distributed, port)


def _shared_services(stack: ExitStack, folder: Path) -> dict[str, str]:
    """Start PostgreSQL, a store and a cluster like `scripts/test-distributed`; settings of the servers."""
    path = REPOSITORY / "scripts" / "test-distributed"
    script = ModuleType("test_distributed")
    script.__file__ = str(path)
    SourceFileLoader(script.__name__, str(path)).exec_module(script)
    database = stack.enter_context(script.postgres(folder))
    store = stack.enter_context(script.store(folder))
    os.environ.update(store)  # for the files that are put there from here
    cluster = stack.enter_context(script.cluster(folder, {**os.environ, **store}))
    return {
        **store,
        "GALEWOOD_DATABASE_URL": f"{database}/postgres",
        "GALEWOOD_STORE_URL": "s3://galewood",
        "GALEWOOD_SCHEDULER_URL": cluster["GALEWOOD_TEST_SCHEDULER"],
        "GALEWOOD_TEST_WORKERS": cluster["GALEWOOD_TEST_WORKERS"],
        "GALEWOOD_JOB_ATTEMPTS": "20",  # each kill is one
    }


def victims(fleet: Fleet, kind: str, dice: random.Random) -> list[psutil.Process]:
    """The processes of a kind that may be killed: one server, all jobs, or all workers of the cluster."""
    if kind == "server":
        return [dice.choice(fleet.processes)] if fleet.processes else []
    if kind == "job":
        children = [child for server in fleet.processes for child in server.children()]
        return [child for child in children if "job_process" in " ".join(child.cmdline())]
    return [child for nanny in worker_pids(fleet) for child in psutil.Process(nanny).children()[-1:]]


def worker_pids(fleet: Fleet) -> list[int]:
    """The processes that start the workers of the cluster again."""
    pids = fleet.nodes[0].environment.get("GALEWOOD_TEST_WORKERS", "").split(",")
    return [int(pid) for pid in pids if pid]

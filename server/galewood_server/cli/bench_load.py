"""Load benchmark of one server process on one core: clients × trees × 30 Hz, and clients that never read.

The server and the clients run in separate processes pinned to different cores. Run by `galewood bench-serve`.
"""

from __future__ import annotations

import json
import os
import socket
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Generator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, cast

import httpx
import psutil
from galewood.motion.wind import Wind

from galewood_server.cli.load import Load
from galewood_server.storage import FileStore

SETTLE_S = 3.0
STALLED_WITHIN_S = 30.0


def run_load(tables: list[Path], load: Load) -> dict[str, Any]:
    """Run a load benchmark and return its results."""
    with tempfile.TemporaryDirectory() as folder:
        store = FileStore(Path(folder) / "tables")
        names = [store.put(path.read_bytes()) for path in tables]
        before = os.getloadavg()[0]
        with _server(Path(folder), load) as (process, port):
            job = {
                "port": port,
                "tables": names,
                "trees": load.trees,
                "forests": load.forests,
                "wind": Wind().document(),
                "method": load.method,
                "core": None if load.client_core < 0 else load.client_core,
                "settle_s": SETTLE_S,
            }
            measured = _measure(process, job, load)
    return {
        "load": load.model_dump(),
        "machine": {"cores": os.cpu_count(), "load_average_before": before},
        **measured,
    }


def _measure(server: psutil.Process, job: dict[str, Any], load: Load) -> dict[str, Any]:
    with _clients({**job, "clients": load.clients, "stalled": False}) as listeners:
        watch = Watch(server)
        _phase(listeners, load.seconds)
        steady = watch.figures()
        if not load.stalled:
            return _with_phases({"steady": steady}, listeners)
        stalled_job = {**job, "clients": load.stalled, "stalled": True, "seconds": STALLED_WITHIN_S}
        with _clients(stalled_job) as stalled:
            watch = Watch(server)
            _phase(listeners, STALLED_WITHIN_S)
            with_stalled = watch.figures()
            with_stalled["stalled_clients"] = _last_line(stalled)
        with_stalled["sockets_left"] = _sockets(job["port"])
        return _with_phases({"steady": steady, "with_stalled_clients": with_stalled}, listeners)


def _with_phases(measured: dict[str, Any], listeners: subprocess.Popen[str]) -> dict[str, Any]:
    """Merge the server's and the clients' results of each phase."""
    assert listeners.stdin
    listeners.stdin.close()
    phases = cast(list[dict[str, Any]], _last_line(listeners)["phases"])
    for own, seen in zip(measured.values(), phases, strict=True):
        own.update(seen)
    return measured


class Watch:
    """Measures CPU and memory usage of a process in the background."""

    def __init__(self, process: psutil.Process) -> None:
        self._process = process
        self._spent_s, self._begin_s = self._cpu_s(), time.monotonic()
        self._memory = [self._rss_mb()]
        self._done = threading.Event()
        self._thread = threading.Thread(target=self._sample, daemon=True)
        self._thread.start()

    def _cpu_s(self) -> float:
        times = self._process.cpu_times()
        return float(times.user + times.system)

    def _rss_mb(self) -> float:
        return self._process.memory_info().rss / 1e6

    def _sample(self) -> None:
        while not self._done.wait(0.25):
            self._memory.append(self._rss_mb())

    def figures(self) -> dict[str, Any]:
        """Stop and return CPU share and memory since the start."""
        self._done.set()
        self._thread.join()
        share = (self._cpu_s() - self._spent_s) / (time.monotonic() - self._begin_s)
        memory = {"begin": self._memory[0], "highest": max(self._memory), "end": self._memory[-1]}
        return {"server_cpu_share": share, "server_memory_mb": memory}


@contextmanager
def _server(folder: Path, load: Load) -> Generator[tuple[psutil.Process, int]]:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = int(probe.getsockname()[1])
    sockets = str(load.clients + load.stalled + 8)
    trees = str(max(200_000, (load.clients + load.stalled) * load.trees))
    environment = {
        **os.environ,
        "GALEWOOD_DATA_DIR": str(folder),
        "HOST": "127.0.0.1",
        "PORT": str(port),
        "GALEWOOD_BUILTIN_TREES": "false",
        "GALEWOOD_SOCKET_CONNECTIONS": sockets,
        "GALEWOOD_SOCKET_CONNECTIONS_PER_ADDRESS": sockets,
        "GALEWOOD_SERVER_TREES": trees,
        "GALEWOOD_ADDRESS_TREES": trees,
        "GALEWOOD_ADDRESS_TREES_PER_S": "1e9",
        "GALEWOOD_FOREST_TREES": str(max(20_000, load.trees)),
    }

    def pin() -> None:
        if load.server_core >= 0:
            os.sched_setaffinity(0, {load.server_core})

    child = subprocess.Popen(
        [sys.executable, "-m", "galewood_server.cli.main", "serve"],
        env=environment,
        preexec_fn=pin,
        stdout=subprocess.DEVNULL,
    )
    try:
        _wait_for(port, child)
        yield psutil.Process(child.pid), port
    finally:
        child.terminate()
        child.wait(20)


def _wait_for(port: int, child: subprocess.Popen[bytes], patience_s: float = 120.0) -> None:
    end_s = time.monotonic() + patience_s
    while time.monotonic() < end_s:
        if child.poll() is not None:
            raise RuntimeError("the server did not start")
        try:
            httpx.get(f"http://127.0.0.1:{port}/healthz", timeout=5).raise_for_status()
            return
        except httpx.HTTPError:
            time.sleep(0.2)
    raise RuntimeError("the server did not respond")


def _sockets(port: int) -> int:
    return int(httpx.get(f"http://127.0.0.1:{port}/healthz", timeout=10).json()["sockets"])


@contextmanager
def _clients(job: dict[str, Any]) -> Generator[subprocess.Popen[str]]:
    """Start a client process and wait until all clients have requested their forest."""
    child = subprocess.Popen(
        [sys.executable, "-m", "galewood_server.cli.bench_client"],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    )
    try:
        assert child.stdin and child.stdout
        child.stdin.write(json.dumps(job) + "\n")
        child.stdin.flush()
        _expect(child, "ready")
        yield child
    finally:
        child.kill()
        child.wait()


def _phase(child: subprocess.Popen[str], seconds: float) -> None:
    assert child.stdin
    child.stdin.write(f"{seconds}\n")
    child.stdin.flush()
    _expect(child, "measured")


def _expect(child: subprocess.Popen[str], word: str) -> None:
    assert child.stdout
    line = child.stdout.readline().strip()
    if line != word:
        raise RuntimeError(f"the client process failed: {line!r}")


def _last_line(child: subprocess.Popen[str]) -> dict[str, Any]:
    assert child.stdout
    return cast(dict[str, Any], json.loads(child.stdout.readline()))

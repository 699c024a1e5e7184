"""Caddy in front of the servers, with the configuration that is deployed."""

from __future__ import annotations

import socket
import subprocess
import time
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from pathlib import Path

CADDYFILE = Path(__file__).resolve().parents[2] / "deploy" / "Caddyfile"
SERVERS = "server-a:8000 server-b:8000"
STARTED_WITHIN_S = 20.0


def configuration(servers: Sequence[int]) -> str:
    """deploy/Caddyfile for servers at ports of this machine.

    The clients of the load test are trusted to say who they are, because each plays a visitor of its own.
    """
    text = CADDYFILE.read_text()
    for given, here in (
        (SERVERS, " ".join(f"127.0.0.1:{port}" for port in servers)),
        ("admin 127.0.0.1:2019", "admin off\n\tdefault_bind 127.0.0.1"),
        ("\tservers {", "\tservers {\n\t\ttrusted_proxies static 127.0.0.1/32"),
    ):
        if text.count(given) != 1:
            raise ValueError(f"{CADDYFILE} has no {given!r}")
        text = text.replace(given, here)
    return text


@contextmanager
def proxy(
    program: str, folder: Path, port: int, servers: Sequence[int]
) -> Generator[subprocess.Popen[bytes]]:
    """A proxy at a port while the block runs. RuntimeError if it does not start."""
    file = folder / "Caddyfile"
    file.write_text(configuration(servers))
    environment = {"SITE": f"http://:{port}", "HOME": str(folder), "PATH": "/usr/bin:/bin"}
    with (folder / "proxy.log").open("wb") as log:
        child = subprocess.Popen(
            [program, "run", "--config", str(file), "--adapter", "caddyfile"],
            env=environment, stdout=log, stderr=log,
        )  # fmt: skip
    try:
        _wait(child, port, folder / "proxy.log")
        yield child
    finally:
        child.terminate()
        child.wait(20)


def _wait(child: subprocess.Popen[bytes], port: int, log: Path) -> None:
    end_s = time.monotonic() + STARTED_WITHIN_S
    while time.monotonic() < end_s and child.poll() is None:
        try:
            socket.create_connection(("127.0.0.1", port), 2).close()
            return
        except OSError:
            time.sleep(0.1)
    raise RuntimeError(f"the proxy did not start: {log.read_text()[-2000:]}")

"""The end of a server: graceful while requests are open, or by a kill, at any moment."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import random
import signal
import socket
import time
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from threading import Event, Timer

import httpx
import pytest
from galewood_server.app.main import end_threads
from galewood_server.storage import Stores

from tests.server.jobs.test_jobs import begin, gone
from tests.server.support.server_process import (
    FAKE_JOB,
    FAKE_SERVER,
    NO_CLUSTER,
    Server,
    command_line,
    wait_until,
)

STOPS = int(os.environ.get("GALEWOOD_TEST_STOPS", "9"))
"""How many servers are stopped at random moments."""

UPLOAD = (
    "POST /api/trees HTTP/1.1\r\nHost: localhost\r\nContent-Length: 100000\r\n"
    "Content-Type: multipart/form-data; boundary=x\r\n\r\n--x\r\n"
)


def asked(server: Server, request: str) -> socket.socket:
    client = socket.socket()
    client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    client.settimeout(60)
    client.connect(("127.0.0.1", server.port))
    client.sendall(request.encode())
    return client


def test_open_requests_are_broken_off_without_a_traceback(start_server: Callable[..., Server]) -> None:
    server = start_server(GALEWOOD_SHUTDOWN_S="1", GALEWOOD_BODY_STALL_S="60", **NO_CLUSTER)
    mesh = Stores(server.data_dir, "").meshes.put(b"x" * 8_000_000)
    upload = asked(server, UPLOAD)  # of which no more comes
    others = [asked(server, f"GET {path} HTTP/1.1\r\nHost: localhost\r\n\r\n")
              for path in (f"/api/meshes/{mesh}", "/api/events")]  # fmt: skip
    for one in others:
        assert one.recv(15) == b"HTTP/1.1 200 OK"  # and nobody reads the rest
    with server.client() as api:
        wait_until(lambda: "galewood_event_streams 1.0" in api.get("/metrics").text)
    server.stop(signal.SIGINT)
    head, _, body = upload.makefile("rb").read().partition(b"\r\n\r\n")
    assert head.startswith(b"HTTP/1.1 503") and json.loads(body)["code"] == "server-stopping"
    assert "Traceback" not in server.log() and "ASGI callable" not in server.log()
    assert server.log().count("was aborted") >= 2
    for one in (upload, *others):
        one.close()


def importing(server: Server) -> socket.socket:
    """The connection of an upload whose import has started, and never ends."""
    body = '--x\r\nContent-Disposition: form-data; name="file"; filename="a.obj"\r\n\r\nv 0\r\n--x--\r\n'
    head = UPLOAD.partition("\r\n\r\n")[0].replace("100000", str(len(body)))
    upload = asked(server, f"{head}\r\n\r\n{body}")
    wait_until(lambda: any((server.data_dir / "tmp").rglob("in.npz")))
    wait_until(lambda: any("galewood.sandbox.child" in command_line(one) for one in server.family()))
    return upload


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGINT])
def test_an_import_has_ended_when_a_stopped_server_ends(
    start_server: Callable[..., Server], how: signal.Signals
) -> None:
    server = start_server("tests.server.support.hanging_server", GALEWOOD_SHUTDOWN_S="1", **NO_CLUSTER)
    upload = importing(server)
    family = server.family()
    server.stop(how)
    assert gone(family)
    assert not (server.data_dir / "tmp").exists()
    assert "Traceback" not in server.log(), server.log()
    upload.close()


def test_a_thread_that_outlasts_the_time_to_stop_is_no_error(caplog: pytest.LogCaptureFixture) -> None:
    """The event loop, which is closed before the thread has ended, logged "invalid state" in Python 3.11."""
    released, threads = Event(), ThreadPoolExecutor()

    async def stopped() -> None:
        loop = asyncio.get_running_loop()
        loop.set_default_executor(threads)
        busy = loop.run_in_executor(None, released.wait)
        await end_threads(threads, 0.1)
        assert not busy.done()
        Timer(0.1, released.set).start()

    asyncio.run(stopped())
    assert released.is_set() and not caplog.records, caplog.text


def test_a_first_start_compiles_the_kernels_until_the_server_stops(
    start_server: Callable[..., Server], tmp_path: Path
) -> None:
    cache = {"GALEWOOD_PREPARE": "true", "NUMBA_CACHE_DIR": str(tmp_path / "numba")}
    server = start_server(**cache, **NO_CLUSTER)
    wait_until(
        lambda: any(
            "galewood.pipeline.stages.kernel_compilation" in command_line(one) for one in server.family()
        )
    )
    family = server.family()
    server.stop()
    assert gone(family)
    assert "Traceback" not in server.log(), server.log()


def test_an_import_ends_with_a_killed_server_and_its_folder_with_the_next_start(
    start_server: Callable[..., Server],
) -> None:
    server = start_server("tests.server.support.hanging_server", **NO_CLUSTER)
    folders = server.data_dir / "tmp"
    upload = importing(server)
    server.kill()
    wait_until(lambda: not server.descendants())
    assert any(folders.rglob("in.npz")), "what the killed server could not remove"
    start_server("tests.server.support.hanging_server", **NO_CLUSTER)
    assert not any(folders.rglob("in.npz"))
    upload.close()


@pytest.mark.timeout(120 + 30 * STOPS)
def test_a_server_stopped_at_random_moments_leaves_no_process(tmp_path: Path) -> None:
    seed = int(os.environ.get("GALEWOOD_TEST_SEED", random.randrange(1 << 32)))
    print(f"seed {seed}")
    dice = random.Random(seed)
    for number in range(STOPS):
        folder = tmp_path / str(number)
        (folder / "data").mkdir(parents=True)
        fakes = {"GALEWOOD_JOB_MODULE": FAKE_JOB, "FAKE_STEP_S": "1"}
        server = Server(folder / "data", FAKE_SERVER, fakes)
        how = dice.choice([signal.SIGTERM, signal.SIGINT, signal.SIGKILL])
        early = number % 3 == 0
        if early:
            server.launch()
        else:  # while a job and the cluster start
            server.start()
            with server.client() as api, contextlib.suppress(httpx.HTTPError):
                begin(api)
        time.sleep(dice.uniform(0.0, 4.0))  # no condition: a random moment
        server.stop(how)
        if early or how == signal.SIGKILL:  # nobody waits for its children
            wait_until(lambda server=server: not server.descendants())
        assert not server.descendants(), (number, how)
        # Ctrl-C while Python itself starts, before the first line of a program, has a traceback
        assert early or "Traceback" not in server.log(), server.log()


INTERRUPTED_IMPORT = """
import os, signal, weakref

class Module:
    pass

def interrupted(_):
    os.kill(os.getpid(), signal.SIGINT)

module = Module()
kept = weakref.ref(module, interrupted)
del module  # the callback runs, and Python only prints what it raises
raise ImportError("the import goes on")
"""


@pytest.mark.parametrize("ignored", [False, True])
@pytest.mark.parametrize("module", [FAKE_SERVER, "galewood_server.cli.main"])
def test_an_interrupt_during_the_imports_ends_the_server(tmp_path: Path, module: str, ignored: bool) -> None:
    """In a callback, as the locks of modules have one; and in the background of a script, whose shell ignores
    interrupts. In both cases it was lost, and the server started."""
    (tmp_path / "uvicorn.py").write_text(INTERRUPTED_IMPORT)
    (tmp_path / "data").mkdir()
    server = Server(tmp_path / "data", module, {"PYTHONPATH": str(tmp_path)})
    own = signal.signal(signal.SIGINT, signal.SIG_IGN if ignored else signal.default_int_handler)
    try:
        server.launch("serve")  # it inherits what is ignored
    finally:
        signal.signal(signal.SIGINT, own)
    assert server.process
    assert server.process.wait(120) == -signal.SIGINT, server.log()
    assert "Traceback" not in server.log(), server.log()

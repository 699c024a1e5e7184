"""What stands still or is damaged: unread downloads, frozen jobs, a locked database, torn files."""

from __future__ import annotations

import hashlib
import socket
import sqlite3
from collections.abc import Callable
from contextlib import closing
from datetime import UTC, datetime

import psutil
import pytest
from galewood_server.jobs import supervisor
from galewood_server.jobs.supervisor import JobStalledError, StallWatch
from galewood_server.storage import Stores

from tests.server.support.server_process import NO_CLUSTER, Server, wait_until

Start = Callable[..., Server]
CLIENTS, BYTES = 40, 8_000_000


def test_downloads_that_nobody_reads_are_closed(start_server: Start) -> None:
    server = start_server(GALEWOOD_WRITE_STALL_S="3", **NO_CLUSTER)
    mesh = Stores(server.data_dir, "").meshes.put(b"x" * BYTES)
    assert server.process is not None
    process = psutil.Process(server.process.pid)
    before = process.num_fds()
    request = f"GET /api/meshes/{mesh} HTTP/1.1\r\nHost: localhost\r\n\r\n".encode()
    clients = [_client(server.port) for _ in range(CLIENTS)]
    for client in clients:
        client.sendall(request)
    wait_until(lambda: process.num_fds() > before + 3)
    wait_until(lambda: process.num_fds() <= before + 3)
    for client in clients:
        assert _received(client) < BYTES
        client.close()
    with server.client() as api:  # one that reads gets all of it
        assert len(api.get(f"/api/meshes/{mesh}").content) == BYTES


def _client(port: int) -> socket.socket:
    client = socket.socket()
    client.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    client.connect(("127.0.0.1", port))
    return client


def _received(client: socket.socket) -> int:
    """Bytes of a response that arrived before the connection was aborted."""
    total = 0
    try:
        while part := client.recv(1 << 16):
            total += len(part)
    except ConnectionResetError:
        pass
    return total


def test_a_frozen_job_is_stopped_and_tried_again(start_server: Start) -> None:
    environment = {"GALEWOOD_JOB_STALL_S": "10", "GALEWOOD_JOB_ATTEMPTS": "20", "FAKE_STEP_S": "0.01"}
    server = start_server(**environment, **NO_CLUSTER)
    with server.client() as api:
        tree = api.post("/api/trees", files={"file": ("freeze.obj", b"a tree")}).json()
        job = api.post("/api/jobs", json={"tree_id": tree["id"]}).json()

        def state() -> dict[str, object]:
            return api.get(f"/api/jobs/{job['id']}").json()

        wait_until(lambda: state()["state"] == "done", 240)
    assert (server.data_dir / "cache" / "frozen-freeze.obj").exists()


def test_the_watch_starts_again_with_every_report(monkeypatch: pytest.MonkeyPatch) -> None:
    now_s = 0.0
    monkeypatch.setattr(supervisor.time, "monotonic", lambda: now_s)
    watch = StallWatch(60.0)
    reports = [datetime(2026, 1, 1, 0, minute, tzinfo=UTC) for minute in range(3)]
    for report in reports:
        for _ in range(6):
            watch.check(report)
            now_s += 10.0
    with pytest.raises(JobStalledError, match="1 minutes"):
        for _ in range(3):
            watch.check(reports[-1])
            now_s += 10.0


def test_a_locked_database_is_not_ready(start_server: Start) -> None:
    server = start_server(**NO_CLUSTER)
    database = server.data_dir / "galewood.sqlite"
    if not database.exists():
        pytest.skip("the server uses PostgreSQL")
    with server.client() as api, closing(sqlite3.connect(database, isolation_level=None)) as other:
        assert api.get("/api/health/ready").json()["checks"]["database"] is True
        other.execute("BEGIN IMMEDIATE")
        locked = api.get("/api/health/ready")
        other.execute("ROLLBACK")
        assert (locked.status_code, locked.json()["checks"]["database"]) == (503, False)
        assert api.get("/api/health/ready").json()["checks"]["database"] is True


def test_a_damaged_file_is_never_served(start_server: Start) -> None:
    server = start_server(**NO_CLUSTER)
    with server.client() as api:
        tree = api.post("/api/trees", files={"file": ("oak.obj", b"an oak of some size")}).json()
        path = f"/api/meshes/{tree['mesh_sha256']}"
        assert api.get(path).status_code == 200
        [stored] = server.data_dir.rglob(tree["mesh_sha256"])
        stored.write_bytes(stored.read_bytes()[:-3])
        torn = api.get(path)
        assert torn.status_code == 500
        assert torn.json()["code"] == "damaged-mesh"
        assert "immutable" not in torn.headers.get("cache-control", "")


def test_a_damaged_file_is_a_problem_of_every_route_and_a_build_replaces_it(start_server: Start) -> None:
    server = start_server(**NO_CLUSTER)
    with server.client() as api:
        tree = api.post("/api/trees?build=true", files={"file": ("ash.obj", b"an ash")}).json()
        path = f"/api/trees/{tree['id']}"
        wait_until(lambda: api.get(f"/api/jobs/{tree['job_id']}").json()["state"] == "done")
        built = api.get(path).json()
        table = f"/api/tables/{built['table_sha256']}"
        whole = api.get(table).content
        for name in (built["table_sha256"], hashlib.sha256(b"an ash").hexdigest()):
            [stored] = [one for one in server.data_dir.glob(f"*/*/{name}") if "cache" not in str(one)]
            stored.write_bytes(b"\0" * 40)
        for address in (table, f"{table}/metadata", f"{path}/exports/vat"):
            answer = api.get(address)
            assert (answer.status_code, answer.json()["code"]) == (500, "damaged-table"), address
            assert "Compute the tree again" in answer.json()["hint"]
        for answer in (api.post(f"{path}/pieces"), api.post(f"{path}/copies", json={"name": "copy"})):
            assert (answer.status_code, answer.json()["code"]) == (500, "damaged-uploaded-file")
            assert "Upload it again" in answer.json()["hint"]
        again = api.post("/api/trees", files={"file": ("ash.obj", b"an ash")})
        assert again.status_code == 200  # the same tree, whose file is whole again
        assert api.post(f"{path}/copies", json={"name": "copy", "height_m": 3}).status_code == 201
        job = api.post("/api/jobs", json={"tree_id": tree["id"]})
        assert job.status_code == 202  # not "it exists already"
        wait_until(lambda: api.get(f"/api/jobs/{job.json()['id']}").json()["state"] == "done")
        assert api.get(table).content == whole

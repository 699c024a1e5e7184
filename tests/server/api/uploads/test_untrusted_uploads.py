"""Malicious and malformed uploads to a real server with sandboxed mesh import."""

from __future__ import annotations

import os
import socket
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor

import httpx
import psutil
import pytest

from tests.server.api.test_rest_api import assert_problem
from tests.server.support.sample_meshes import pole_obj
from tests.server.support.server_process import NO_CLUSTER, Server, wait_until
from tests.server.support.untrusted_meshes import Case, cases

MEGABYTE = 1_000_000
LIMIT_BYTES = 40 * MEGABYTE


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    folder = tmp_path_factory.mktemp("hostile")
    for name in ("data", "tmp"):
        (folder / name).mkdir()
    environment = {
        **NO_CLUSTER,
        "GALEWOOD_UPLOAD_BYTES": str(LIMIT_BYTES),
        "GALEWOOD_BODY_STALL_S": "1.5",
        "GALEWOOD_HEADER_S": "1.5",
        "GALEWOOD_STORED_BYTES": str(100 * MEGABYTE),
        "TMPDIR": str(folder / "tmp"),
    }
    server = Server(folder / "data", "galewood_server.cli.main", environment).start("serve")
    yield server
    server.stop()


@pytest.fixture
def api(server: Server) -> Iterator[httpx.Client]:
    with server.client() as client:
        yield client


def kept(server: Server) -> set[str]:
    """All files in the stores and the temporary folder."""
    roots = [server.data_dir / name for name in ("sources", "meshes", "tables")] + [
        server.data_dir.parent / "tmp"
    ]
    return {str(path) for root in roots for path in root.rglob("*") if path.is_file()}


def send(server: Server, case: Case) -> httpx.Response:
    with server.client() as api:
        return api.post("/api/trees", files={"file": (case.filename, case.data)})


def test_untrusted_uploads_are_answered_and_rejected_ones_leave_no_file(
    server: Server, api: httpx.Client
) -> None:
    api.post("/api/trees", files={"file": ("warm.obj", pole_obj(3.0))})
    before, files = _resources(server), kept(server)
    tried = cases()
    with ThreadPoolExecutor(2) as pool:
        answers = list(pool.map(lambda case: send(server, case), tried))
    wrong = [f"{case.name}: {_judge(case, answer)}" for case, answer in zip(tried, answers, strict=True)]
    assert not [line for line in wrong if not line.endswith(": ")]
    accepted = [answer.json() for answer in answers if answer.status_code == 201]
    trees = api.get("/api/trees").json()["trees"]
    assert len(trees) == len(accepted) + 1
    # stores are content-addressed: one of two trees in a file gives the same mesh as that tree alone
    meshes = {tree["mesh_sha256"] for tree in accepted}
    assert len(kept(server) - files) == len(accepted) + 2 * len(meshes)  # with a first table for each
    assert not [name for name in kept(server) if "cron" in name or "passwd" in name]
    after = wait_until(lambda: _settled(server, before))
    assert after["bytes"] - before["bytes"] < 150 * MEGABYTE


def _judge(case: Case, answer: httpx.Response) -> str:
    if case.status and answer.status_code != case.status:
        return f"{answer.status_code} in place of {case.status}: {answer.text[:200]}"
    if answer.status_code == 201:
        tree = answer.json()
        return "" if tree["report"] and "/" not in tree["name"] else f"odd: {tree}"
    problem = assert_problem(answer, answer.status_code, answer.json()["code"])
    if answer.status_code not in (400, 413, 415, 422) or not problem["hint"]:
        return f"unhelpful: {answer.text[:200]}"
    if case.codes and problem["code"] not in case.codes:
        return f"code {problem['code']}"
    return (
        "tells a path" if any(word in answer.text for word in ("Traceback", "/tmp", "site-packages")) else ""
    )


def _resources(server: Server) -> dict[str, int]:
    assert server.process
    process = psutil.Process(server.process.pid)
    children = [child for child in process.children(recursive=True) if child.is_running()]
    return {"bytes": process.memory_info().rss, "handles": process.num_fds(), "children": len(children)}


def _settled(server: Server, before: dict[str, int]) -> dict[str, int] | None:
    now = _resources(server)
    calm = now["children"] <= before["children"] and now["handles"] <= before["handles"] + 8
    return now if calm else None


def test_an_assumed_unit_is_reported_and_can_be_corrected(server: Server, api: httpx.Client) -> None:
    case = next(case for case in cases() if case.name == "millimetres")
    tree = send(server, case).json()
    assert tree["height_m"] == pytest.approx(4.12, rel=0.01)
    changed = api.patch(f"/api/trees/{tree['id']}", json={"height_m": 9.0, "name": "Mine"})
    assert changed.status_code == 200, changed.text
    assert (changed.json()["height_m"], changed.json()["name"]) == (pytest.approx(9.0), "Mine")
    assert changed.json()["mesh_sha256"] != tree["mesh_sha256"]
    assert api.get(f"/api/meshes/{tree['mesh_sha256']}").status_code == 404
    refused = api.patch(f"/api/trees/{tree['id']}", json={"up_axis": "x", "wood_parts": ["no such"]})
    assert refused.status_code == 422 and refused.json()["hint"]
    assert api.get(f"/api/trees/{tree['id']}").json() == changed.json()


def test_an_oversized_upload_is_aborted(server: Server, api: httpx.Client) -> None:
    files, before = kept(server), _resources(server)

    def body() -> Iterator[bytes]:
        yield b'--x\r\ncontent-disposition: form-data; name="file"; filename="a.obj"\r\n\r\n'
        for _ in range(200):
            yield bytes(MEGABYTE)
        yield b"\r\n--x--\r\n"

    headers = {"content-type": "multipart/form-data; boundary=x"}
    try:
        answer = api.post("/api/trees", content=body(), headers=headers)
        assert answer.status_code == 413 and answer.json()["code"] == "upload-too-large"
    except httpx.TransportError:
        pass  # the server closed the connection
    after = wait_until(lambda: _settled(server, before))
    assert after["bytes"] - before["bytes"] < 100 * MEGABYTE
    assert kept(server) == files


def test_an_oversized_content_length_is_rejected(server: Server) -> None:
    with socket.create_connection(("127.0.0.1", server.port), 10) as raw:
        raw.sendall(
            b"POST /api/trees HTTP/1.1\r\nHost: localhost\r\nContent-Length: 200000000\r\n"
            b"Content-Type: multipart/form-data; boundary=x\r\n\r\n--x"
        )
        assert raw.recv(64).startswith((b"HTTP/1.1 413", b"HTTP/1.1 507"))


def test_unfinished_request_headers_time_out(server: Server) -> None:
    with socket.create_connection(("127.0.0.1", server.port), 10) as raw:
        raw.sendall(b"POST /api/trees HTTP/1.1\r\nHost: localhost\r\n")
        assert _drip(raw, b"X-A: b\r\n") == b""


def test_an_unfinished_body_is_answered_with_408(server: Server) -> None:
    with socket.create_connection(("127.0.0.1", server.port), 10) as raw:
        raw.sendall(
            b"POST /api/trees HTTP/1.1\r\nHost: localhost\r\nContent-Length: 1000\r\n"
            b"Content-Type: multipart/form-data; boundary=x\r\n\r\n--x\r\n"
        )
        raw.settimeout(8)
        assert raw.recv(64).startswith(b"HTTP/1.1 408")


def _drip(raw: socket.socket, piece: bytes) -> bytes:
    """Send a few bytes at a time until the server closes the connection."""
    raw.settimeout(0.3)
    for _ in range(40):
        try:
            raw.sendall(piece)
            return raw.recv(64)
        except TimeoutError:
            continue
        except OSError:
            return b""
    raise AssertionError("still listened to")


def test_slow_clients_do_not_block_others(server: Server, api: httpx.Client) -> None:
    slow = [socket.create_connection(("127.0.0.1", server.port), 10) for _ in range(40)]
    try:
        for raw in slow:
            raw.sendall(b"GET / HTTP/1.1\r\nHost: localhost\r\n")
        assert api.get("/api/health").status_code == 200
        assert api.post("/api/trees", files={"file": ("next.obj", pole_obj(5.0))}).status_code in (200, 201)
    finally:
        for raw in slow:
            raw.close()


def test_uploads_beyond_the_quota_are_rejected(server: Server, api: httpx.Client) -> None:
    filler = server.data_dir / "cache" / "filler"
    filler.parent.mkdir(exist_ok=True)
    filler.write_bytes(os.urandom(100 * MEGABYTE))
    wait_until(lambda: time.monotonic() and _full(api), 15, 0.5)
    files = kept(server)
    answer = api.post("/api/trees", files={"file": ("late.obj", pole_obj(6.0))})
    assert (answer.status_code, answer.json()["code"]) == (507, "quota-reached")
    assert kept(server) == files
    filler.unlink()


def _full(api: httpx.Client) -> bool:
    text = api.get("/metrics").text
    line = next(line for line in text.splitlines() if line.startswith("galewood_stored_bytes "))
    return float(line.split()[1]) > 100 * MEGABYTE

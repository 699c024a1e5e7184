"""A graceful stop while requests are open."""

from __future__ import annotations

import json
import signal
import socket
from collections.abc import Callable

from galewood_server.storage import Stores

from tests.server.conftest import NO_CLUSTER, Server, wait_until

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
    assert server.log().count("was broken off") >= 2
    for one in (upload, *others):
        one.close()

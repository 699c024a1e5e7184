"""Names under which a server without API keys answers: DNS rebinding gives another site's page no access."""

from __future__ import annotations

import http.client
import socket
from typing import Any

import anyio
import pytest
from galewood_server.access.middleware import AccessControl
from galewood_server.ops.metrics import Metrics
from galewood_server.settings import Settings
from starlette.types import Message, Receive, Scope, Send

from tests.server.access.test_access_control import FAR, application, ask, code_of
from tests.server.support.server_process import Server

PATHS = (
    "/", "/index.html", "/docs", "/openapi.json", "/metrics", "/healthz", "/api/health", "/api/trees",
)  # fmt: skip
UPGRADE = (
    "Upgrade: websocket\r\nConnection: Upgrade\r\n"
    "Sec-WebSocket-Key: Z2FsZXdvb2QtYmVuY2gtMQ==\r\nSec-WebSocket-Version: 13\r\n"
)


def status(server: Server, request: str) -> int:
    """The status of the response to raw bytes."""
    with socket.create_connection(("127.0.0.1", server.port), timeout=20) as link:
        link.sendall(request.encode("latin-1"))
        response = http.client.HTTPResponse(link)
        response.begin()
        return response.status


@pytest.mark.parametrize("path", PATHS)
def test_a_rebound_name_reads_nothing(server: Server, path: str) -> None:
    for name in ("evil.example", f"evil.example:{server.port}"):
        request = f"GET {path} HTTP/1.1\r\nHost: {name}\r\nOrigin: http://{name}\r\n\r\n"
        assert status(server, request) == 421
    assert status(server, f"GET {path} HTTP/1.1\r\nHost: LOCALHOST.:{server.port}\r\n\r\n") != 421


def test_a_rebound_name_opens_no_socket(server: Server) -> None:
    def handshake(name: str) -> int:
        return status(
            server, f"GET /ws/forest HTTP/1.1\r\nHost: {name}\r\nOrigin: http://{name}\r\n{UPGRADE}\r\n"
        )

    assert handshake(f"evil.example:{server.port}") == 421
    assert handshake(f"localhost:{server.port}") == 101
    assert handshake(f"[::1]:{server.port}") == 101


def test_no_form_of_a_request_gets_around_the_name(server: Server) -> None:
    forms = (
        "GET http://evil.example/api/trees HTTP/1.1\r\nHost: evil.example\r\n\r\n",
        "GET http://evil.example/api/trees HTTP/1.1\r\nHost: localhost\r\n\r\n",
        "GET http://localhost/api/trees HTTP/1.1\r\nHost: evil.example\r\n\r\n",
        "GET /api/trees HTTP/1.1\r\nHost: localhost\r\nHost: evil.example\r\n\r\n",
        "GET /api/trees HTTP/1.1\r\nHost: localhost, evil.example\r\n\r\n",
        "GET /api/trees HTTP/1.1\r\nHost: localhost@evil.example\r\n\r\n",
        "GET /api/trees HTTP/1.1\r\nHost: evil.example\r\nX-Forwarded-Host: localhost\r\n\r\n",
        "GET /api/trees HTTP/1.1\r\nHost:\r\n\r\n",
        "GET /api/trees HTTP/1.1\r\n\r\n",
        "GET /api/trees HTTP/1.0\r\nHost: evil.example\r\n\r\n",
    )
    assert not {status(server, form) for form in forms} - {400, 404, 421}
    # no browser sends HTTP/1.0 without a name, but monitoring does
    assert status(server, "GET /api/health HTTP/1.0\r\n\r\n") == 200


@pytest.mark.parametrize(
    "host",
    [
        "localhost", "LocalHost:8000", "localhost.:8000", "localhost:", "forest.localhost", "127.0.0.1",
        "127.3.2.1:1", "[::1]:8000", "192.168.1.7:8000", "203.0.113.4", "[2001:db8::7]", "0.0.0.0:8000",
    ],
)  # fmt: skip
def test_addresses_and_loopback_names_are_answered(host: str) -> None:
    assert ask(application(), "GET", "/api/thing", client=FAR, headers={"Host": host}).status_code == 200


@pytest.mark.parametrize(
    "host",
    [
        "evil.example", "localhost.evil.example", "127.0.0.1.evil.example", "evillocalhost", "localhost:80:1",
        "localhost/evil", "user@localhost", "[::1", "::1", "[::1].evil.example", "localhost..", ".", "",
        "2130706433", "127.1", "0x7f.0.0.1", "[evil.example]", "localhost\\evil",
    ],
)  # fmt: skip
def test_other_names_are_refused_by_a_problem_that_names_the_setting(host: str) -> None:
    answer = ask(application(), "GET", "/api/thing", headers={"Host": host})
    assert code_of(answer) == (421, "unknown-host")
    assert "GALEWOOD_ALLOWED_ORIGINS" in answer.json()["hint"]


def test_configured_names_are_answered() -> None:
    app = application(
        host="forest.lan", peer_url="http://peer-a:8000", allowed_origins=["https://trees.example", "*"]
    )
    for host in ("forest.lan:8000", "peer-a:8000", "trees.example", "Trees.Example.:443"):
        assert ask(app, "GET", "/api/thing", headers={"Host": host}).status_code == 200
    assert code_of(ask(app, "GET", "/api/thing", headers={"Host": "evil.example"})) == (421, "unknown-host")
    answer = ask(app, "POST", "/api/thing", headers={"Host": "trees.example"})
    assert code_of(answer) == (403, "local-only"), "a proxy may be behind the name"


def test_with_keys_a_server_has_any_name() -> None:
    app = application(api_keys=["0" * 64])
    assert ask(app, "GET", "/api/thing", client=FAR, headers={"Host": "trees.example"}).status_code == 200


@pytest.mark.parametrize(
    "headers", [{"host": "evil.example"}, {"host": "localhost", "origin": "http://evil.example"}]
)
def test_a_socket_of_another_site_does_not_reach_the_application(headers: dict[str, str]) -> None:
    sent: list[Message] = []

    async def send(message: Message) -> None:
        sent.append(message)

    async def receive() -> Message:
        return {"type": "websocket.connect"}

    async def inner(_scope: Scope, _receive: Receive, _send: Send) -> None:
        raise AssertionError("reached")

    raw: Any = [(name.encode(), value.encode()) for name, value in headers.items()]
    scope = {"type": "websocket", "path": "/ws/forest", "client": FAR, "headers": raw}
    anyio.run(AccessControl(inner, Settings(), Metrics("test")), scope, receive, send)
    assert sent[0]["type"] == "websocket.http.response.start"
    assert sent[0]["status"] == (421 if headers["host"] == "evil.example" else 403)

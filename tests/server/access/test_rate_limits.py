"""Limits per address of reads, writes, wrong keys, health checks and sockets, and whose address counts."""

from __future__ import annotations

from typing import Any

import anyio
import pytest
from galewood_server.access.keys import new_key
from galewood_server.access.middleware import AccessControl
from galewood_server.access.rates import rate_limit_key
from galewood_server.ops.metrics import Metrics
from galewood_server.settings import Settings
from starlette.types import Message, Receive, Scope, Send
from uvicorn.middleware.proxy_headers import ProxyHeadersMiddleware

from tests.server.access.test_access_control import FAR, LOCAL, application, ask, code_of


def test_guessing_keys_is_rate_limited_but_the_right_key_is_never_refused() -> None:
    """Several clients may share an address (NAT)."""
    key, sha256 = new_key()
    app = application(api_keys=[sha256])
    wrong, right = {"Authorization": "Bearer wrong"}, {"Authorization": f"Bearer {key}"}
    statuses = [ask(app, "POST", "/api/thing", client=FAR, headers=wrong).status_code for _ in range(25)]
    assert set(statuses) == {401, 429} and statuses == sorted(statuses)
    for client in (FAR, LOCAL):
        assert ask(app, "POST", "/api/thing", client=client, headers=right).status_code == 200


@pytest.mark.parametrize(("method", "setting"), [("GET", "reads_per_minute"), ("POST", "writes_per_minute")])
def test_requests_are_rate_limited_per_address(method: str, setting: str) -> None:
    app = application(**{setting: 5})
    answers = [ask(app, method, "/api/thing") for _ in range(8)]
    assert [answer.status_code for answer in answers] == [200] * 5 + [429] * 3
    assert code_of(answers[-1]) == (429, "too-many-requests")
    assert 1 <= int(answers[-1].headers["retry-after"]) <= 60
    assert ask(app, method, "/api/thing", client=("127.0.0.2", 5)).status_code == 200
    assert b'galewood_refused_total{reason="too-many-requests"} 3.0' in app.state.metrics.text()


def test_an_ipv6_network_shares_one_rate_limit() -> None:
    assert rate_limit_key("2001:db8:1:2::1") == rate_limit_key("2001:db8:1:2:ffff::9")
    assert rate_limit_key("2001:db8:1:2::1") != rate_limit_key("2001:db8:1:3::1")
    assert rate_limit_key("192.0.2.1") != rate_limit_key("192.0.2.2")


@pytest.mark.parametrize("port", ["", ":80"])
def test_addresses_with_ports_and_mapped_ones_are_the_same(port: str) -> None:
    mapped = f"[::ffff:192.0.2.1]{port}" if port else "::ffff:192.0.2.1"
    assert rate_limit_key(f"192.0.2.1{port}") == rate_limit_key(mapped) == "192.0.2.1"
    assert rate_limit_key(f"[2001:db8::1]{port}") == rate_limit_key("2001:db8::2")
    assert rate_limit_key("fe80::1%a") == rate_limit_key("fe80::1%b")


def test_proxies_are_trusted_only_where_they_are_named() -> None:
    """Otherwise each local process, or a page in a local browser, is a new client whenever it likes."""
    assert not Settings().trusted_proxies
    for wrong in ("proxy.example", "127.0.0.1/33", "127.0.0.1;127.0.0.2", "1.2.3.4/8"):
        with pytest.raises(ValueError, match="addresses or networks"):
            Settings(trusted_proxies=wrong)
    assert Settings(trusted_proxies="127.0.0.1, 10.0.0.0/8,2001:db8::/32").trusted_proxies
    assert Settings(trusted_proxies="*").trusted_proxies == "*"


def test_junk_instead_of_an_address_has_one_limit() -> None:
    inner: Any = application(reads_per_minute=3)
    app = ProxyHeadersMiddleware(inner, trusted_hosts="127.0.0.1")
    junk = ("a", "b, c", "1.2.3", "<script>", "unknown", "1.2.3.4.5", "x" * 500)
    answers = [ask(app, "GET", "/api/thing", headers={"X-Forwarded-For": one}) for one in junk]
    assert [answer.status_code for answer in answers] == [200] * 3 + [429] * 4


@pytest.mark.parametrize("path", ["/", "/index.html", "/api/thing", "/metrics", "/docs"])
@pytest.mark.parametrize("method", ["GET", "INVENTED"])
def test_every_path_has_a_rate_limit(path: str, method: str) -> None:
    app = application(reads_per_minute=3)
    # two windows, because a new one may begin in between
    refused = [ask(app, method, path).status_code == 429 for _ in range(8)]
    assert not any(refused[:3])
    assert any(refused)
    assert ask(app, "GET", path, client=FAR).status_code != 429


@pytest.mark.parametrize("path", ["/api/health", "/api/health/ready", "/healthz"])
def test_health_checks_have_a_generous_limit_of_their_own(path: str, monkeypatch: pytest.MonkeyPatch) -> None:
    app = application(reads_per_minute=1)
    ask(app, "GET", "/api/thing")
    every_second = [ask(app, "GET", path).status_code for _ in range(60)]
    assert set(every_second) == {404}, "checks do not count as reads"
    monkeypatch.setattr("galewood_server.access.rates.HEALTH_CHECKS_PER_MINUTE", 5)
    app = application()
    assert code_of([ask(app, "GET", path) for _ in range(12)][-1]) == (429, "too-many-requests")
    assert ask(app, "GET", path, client=FAR).status_code == 404
    assert ask(app, "GET", "/api/thing").status_code == 200


def test_only_the_health_checks_are_exempt_from_the_limit_of_reads() -> None:
    app = application(reads_per_minute=1)
    answers = [ask(app, "GET", path).status_code for path in ("/api/healthy", "/healthz/x", "/api/health/")]
    assert 429 in answers


def test_opening_sockets_has_a_rate_limit() -> None:
    sent: list[Message] = []

    async def send(message: Message) -> None:
        sent.append(message)

    async def receive() -> Message:
        return {"type": "websocket.connect"}

    async def inner(_scope: Scope, _receive: Receive, send: Send) -> None:
        await send({"type": "websocket.accept"})

    async def open_twice() -> None:
        guard = AccessControl(inner, Settings(reads_per_minute=1), Metrics("test"))
        for _ in range(2):
            scope = {"type": "websocket", "path": "/ws/forest", "client": FAR, "headers": []}
            await guard(scope, receive, send)

    anyio.run(open_twice)
    assert sent[0]["type"] == "websocket.accept"
    assert (sent[1]["type"], sent[1]["status"]) == ("websocket.http.response.start", 429)

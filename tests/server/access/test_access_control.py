"""Access control: API keys, local clients, rate limits and headers, on an application without a server."""

from __future__ import annotations

import errno
import re
import sqlite3
from collections.abc import AsyncIterator
from contextlib import closing
from pathlib import Path
from typing import Any

import anyio
import httpx
import pytest
from fastapi import FastAPI, Request
from galewood_server.access.keys import check_writer, new_key
from galewood_server.access.middleware import AccessControl
from galewood_server.app.headers import SecurityHeaders
from galewood_server.http.errors import ProblemError, install_error_handlers
from galewood_server.http.multipart import FORM_OVERHEAD_BYTES
from galewood_server.ops.metrics import Metrics
from galewood_server.ops.tracing import Tracing
from galewood_server.settings import Settings
from galewood_server.storage import Tree, migrate, open_database
from pydantic import AliasChoices
from sqlalchemy import delete, text
from sqlalchemy.exc import OperationalError
from sqlalchemy.exc import TimeoutError as PoolTimeoutError

LOCAL, FAR = ("127.0.0.1", 5), ("203.0.113.9", 5)


def application(**given: Any) -> FastAPI:
    settings, counted = Settings(**given), Metrics("test")
    app = FastAPI()
    install_error_handlers(app)

    @app.get("/api/thing")
    @app.post("/api/thing")
    @app.post("/api/winds/validate")
    async def thing(request: Request) -> dict[str, int]:
        return {"bytes": len(await request.body())}

    @app.get("/api/broken")
    async def broken() -> None:
        raise ZeroDivisionError("a secret of the server")

    app.add_middleware(AccessControl, settings=settings, metrics=counted)
    app.add_middleware(SecurityHeaders)
    app.add_middleware(Tracing, metrics=counted)
    app.state.metrics = counted
    return app


def ask(
    app: Any,
    method: str,
    path: str,
    *,
    client: tuple[str, int] = LOCAL,
    host: str = "localhost",
    **given: Any,
) -> httpx.Response:
    async def send() -> httpx.Response:
        transport = httpx.ASGITransport(app, client=client, raise_app_exceptions=False)
        async with httpx.AsyncClient(transport=transport, base_url=f"http://{host}:8000") as http:
            return await http.request(method, path, **given)

    return anyio.run(send)


def code_of(answer: httpx.Response) -> tuple[int, str]:
    assert answer.headers["content-type"] == "application/problem+json"
    return answer.status_code, answer.json()["code"]


@pytest.mark.parametrize("client", [LOCAL, ("::1", 5), ("::ffff:127.0.0.1", 5), ("127.8.8.8", 1)])
@pytest.mark.parametrize("host", ["localhost", "127.0.0.1", "[::1]", "galewood.localhost"])
def test_without_keys_local_clients_have_write_access(client: tuple[str, int], host: str) -> None:
    assert ask(application(), "POST", "/api/thing", client=client, host=host).status_code == 200


def test_without_keys_remote_clients_are_read_only() -> None:
    app = application()
    assert ask(app, "GET", "/api/thing", client=FAR).status_code == 200
    assert ask(app, "POST", "/api/winds/validate", client=FAR).status_code == 200
    for client in (FAR, ("2001:db8::1", 5), ("testclient", 1)):
        assert code_of(ask(app, "POST", "/api/thing", client=client)) == (403, "local-only")


@pytest.mark.parametrize(
    "name", ["X-Forwarded-For", "X-Forwarded-Proto", "Forwarded", "Via", "X-Real-IP", "CF-Connecting-IP"]
)
def test_forwarded_requests_are_not_local(name: str) -> None:
    answer = ask(application(), "POST", "/api/thing", headers={name: "127.0.0.1"})
    assert code_of(answer) == (403, "local-only")


def test_a_proxy_that_rewrites_the_host_is_not_local() -> None:
    """nginx with only `proxy_pass http://localhost:8000`: HTTP/1.0, Host rewritten, no header added."""
    scope = {
        "type": "http", "method": "POST", "path": "/api/thing", "client": LOCAL, "http_version": "1.0",
        "headers": [(b"host", b"localhost:8000"), (b"connection", b"close")],
    }  # fmt: skip
    with pytest.raises(ProblemError) as refused:
        check_writer(scope, Settings())
    assert refused.value.problem.code == "local-only"
    check_writer({**scope, "http_version": "1.1"}, Settings())


def test_local_writes_can_be_switched_off() -> None:
    assert code_of(ask(application(local_writes=False), "POST", "/api/thing")) == (403, "local-only")


@pytest.mark.parametrize("host", ["evil.example", "127.0.0.1.evil.example", "localhost.evil.example"])
def test_dns_rebinding_has_no_write_access(host: str) -> None:
    """DNS rebinding: the page's origin and the host agree, and the connection is local."""
    headers = {"Origin": f"http://{host}:8000"}
    for given in ({}, {"allowed_origins": [f"http://{host}:8000"]}):
        answer = ask(application(**given), "POST", "/api/thing", host=host, headers=headers)
        assert code_of(answer) == ((403, "local-only") if given else (421, "unknown-host"))


def test_foreign_origins_have_no_write_access() -> None:
    headers = {"Origin": "http://evil.example"}
    assert code_of(ask(application(), "POST", "/api/thing", headers=headers)) == (403, "foreign-origin")
    friendly = application(allowed_origins=["http://evil.example"])
    assert ask(friendly, "POST", "/api/thing", headers=headers).status_code == 200


def test_with_keys_write_access_requires_a_key() -> None:
    (key, sha256), (other, _) = new_key(), new_key()
    app = application(api_keys=[sha256, "0" * 64])
    bearer = {"Authorization": f"Bearer {key}"}
    assert ask(app, "POST", "/api/thing", client=FAR, headers=bearer).status_code == 200
    for headers in ({}, {"Authorization": f"Bearer {other}"}, {"Authorization": f"Basic {key}"},
                    {"Authorization": f"Bearer {sha256}"}):  # fmt: skip
        answer = ask(app, "POST", "/api/thing", headers=headers)
        assert code_of(answer) == (401, "key-needed") and "Bearer" in answer.headers["www-authenticate"]


def test_keys_in_the_environment_must_be_hashes(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GALEWOOD_API_KEYS", f"{'A' * 64}, {'b' * 64},")
    assert Settings().api_keys == ["a" * 64, "b" * 64]
    monkeypatch.setenv("GALEWOOD_API_KEYS", "swordfish")
    with pytest.raises(ValueError, match="SHA-256"):
        Settings()


class PostgresqlError(Exception):
    """An error as psycopg raises it; without a state, there was no connection."""

    def __init__(self, sqlstate: str | None) -> None:
        super().__init__(f"state {sqlstate}")
        self.sqlstate = sqlstate


def sqlite_full() -> Exception:
    """The error of a database that may not grow."""
    with sqlite3.connect(":memory:") as connection:
        connection.execute("PRAGMA max_page_count = 2")
        connection.execute("CREATE TABLE a (b)")
        try:
            connection.execute("INSERT INTO a VALUES (zeroblob(100000))")
        except sqlite3.OperationalError as error:
            return error
    raise AssertionError("the database grew")


@pytest.mark.parametrize(
    ("error", "status", "code"),
    [
        (OSError(errno.ENOSPC, "No space left on device"), 507, "disk-full"),
        (OSError(errno.EDQUOT, "Disk quota exceeded"), 507, "disk-full"),
        (OSError(errno.EACCES, "Permission denied"), 500, "internal-error"),
        (OperationalError("UPDATE", {}, PostgresqlError("53100")), 507, "disk-full"),
        (OperationalError("UPDATE", {}, sqlite_full()), 507, "disk-full"),
        (OperationalError("UPDATE", {}, sqlite3.OperationalError("no such column")), 500, "internal-error"),
        (OperationalError("UPDATE", {}, PostgresqlError("55P03")), 503, "database-busy"),
        (OperationalError("UPDATE", {}, PostgresqlError("40001")), 503, "database-busy"),
        (OperationalError("UPDATE", {}, PostgresqlError("57P01")), 503, "database-busy"),
        (OperationalError("UPDATE", {}, PostgresqlError("08006")), 503, "database-busy"),
        (OperationalError("UPDATE", {}, PostgresqlError(None)), 503, "database-busy"),
        (OperationalError("UPDATE", {}, PostgresqlError("42703")), 500, "internal-error"),
        (PoolTimeoutError("all connections are in use"), 503, "database-busy"),
    ],
)
def test_failures_of_disk_and_database_have_a_problem(error: Exception, status: int, code: str) -> None:
    app = application()

    @app.patch("/api/full")
    def full() -> None:
        raise error

    answer = ask(app, "PATCH", "/api/full")
    assert code_of(answer) == (status, code)
    assert ("retry-after" in answer.headers) is (status == 503)


def test_a_locked_database_is_503_and_logs_no_traceback(
    tmp_path: Path, caplog: pytest.LogCaptureFixture
) -> None:
    """Another program, such as a backup, may hold SQLite's lock for longer than a request waits."""
    url, app = f"sqlite:///{tmp_path / 'locked.sqlite'}", application()
    migrate(url)
    sessions = open_database(url)

    @app.patch("/api/locked")
    def write() -> None:
        with sessions.begin() as session:
            session.execute(text("PRAGMA busy_timeout = 0"))
            session.execute(delete(Tree))

    with closing(sqlite3.connect(tmp_path / "locked.sqlite", isolation_level=None)) as other:
        other.execute("BEGIN IMMEDIATE")
        answer = ask(app, "PATCH", "/api/locked")
        assert code_of(answer) == (503, "database-busy") and int(answer.headers["retry-after"]) > 0
        other.execute("ROLLBACK")
    assert "database is locked" in caplog.text and "Traceback" not in caplog.text
    assert ask(app, "PATCH", "/api/locked").status_code == 200


@pytest.mark.parametrize("length", [True, False])
def test_a_too_large_body_is_a_problem(length: bool) -> None:
    app = application()

    @app.patch("/api/small", max_body_size=100)
    def small(body: dict[str, str]) -> dict[str, str]:
        return body

    async def pieces() -> AsyncIterator[bytes]:
        yield b"x" * 200

    answer = ask(app, "PATCH", "/api/small", content=b"x" * 200 if length else pieces())
    assert code_of(answer) == (413, "request-entity-too-large")


def test_the_proxy_lets_the_largest_upload_pass() -> None:
    caddyfile = (Path(__file__).parents[3] / "deploy" / "Caddyfile").read_text()
    ((number, unit),) = re.findall(r"max_size (\d+)(MB|MiB)\n", caddyfile)
    limit = int(number) * {"MB": 10**6, "MiB": 2**20}[unit]
    assert limit >= Settings().upload_bytes + FORM_OVERHEAD_BYTES


def test_a_stalled_body_times_out() -> None:
    app = application(body_stall_s=0.2)

    async def body() -> Any:
        yield b"a"
        await anyio.sleep(5)
        yield b"b"

    scope_answers = anyio.run(_stream, app, body)
    assert scope_answers == 408


async def _stream(app: FastAPI, body: Any) -> int:
    """Send a request body in parts; httpx's ASGI transport would read it completely first."""
    pieces, status = body(), 0
    ended = False

    async def receive() -> dict[str, Any]:
        nonlocal ended
        if ended:
            await anyio.sleep_forever()
        try:
            return {"type": "http.request", "body": await anext(pieces), "more_body": True}
        except StopAsyncIteration:
            ended = True
            return {"type": "http.request", "body": b"", "more_body": False}

    async def send(message: Any) -> None:
        nonlocal status
        status = message.get("status", status)

    scope = {
        "type": "http", "asgi": {"version": "3.0"}, "http_version": "1.1", "method": "POST", "scheme": "http",
        "path": "/api/thing", "raw_path": b"/api/thing", "query_string": b"", "root_path": "",
        "headers": [(b"host", b"localhost:8000")], "client": LOCAL,
        "server": ("localhost", 8000), "state": {},
    }  # fmt: skip
    with anyio.fail_after(4):
        await app(scope, receive, send)
    return status


def test_a_slow_body_times_out(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("galewood_server.access.middleware.GRACE_S", 0.3)
    app = application(body_bytes_per_s=1000)

    async def body() -> Any:
        for _ in range(100):
            yield b"a"
            await anyio.sleep(0.05)

    assert anyio.run(_stream, app, body) == 408


def test_responses_have_security_headers_and_a_request_id() -> None:
    app = application()
    given = ask(app, "GET", "/api/thing", headers={"X-Request-ID": "abc.123"})
    assert given.headers["x-request-id"] == "abc.123"
    made = {
        ask(app, "GET", "/api/thing", headers={"X-Request-ID": "a b\tc"}).headers["x-request-id"]
        for _ in "12"
    }
    assert len(made) == 2 and "a b\tc" not in made
    for answer in (given, ask(app, "POST", "/api/thing", client=FAR), ask(app, "GET", "/api/broken")):
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert "default-src 'none'" in answer.headers["content-security-policy"]
        assert answer.headers["x-request-id"] and answer.headers["cache-control"] == "no-store"


def test_internal_errors_hide_details_and_are_counted(caplog: pytest.LogCaptureFixture) -> None:
    app = application()
    answer = ask(app, "GET", "/api/broken")
    assert code_of(answer) == (500, "internal-error") and "secret" not in answer.text
    assert "a secret of the server" in caplog.text
    line = b'galewood_http_requests_total{method="GET",route="/api/broken",status="500"} 1.0'
    assert line in app.state.metrics.text()


def test_unknown_paths_share_one_metrics_label() -> None:
    app = application()
    for k in range(20):
        ask(app, "GET", f"/api/unknown/{k}")
    routes = [line for line in app.state.metrics.text().decode().splitlines() if "requests_total{" in line]
    assert routes == ['galewood_http_requests_total{method="GET",route="none",status="404"} 20.0']


def test_invented_methods_share_one_metrics_label() -> None:
    app = application()
    for k in range(20):
        ask(app, f"INVENTED{k}", "/api/thing")
    text = app.state.metrics.text().decode()
    assert "INVENTED" not in text
    assert 'galewood_http_requests_total{method="other",route="/api/thing",status="405"} 20.0' in text


def test_every_setting_is_documented() -> None:
    manual = (Path(__file__).parents[3] / "docs" / "operations.md").read_text()
    missing: list[str] = []
    for name, field in Settings.model_fields.items():
        alias = field.validation_alias
        choices = alias.choices if isinstance(alias, AliasChoices) else [name]
        if not any(str(choice).upper() in manual.upper() for choice in (name, *choices)):
            missing.append(name)
    assert not missing

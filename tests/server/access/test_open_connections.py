"""Ceilings of open connections and of requests in progress; logs that strangers cannot fill."""

from __future__ import annotations

import contextlib
import errno
import logging
import resource
import socket
from collections.abc import Callable, Generator

import httpx
import pytest
from galewood_server.access import OpenConnections
from galewood_server.http import problem_from
from galewood_server.ops import Throttle

from tests.server.support.server_process import Server, wait_until

Start = Callable[..., Server]
HALF_A_HEAD = b"GET / HTTP/1.1\r\nHost: localhost\r\n"
HEALTH = b"GET /api/health HTTP/1.1\r\nHost: localhost\r\n\r\n"


@contextlib.contextmanager
def links(server: Server, count: int, sent: bytes) -> Generator[list[socket.socket]]:
    """Connections on each of which the same was sent."""
    with contextlib.ExitStack() as stack:
        opened: list[socket.socket] = []
        for _ in range(count):
            link = stack.enter_context(socket.create_connection(("127.0.0.1", server.port), timeout=30))
            link.sendall(sent)
            opened.append(link)
        yield opened


def test_connections_that_send_nothing_leave_room_for_others(start_server: Start) -> None:
    server = start_server(GALEWOOD_HEADER_S="600")
    assert server.process
    resource.prlimit(server.process.pid, resource.RLIMIT_NOFILE, (256, 256))
    with links(server, 400, HALF_A_HEAD):
        assert all(httpx.get(f"{server.url}/api/health").status_code == 200 for _ in range(5))
    log = server.log()
    assert "out of system resource" not in log and "Traceback" not in log


def test_the_connection_that_has_waited_longest_makes_room(start_server: Start) -> None:
    server = start_server(GALEWOOD_CONNECTIONS="4", GALEWOOD_HEADER_S="600")
    wait_until(lambda: server.log().count("Uvicorn running"))
    with links(server, 4, HALF_A_HEAD) as waiting:
        waiting[0].sendall(b"Connection: keep-alive\r\n\r\n")  # once answered, it has waited the shortest
        assert waiting[0].recv(12).endswith(b"200")
        with links(server, 1, HEALTH) as (late,):
            assert late.recv(12).endswith(b"200")
            assert waiting[1].recv(1) == b"", "the longest waiting one is closed"
            waiting[2].sendall(b"\r\n")
            assert waiting[2].recv(12).endswith(b"200"), "the others are not"


def test_where_all_connections_are_busy_another_is_refused(start_server: Start) -> None:
    server = start_server(GALEWOOD_CONNECTIONS="3")
    events = b"GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n"
    with links(server, 3, events) as streams:
        assert all(stream.recv(12).endswith(b"200") for stream in streams)
        with links(server, 1, b"") as (refused,):
            answer = b"".join(iter(lambda: refused.recv(4096), b""))
        assert answer.startswith(b"HTTP/1.1 503 ") and b"too-many-connections" in answer
        assert b"retry-after: 5" in answer.lower()
    wait_until(lambda: _answers(server))


def _answers(server: Server) -> bool:
    with contextlib.suppress(httpx.HTTPError):
        return httpx.get(f"{server.url}/api/health").status_code == 200
    return False


def test_one_address_has_a_ceiling_of_requests_in_progress(start_server: Start) -> None:
    server = start_server(GALEWOOD_REQUESTS_PER_ADDRESS="2", GALEWOOD_TRUSTED_PROXIES="127.0.0.1")
    far, near = {"X-Forwarded-For": "10.1.1.1"}, {"X-Forwarded-For": "10.2.2.2"}
    with httpx.Client(base_url=server.url, timeout=30) as client, contextlib.ExitStack() as stack:
        for _ in range(2):
            stream = stack.enter_context(client.stream("GET", "/api/events", headers=far))
            assert stream.status_code == 200
        refused = client.get("/api/trees", headers=far)
        assert (refused.status_code, refused.json()["code"]) == (429, "too-many-open-requests")
        assert refused.headers["retry-after"] == "5"
        assert client.get("/api/trees", headers=near).status_code == 200
        assert client.get("/api/health", headers=far).status_code == 200
    wait_until(lambda: httpx.get(f"{server.url}/api/trees", headers=far).status_code == 200)


def test_a_local_client_does_not_choose_its_address(start_server: Start) -> None:
    server = start_server(GALEWOOD_READS_PER_MINUTE="20")
    with httpx.Client(base_url=server.url, timeout=30) as client:
        # two windows, because a new one may begin in between
        statuses = [
            client.get("/api/trees", headers={"X-Forwarded-For": f"10.0.0.{k}"}).status_code
            for k in range(60)
        ]
    assert 429 in statuses


class Link:
    def __init__(self) -> None:
        self.closed = False

    def close_waiting(self) -> None:
        self.closed = True


def test_an_address_with_many_connections_takes_its_own_places() -> None:
    connections = OpenConnections(ceiling=4)
    other, *mine = [Link() for _ in range(5)]
    assert connections.admit(other, "a", 9)
    assert all(connections.admit(link, "b", 9) for link in mine)
    assert [link.closed for link in (other, *mine)] == [False, True, False, False, False]
    connections.works(mine[1])
    assert connections.admit(Link(), "c", 9) and other.closed, "an address without connections: the longest"
    for link in mine[2:]:
        connections.works(link)
    assert connections.admit(Link(), "c", 9), "in the place of the other one of this address"
    assert len(connections) == 4


def test_a_full_table_of_descriptors_is_no_room(monkeypatch: pytest.MonkeyPatch) -> None:
    connections, first = OpenConnections(ceiling=1000), Link()
    monkeypatch.setattr(resource, "getrlimit", lambda _: (1024, 1024))
    assert connections.admit(first, "a", 927)
    assert connections.admit(Link(), "b", 928) and first.closed
    connections.works(next(iter(connections._waiting)))  # pyright: ignore[reportPrivateUsage]
    assert not connections.admit(Link(), "b", 928), "none waits"
    monkeypatch.setattr(resource, "getrlimit", lambda _: (resource.RLIM_INFINITY,) * 2)
    assert connections.admit(Link(), "b", 10**6)


@pytest.mark.parametrize("number", [errno.EMFILE, errno.ENFILE])
def test_a_file_that_cannot_be_opened_for_want_of_descriptors_is_503(number: int) -> None:
    assert problem_from(OSError(number, "Too many open files")).status == 503


def test_floods_do_not_fill_the_log(start_server: Start) -> None:
    server = start_server(GALEWOOD_READS_PER_MINUTE="50")
    before = len(server.log())
    for _ in range(300):
        with links(server, 1, b"\0nonsense\r\n\r\n") as (link,):
            assert link.recv(12).endswith(b"400")
    with httpx.Client(base_url=server.url) as client:
        statuses = [client.get("/api/trees").status_code for _ in range(300)]
    assert statuses.count(429) > 150
    log = server.log()[before:]
    assert log.count("Invalid HTTP request") == 20 and log.count("refused requests of 127.0.0.1") == 20
    assert len(log) < 60_000 and log.count("status=429") == 0


def test_a_message_that_repeats_is_counted() -> None:
    now_s = 0.0
    throttle = Throttle("requests", lambda: now_s)

    def logged(message: str, *arguments: object, name: str = "any") -> str | None:
        record = logging.LogRecord(name, logging.INFO, "", 0, message, arguments, None)
        return record.getMessage() if throttle.filter(record) else None

    lines = [logged("lost %d of %s", k, "x") for k in range(100)]
    assert lines[:20] == [f"lost {k} of x" for k in range(20)] and set(lines[20:]) == {None}
    assert logged("another") == "another"
    assert all(logged("request", name="requests") for _ in range(100))
    now_s = 61.0
    assert logged("lost %d of %s", 7, "y") == "lost 7 of y (and 80 times more since the last such line)"
    assert logged("lost %d of %s", 8, "y") == "lost 8 of y"
    now_s = 200.0
    assert logged("lost %d of %s", 9, "y") == "lost 9 of y"

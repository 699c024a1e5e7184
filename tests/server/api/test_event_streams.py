"""Event streams: ceilings per address, in total and by file descriptors; idle streams; one shared state."""

from __future__ import annotations

import asyncio
import contextlib
import json
import resource
import socket
from collections.abc import Callable, Generator
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import httpx
import pytest
from galewood_server.api import events
from galewood_server.context import Service
from galewood_server.http import TreeSummary
from galewood_server.settings import Settings
from galewood_server.storage import Tree, open_database
from sqlalchemy import event as database_event

from tests.server.support.server_process import Server, empty_database, wait_until

TREES = 7
Start = Callable[..., Server]


@contextlib.contextmanager
def streams(server: Server, count: int) -> Generator[list[tuple[socket.socket, bytes]]]:
    """Raw connections that ask for /api/events, with the first bytes of each answer."""
    request = b"GET /api/events HTTP/1.1\r\nHost: localhost\r\n\r\n"
    with contextlib.ExitStack() as stack:
        links: list[tuple[socket.socket, bytes]] = []
        for _ in range(count):
            link = stack.enter_context(socket.create_connection(("127.0.0.1", server.port), timeout=20))
            link.sendall(request)
            links.append((link, link.recv(12)))
        yield links


def count_of(server: Server) -> int:
    metrics = httpx.get(f"{server.url}/metrics").text
    return int(float(metrics.split("\ngalewood_event_streams ")[1].split()[0]))


@pytest.mark.parametrize(("setting", "status"), [("_PER_ADDRESS", 429), ("", 503)])
def test_event_streams_have_a_ceiling(start_server: Start, setting: str, status: int) -> None:
    server = start_server(**{f"GALEWOOD_EVENT_STREAMS{setting}": "3"})
    with streams(server, 3) as opened:
        assert all(head.endswith(b"200") for _, head in opened) and count_of(server) == 3
        refused = httpx.get(f"{server.url}/api/events")
        assert refused.status_code == status and refused.headers["retry-after"]
        assert refused.json()["code"] == "too-many-event-streams"
    wait_until(lambda: count_of(server) == 0)
    with streams(server, 1) as opened:
        assert opened[0][1].endswith(b"200")


def test_event_streams_leave_descriptors_for_requests(start_server: Start) -> None:
    server = start_server(GALEWOOD_EVENT_STREAMS="5000", GALEWOOD_EVENT_STREAMS_PER_ADDRESS="5000")
    assert server.process
    resource.prlimit(server.process.pid, resource.RLIMIT_NOFILE, (256, 256))
    statuses: list[bytes] = []
    with contextlib.ExitStack() as stack:
        for _ in range(300):
            ((link, head),) = stack.enter_context(streams(server, 1))
            statuses.append(head[-3:])
            if head[-3:] != b"200":
                link.close()
        assert statuses == [b"200"] * 48 + [b"503"] * 252  # a quarter of 256 - 64
        assert httpx.get(f"{server.url}/api/health").status_code == 200
    assert "Too many open files" not in server.log()


def test_an_idle_stream_ends(start_server: Start) -> None:
    server = start_server(GALEWOOD_EVENT_STREAM_IDLE_S="0.2")
    with httpx.stream("GET", f"{server.url}/api/events", timeout=20) as stream:
        assert stream.status_code == 200 and not list(stream.iter_lines())


def service_with_trees(folder: Path) -> Service:
    path = folder / "trees.sqlite"
    path.write_bytes(empty_database())
    sessions = open_database(f"sqlite:///{path}")
    with sessions.begin() as session:
        for k in range(TREES):
            session.add(Tree(id=f"tree{k}", name=f"tree {k}", filename="x", source_sha256="0" * 64))
    return cast(Service, SimpleNamespace(sessions=sessions, settings=Settings()))


def test_listeners_share_one_query_and_one_serialised_state(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    service = service_with_trees(tmp_path)
    queries, serialised = [0], [0]
    dump = TreeSummary.model_dump_json

    def counted_dump(tree: TreeSummary, **given: Any) -> str:
        serialised[0] += 1
        return dump(tree, **given)

    def counted_query(*_: object) -> None:
        queries[0] += 1

    monkeypatch.setattr(TreeSummary, "model_dump_json", counted_dump)
    monkeypatch.setattr(events, "POLL_S", 60.0)  # one poll, however slow the machine
    database_event.listen(service.sessions.kw["bind"], "before_cursor_execute", counted_query)

    async def listen(feed: events.ChangeFeed) -> bytes:
        stream = events.all_changes(feed)
        try:
            return await anext(stream)
        finally:
            await stream.aclose()

    async def listen_all() -> list[bytes]:
        feed = events.ChangeFeed(service)
        return await asyncio.gather(*(listen(feed) for _ in range(100)))

    received = asyncio.run(listen_all())
    assert serialised[0] == TREES and queries[0] <= 4
    assert all(piece is received[0] for piece in received)  # the same bytes, not copies
    lines = [line for line in received[0].decode().splitlines() if line]
    named = [json.loads(line.removeprefix("data: "))["tree"]["id"] for line in lines]
    assert named == [f"tree{k}" for k in range(TREES)]


def test_a_buffer_keeps_the_newest_visible_event_of_a_tree() -> None:
    async def fill() -> list[events.Event]:
        buffer = events.ClientBuffer(10.0)
        for data, visible in ((b"1", True), (b"2", True), (b"2", False)):
            buffer.put(events.Event("tree", data, visible))
        buffer.put(events.Event("other", b"3", False))
        return await buffer.take()

    taken = asyncio.run(fill())
    assert [(event.data, event.visible) for event in taken] == [(b"2", True), (b"3", False)]

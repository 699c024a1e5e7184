"""Server-sent events: the database is polled a few times per second, once for all subscribers."""

from __future__ import annotations

import asyncio
import math
import time
from collections.abc import AsyncGenerator, AsyncIterator, Callable, Generator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Protocol, TypeVar

from fastapi import APIRouter, Request
from sqlalchemy import func, select, type_coerce
from sqlalchemy.types import NullType
from sse_starlette import EventSourceResponse, ServerSentEvent
from starlette.requests import HTTPConnection
from starlette.types import Receive, Scope, Send

from galewood_server.access import client_key, count_open
from galewood_server.api.connections import streams_exceeded
from galewood_server.api.jobs import job_json
from galewood_server.api.trees import tree_json
from galewood_server.context import Service, ServiceDep, service_of
from galewood_server.http import EVENT_STREAM, JobOut, ProblemError
from galewood_server.jobs import find_job
from galewood_server.storage import (
    ACTIVE_STATES,
    TREE_FIELDS,
    Job,
    JobState,
    RawRow,
    Tree,
    job_rows,
    raw_column,
    tree_rows,
)

router = APIRouter(prefix="/api", tags=["events"])
POLL_S = 0.3
SEND_TIMEOUT_S = 20.0
JOB_ID = TREE_FIELDS.index("job_id")
PIECE_BYTES = 64 * 1024  # of the snapshot, so that a slow listener holds no copy of all of it

Stamp = tuple[object, int, object]
"""Last change of a tree, its number of jobs, and the last change of its jobs, as the database holds them."""


class JobView(Protocol):
    """The common fields of all job response models."""

    @property
    def tree_id(self) -> str: ...

    @property
    def state(self) -> JobState: ...

    def model_dump_json(self) -> str: ...


Value = TypeVar("Value", bound=JobView)


@dataclass(frozen=True)
class Event:
    """A change, serialised once for all subscribers."""

    tree_id: str
    data: bytes
    # false if only an analysis of the tree changed, which is not part of the serialised state
    visible: bool


class ClientBuffer:
    """Unsent events of one subscriber: only the newest of each tree, so that memory stays bounded."""

    def __init__(self, idle_s: float) -> None:
        self._idle_s = idle_s
        self._events: dict[str, Event] = {}
        self._arrived = asyncio.Event()

    def put(self, event: Event) -> None:
        """Add an event; it replaces an older one of the same tree, unless it shows nothing new."""
        if event.visible or event.tree_id not in self._events:
            self._events[event.tree_id] = event
        self._arrived.set()

    async def take(self) -> list[Event]:
        """Wait for events and remove them from the buffer. Empty if nothing happens for long."""
        try:
            async with asyncio.timeout(self._idle_s):
                await self._arrived.wait()
        except TimeoutError:
            return []
        self._arrived.clear()
        events, self._events = list(self._events.values()), {}
        return events


class ChangeFeed:
    """Polls the database for changes and adds them to the buffer of every subscriber."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._buffers: set[ClientBuffer] = set()
        self._known: dict[str, Known] = {}
        self._snapshot: bytes | None = None
        self._polling = asyncio.Lock()
        self._polled_s = -math.inf

    @contextmanager
    def subscribe(self) -> Generator[ClientBuffer]:
        """A buffer that receives changes while the block runs."""
        buffer = ClientBuffer(self._service.settings.event_stream_idle_s)
        self._buffers.add(buffer)
        try:
            yield buffer
        finally:
            self._buffers.discard(buffer)

    async def run(self) -> None:
        """Poll until cancelled; does not query the database while there are no subscribers."""
        while True:
            if self._buffers:
                await self.refresh()
            await asyncio.sleep(POLL_S)

    async def refresh(self) -> None:
        """Poll unless another task has just done so: many listeners that come at once cost one query."""
        async with self._polling:
            if time.monotonic() - self._polled_s < POLL_S / 2:
                return
            began_s = time.monotonic()
            stamps, changed = await asyncio.to_thread(self._query)
            self._polled_s = began_s
            self._publish(stamps, changed)

    @property
    def snapshot(self) -> bytes:
        """All trees as of the last poll, serialised once for all listeners."""
        if self._snapshot is None:
            known = sorted(self._known.values(), key=lambda one: one.order)
            self._snapshot = b"".join(one.data for one in known)
        return self._snapshot

    def _query(self) -> tuple[dict[str, Stamp], dict[str, Known]]:
        """The stamps of all trees, and the state of those that changed since the last poll."""
        job_changed = func.max(type_coerce(Job.updated_at, NullType()))
        newest = (
            select(Tree.id, raw_column(Tree.updated_at), func.count(Job.id), job_changed)
            .outerjoin(Job)
            .group_by(Tree.id)
        )
        with self._service.sessions() as session:
            stamps: dict[str, Stamp] = {row[0]: (row[1], row[2], row[3]) for row in session.execute(newest)}
            changed = [
                key
                for key, stamp in stamps.items()
                if key not in self._known or self._known[key].stamp != stamp
            ]
            if not changed:
                return stamps, {}
            trees = [tuple(row) for row in session.execute(tree_rows().where(Tree.id.in_(changed)))]
            names = [row[JOB_ID] for row in trees if row[JOB_ID] is not None]
            jobs = {row[0]: tuple(row) for row in session.execute(job_rows().where(Job.id.in_(names)))}
        return stamps, {row[0]: Known(stamps[row[0]], row, jobs.get(row[JOB_ID])) for row in trees}

    def _publish(self, stamps: Mapping[str, Stamp], changed: Mapping[str, Known]) -> None:
        events: list[Event] = []
        for key in [key for key in self._known if key not in stamps]:
            events += _events_of(self._known.pop(key), None)
        for key, now in changed.items():
            events += _events_of(self._known.get(key), now)
            self._known[key] = now
        if any(event.visible for event in events):
            self._snapshot = None
        for event in events:
            for buffer in self._buffers:
                buffer.put(event)


class Known:
    """A tree with its newest build job at the last poll."""

    def __init__(self, stamp: Stamp, tree: RawRow, job: RawRow | None) -> None:
        self.stamp, self.tree = stamp, tree
        self._tree_json = tree_json(tree)
        self._job_json = (job_json(job) if job else None) or b"null"
        self.data = self.event(deleted=False)

    @property
    def order(self) -> tuple[bool, str, str]:
        """Sort key: built-in trees first, then by age."""
        found = dict(zip(TREE_FIELDS, self.tree, strict=True))
        return not found["builtin"], str(found["created_at"]), found["id"]

    def event(self, *, deleted: bool) -> bytes:
        """The event of this state; empty if the tree is damaged and left out."""
        if self._tree_json is None:
            return b""
        end = b"true" if deleted else b"false"
        body = b'{"tree":%b,"job":%b,"deleted":%b}' % (self._tree_json, self._job_json, end)
        return ServerSentEvent(body.decode()).encode()


def _events_of(before: Known | None, now: Known | None) -> list[Event]:
    """The event that follows from a change; none for a tree that was and is left out."""
    known = now or before
    assert known is not None
    tree_id = known.tree[0]
    if now is not None and now.data:
        # a comparison or evaluation changes the stamp of its tree but not this event
        return [Event(tree_id, now.data, before is None or before.data != now.data)]
    return [Event(tree_id, before.event(deleted=True), True)] if before is not None and before.data else []


def feed_of(connection: HTTPConnection) -> ChangeFeed:
    """The ChangeFeed of the application."""
    feed = connection.app.state.feed
    assert isinstance(feed, ChangeFeed)
    return feed


@router.get("/events", response_class=EventSourceResponse, responses=EVENT_STREAM)
async def all_events(request: Request) -> EventSourceResponse:
    """The current state of all trees, then every change: {"tree": Tree, "job": Job|null, "deleted": bool}.
    The tree is as in the list, without its report; the job is its newest build job."""
    service = service_of(request)
    return stream(service, all_changes(feed_of(request)))


@router.get("/jobs/{job_id}/events", response_class=EventSourceResponse, responses=EVENT_STREAM)
async def job_events(job_id: str, request: Request, service: ServiceDep) -> EventSourceResponse:
    """Server-sent events named "progress" with the job, until it ends."""

    def read() -> JobOut:
        with service.sessions() as session:
            return JobOut.model_validate(find_job(session, job_id))

    await asyncio.to_thread(read)  # 404 before the stream begins
    return stream(service, follow_job(feed_of(request), read))


class LimitedEvents(EventSourceResponse):
    """Server-sent events, or a problem if too many streams are open."""

    def __init__(self, service: Service, events: AsyncIterator[ServerSentEvent | bytes]) -> None:
        super().__init__(events, send_timeout=SEND_TIMEOUT_S)  # pyright: ignore[reportUnknownMemberType]
        self._service = service

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Count the stream while it is open."""
        address = client_key(scope)
        problem = streams_exceeded(self._service, address)
        if problem:
            await problem.response({"Retry-After": "30"})(scope, receive, send)
            return
        with count_open(self._service.event_addresses, address):
            await super().__call__(scope, receive, send)


def stream(service: Service, events: AsyncIterator[ServerSentEvent | bytes]) -> EventSourceResponse:
    """A response of server-sent events; clients that do not read for SEND_TIMEOUT_S are disconnected."""
    return LimitedEvents(service, events)


async def all_changes(feed: ChangeFeed) -> AsyncGenerator[bytes]:
    """The state of all trees in pieces, then every change."""
    await feed.refresh()
    with feed.subscribe() as buffer:
        snapshot = feed.snapshot  # nothing is awaited since subscribing: no change is missed or sent twice
        for start in range(0, len(snapshot), PIECE_BYTES):
            yield snapshot[start : start + PIECE_BYTES]
        del snapshot
        # a client that is still there when an idle stream ends connects again
        while events := await buffer.take():
            for event in events:
                if event.visible:
                    yield event.data


async def follow_job(feed: ChangeFeed, read: Callable[[], Value]) -> AsyncIterator[ServerSentEvent]:
    """The current state of a job, then every change, until it ends, its tree is deleted or it is idle."""
    with feed.subscribe() as buffer:
        job = await asyncio.to_thread(read)  # after subscribing, so that no change is missed
        yield ServerSentEvent(job.model_dump_json(), event="progress")
        while job.state in ACTIVE_STATES:
            events = await buffer.take()
            if not events:
                return
            if any(event.tree_id == job.tree_id for event in events):
                try:
                    now = await asyncio.to_thread(read)
                except ProblemError:
                    return
                if now != job:
                    yield ServerSentEvent(now.model_dump_json(), event="progress")
                job = now

"""Server-sent events: the database is polled a few times per second, once for all subscribers."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Generator, Sequence
from contextlib import contextmanager
from datetime import datetime
from typing import Protocol, TypeVar

from fastapi import APIRouter, Request
from sqlalchemy import func, select
from sse_starlette import EventSourceResponse, ServerSentEvent
from starlette.requests import HTTPConnection

from galewood_server.api.trees import job_out, tree_out
from galewood_server.context import Service, ServiceDep, service_of
from galewood_server.http import Change, JobOut, ProblemError
from galewood_server.jobs import find_job
from galewood_server.storage import ACTIVE, Job, JobState, Tree

router = APIRouter(prefix="/api", tags=["events"])
POLL_S = 0.3
SEND_TIMEOUT_S = 20.0

Stamp = tuple[datetime, int, datetime | None]
"""Last change of a tree, its number of jobs, and the last change of its jobs."""


class JobView(Protocol):
    """The common fields of all job response models."""

    @property
    def tree_id(self) -> str: ...

    @property
    def state(self) -> JobState: ...

    def model_dump_json(self) -> str: ...


Value = TypeVar("Value", bound=JobView)


class ClientBuffer:
    """Unsent changes of one subscriber: only the newest of each tree, so that memory stays bounded."""

    def __init__(self) -> None:
        self._changes: dict[str, Change] = {}
        self._arrived = asyncio.Event()

    def put(self, change: Change) -> None:
        """Add a change; it replaces an older one of the same tree."""
        self._changes[change.tree.id] = change
        self._arrived.set()

    async def take(self) -> list[Change]:
        """Wait for changes and remove them from the buffer."""
        await self._arrived.wait()
        self._arrived.clear()
        changes, self._changes = list(self._changes.values()), {}
        return changes


class ChangeFeed:
    """Polls the database for changes and adds them to the buffer of every subscriber."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._buffers: set[ClientBuffer] = set()
        self._known: dict[str, tuple[Stamp, Change]] = {}

    @contextmanager
    def subscribe(self) -> Generator[ClientBuffer]:
        """A buffer that receives changes while the block runs."""
        buffer = ClientBuffer()
        self._buffers.add(buffer)
        try:
            yield buffer
        finally:
            self._buffers.discard(buffer)

    async def run(self) -> None:
        """Poll until cancelled; does not query the database while there are no subscribers."""
        while True:
            if self._buffers:
                for change in await asyncio.to_thread(self._changes):
                    for buffer in self._buffers:
                        buffer.put(change)
            await asyncio.sleep(POLL_S)

    def _changes(self) -> list[Change]:
        newest = (
            select(Tree.id, Tree.updated_at, func.count(Job.id), func.max(Job.updated_at))
            .outerjoin(Job)
            .group_by(Tree.id)
        )
        with self._service.sessions() as session:
            stamps: dict[str, Stamp] = {row[0]: (row[1], row[2], row[3]) for row in session.execute(newest)}
            changed = [
                key for key, stamp in stamps.items() if key not in self._known or self._known[key][0] != stamp
            ]
            trees: Sequence[Tree] = ()
            if changed:
                trees = session.scalars(select(Tree).where(Tree.id.in_(changed))).all()
            changes = [Change(tree=tree_out(tree), job=job_out(tree)) for tree in trees]
        deleted = [self._known.pop(key)[1] for key in list(self._known) if key not in stamps]
        self._known.update({change.tree.id: (stamps[change.tree.id], change) for change in changes})
        return changes + [Change(tree=last.tree, job=last.job, deleted=True) for last in deleted]


def feed_of(connection: HTTPConnection) -> ChangeFeed:
    """The ChangeFeed of the application."""
    feed = connection.app.state.feed
    assert isinstance(feed, ChangeFeed)
    return feed


@router.get("/events", response_class=EventSourceResponse)
async def all_events(request: Request) -> EventSourceResponse:
    """The current state of all trees, then every change: {"tree": Tree, "job": Job|null, "deleted": bool}."""
    return stream(_all_events(service_of(request), feed_of(request)))


@router.get("/jobs/{job_id}/events", response_class=EventSourceResponse)
async def job_events(job_id: str, request: Request, service: ServiceDep) -> EventSourceResponse:
    """Server-sent events named "progress" with the job, until it ends."""

    def read() -> JobOut:
        with service.sessions() as session:
            return JobOut.model_validate(find_job(session, job_id))

    await asyncio.to_thread(read)  # 404 before the stream begins
    return stream(follow_job(feed_of(request), read))


def stream(events: AsyncIterator[ServerSentEvent]) -> EventSourceResponse:
    """A response of server-sent events; clients that do not read for SEND_TIMEOUT_S are disconnected."""
    return EventSourceResponse(events, send_timeout=SEND_TIMEOUT_S)


async def _all_events(service: Service, feed: ChangeFeed) -> AsyncIterator[ServerSentEvent]:
    sent: dict[str, Change] = {}
    with feed.subscribe() as buffer:
        changes = await asyncio.to_thread(_current, service)
        while True:
            for change in changes:
                # a comparison or evaluation changes the stamp of its tree but not this event
                if sent.get(change.tree.id) != change:
                    yield ServerSentEvent(change.model_dump_json())
                sent[change.tree.id] = change
                if change.deleted:
                    del sent[change.tree.id]
            changes = await buffer.take()


async def follow_job(feed: ChangeFeed, read: Callable[[], Value]) -> AsyncIterator[ServerSentEvent]:
    """The current state of a job, then every change, until it ends or its tree is deleted."""
    with feed.subscribe() as buffer:
        job = await asyncio.to_thread(read)  # after subscribing, so that no change is missed
        yield ServerSentEvent(job.model_dump_json(), event="progress")
        while job.state in ACTIVE:
            changes = await buffer.take()
            if any(change.tree.id == job.tree_id for change in changes):
                try:
                    now = await asyncio.to_thread(read)
                except ProblemError:
                    return
                if now != job:
                    yield ServerSentEvent(now.model_dump_json(), event="progress")
                job = now


def _current(service: Service) -> list[Change]:
    with service.sessions() as session:
        trees = session.scalars(select(Tree).order_by(Tree.builtin.desc(), Tree.created_at)).all()
        return [Change(tree=tree_out(tree), job=job_out(tree)) for tree in trees]

"""Progress by server-sent events: the database is looked at a few times a second, once for all listeners."""

from __future__ import annotations

import asyncio
from collections.abc import AsyncIterator, Callable, Generator
from contextlib import contextmanager
from datetime import datetime
from typing import Protocol, TypeVar

from fastapi import APIRouter, Request
from sqlalchemy import func, select
from sse_starlette import EventSourceResponse, ServerSentEvent
from starlette.requests import HTTPConnection

from galewood_server.api.trees import job_out, tree_out
from galewood_server.context import Service, ServiceHere, service_of
from galewood_server.http import Change, JobOut, ProblemError
from galewood_server.jobs import find_job
from galewood_server.storage import ACTIVE, Job, JobState, Tree

router = APIRouter(prefix="/api", tags=["events"])
LOOK_S = 0.3
SEND_TIMEOUT_S = 20.0

Stamp = tuple[datetime, int, datetime | None]
"""A tree's own last change, how many jobs it has, and their last change."""


class Followed(Protocol):
    """A job as a client sees it."""

    @property
    def tree_id(self) -> str: ...

    @property
    def state(self) -> JobState: ...

    def model_dump_json(self) -> str: ...


Value = TypeVar("Value", bound=Followed)


class ClientBuffer:
    """What one listener was not sent yet: the newest change of each tree, so a slow one costs no memory."""

    def __init__(self) -> None:
        self._changes: dict[str, Change] = {}
        self._arrived = asyncio.Event()

    def put(self, change: Change) -> None:
        """Leave a change, in place of an older one of the same tree."""
        self._changes[change.tree.id] = change
        self._arrived.set()

    async def take(self) -> list[Change]:
        """Wait for changes and empty the box."""
        await self._arrived.wait()
        self._arrived.clear()
        changes, self._changes = list(self._changes.values()), {}
        return changes


class ChangeFeed:
    """Finds what changed in the database and puts it in every listener's mailbox."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._boxes: set[ClientBuffer] = set()
        self._known: dict[str, tuple[Stamp, Change]] = {}

    @contextmanager
    def listen(self) -> Generator[ClientBuffer]:
        """A mailbox that is filled for as long as the block runs."""
        box = ClientBuffer()
        self._boxes.add(box)
        try:
            yield box
        finally:
            self._boxes.discard(box)

    async def run(self) -> None:
        """Work until cancelled; sleeps while nobody listens."""
        while True:
            if self._boxes:
                for change in await asyncio.to_thread(self._changes):
                    for box in self._boxes:
                        box.put(change)
            await asyncio.sleep(LOOK_S)

    def _changes(self) -> list[Change]:
        newest = (
            select(Tree.id, Tree.updated_at, func.count(Job.id), func.max(Job.updated_at))
            .outerjoin(Job)
            .group_by(Tree.id)
        )
        with self._service.sessions() as session:
            stamps: dict[str, Stamp] = {row[0]: (row[1], row[2], row[3]) for row in session.execute(newest)}
            moved = [
                key for key, stamp in stamps.items() if key not in self._known or self._known[key][0] != stamp
            ]
            found = session.scalars(select(Tree).where(Tree.id.in_(moved))).all() if moved else []
            changes = [Change(tree=tree_out(tree), job=job_out(tree)) for tree in found]
        gone = [self._known.pop(key)[1] for key in list(self._known) if key not in stamps]
        self._known.update({change.tree.id: (stamps[change.tree.id], change) for change in changes})
        return changes + [Change(tree=last.tree, job=last.job, deleted=True) for last in gone]


def feed_of(connection: HTTPConnection) -> ChangeFeed:
    """The feed of the running service."""
    feed = connection.app.state.feed
    assert isinstance(feed, ChangeFeed)
    return feed


@router.get("/events", response_class=EventSourceResponse)
async def all_events(request: Request) -> EventSourceResponse:
    """Every tree as it stands, then every change: {"tree": Tree, "job": Job|null, "deleted": bool}."""
    return stream(_all(service_of(request), feed_of(request)))


@router.get("/jobs/{job_id}/events", response_class=EventSourceResponse)
async def job_events(job_id: str, request: Request, service: ServiceHere) -> EventSourceResponse:
    """Events named "progress" with the job, until it ends."""

    def read() -> JobOut:
        with service.sessions() as session:
            return JobOut.model_validate(find_job(session, job_id))

    await asyncio.to_thread(read)  # 404 before the stream begins
    return stream(follow_job(feed_of(request), read))


def stream(events: AsyncIterator[ServerSentEvent]) -> EventSourceResponse:
    """An answer of server-sent events; a client that takes nothing for a while is let go."""
    return EventSourceResponse(events, send_timeout=SEND_TIMEOUT_S)


async def _all(service: Service, feed: ChangeFeed) -> AsyncIterator[ServerSentEvent]:
    sent: dict[str, Change] = {}
    with feed.listen() as box:
        changes = await asyncio.to_thread(_standing, service)
        while True:
            for change in changes:
                # a comparison moves its tree's stamp, but is no news here
                if sent.get(change.tree.id) != change:
                    yield ServerSentEvent(change.model_dump_json())
                sent[change.tree.id] = change
                if change.deleted:
                    del sent[change.tree.id]
            changes = await box.take()


async def follow_job(feed: ChangeFeed, read: Callable[[], Value]) -> AsyncIterator[ServerSentEvent]:
    """The job as it is and at each change, until it has ended or is deleted with its tree."""
    with feed.listen() as box:
        job = await asyncio.to_thread(read)  # what changed before we listened is told by nobody
        yield ServerSentEvent(job.model_dump_json(), event="progress")
        while job.state in ACTIVE:
            changes = await box.take()
            if any(change.tree.id == job.tree_id for change in changes):
                try:
                    now = await asyncio.to_thread(read)
                except ProblemError:
                    return
                if now != job:
                    yield ServerSentEvent(now.model_dump_json(), event="progress")
                job = now


def _standing(service: Service) -> list[Change]:
    with service.sessions() as session:
        trees = session.scalars(select(Tree).order_by(Tree.builtin.desc(), Tree.created_at)).all()
        return [Change(tree=tree_out(tree), job=job_out(tree)) for tree in trees]

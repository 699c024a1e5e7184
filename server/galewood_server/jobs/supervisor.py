"""Runs the queue: starts one process a job, watches it, stops it when cancelled, picks up after a crash."""

from __future__ import annotations

import asyncio
import logging
import time
from dataclasses import dataclass

from galewood.util import write_whole
from sqlalchemy.exc import SQLAlchemyError

from galewood_server.context import Service
from galewood_server.jobs import leases
from galewood_server.jobs.cluster.blob_transfer import BlobTransfer
from galewood_server.jobs.cluster.embedded import Cluster, ClusterError
from galewood_server.jobs.processes import start_module, stop
from galewood_server.jobs.queue import end_job
from galewood_server.storage import Job, JobKind, collect_garbage, forget_analysis_folders

log = logging.getLogger("galewood.jobs")
LOOK_S = 0.4
QUEUES: dict[str, tuple[JobKind, ...]] = {
    "builds": ("build",),
    "comparisons": ("comparison",),
    "evaluations": ("evaluation",),
}
"""A comparison takes seconds and somebody waits for it: it does not queue behind builds or evaluations."""


@dataclass(frozen=True)
class Claim:
    """A job of ours, by the word of its lease (leases.py)."""

    job_id: str
    lease: str
    queue: str


class Supervisor:
    """The one place that starts job processes. The truth about a job is in the database, never here."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._cluster = Cluster(service.settings)
        self._owner = leases.server_identity(service.settings.data_dir)
        self._watched: dict[Claim, asyncio.Task[None]] = {}
        self._collected_s = time.monotonic()

    async def run(self) -> None:
        """Work until cancelled, then stop every child and give unfinished jobs back to the queue."""
        interrupted = await asyncio.to_thread(self._give_back)
        if interrupted:
            log.info("%d interrupted job(s) go on", interrupted)
        try:
            while True:
                await self._look()
                await self._cluster.close_if_idle(busy=self._busy("builds") > 0)
                await self._collect_garbage()
                await self._pause()
        finally:
            for task in self._watched.values():
                task.cancel()
            await asyncio.gather(*self._watched.values(), return_exceptions=True)
            await self._cluster.close()
            await asyncio.to_thread(self._give_back)

    def _give_back(self) -> int:
        with self._service.sessions.begin() as session:
            return leases.give_back(session, self._owner)

    async def _pause(self) -> None:
        try:
            async with asyncio.timeout(LOOK_S):
                await self._service.jobs_changed.wait()
        except TimeoutError:
            pass
        self._service.jobs_changed.clear()

    async def _look(self) -> None:
        """Start what waits; a database that is away for a moment is asked again at the next look."""
        try:
            for queue in QUEUES:
                await self._start_waiting(queue)
        except SQLAlchemyError:
            log.exception("the queue could not be read")

    async def _collect_garbage(self) -> None:
        """Now and then, remove files that were replaced."""
        if time.monotonic() - self._collected_s > self._service.settings.garbage_collection_s:
            self._collected_s = time.monotonic()
            try:
                await asyncio.to_thread(self._remove_garbage)
            except (SQLAlchemyError, OSError):
                log.exception("replaced files could not be removed")

    def _remove_garbage(self) -> None:
        service = self._service
        with service.files_lock:
            removed = collect_garbage(service.sessions, service.stores, service.settings.replaced_files_s)
        forget_analysis_folders(service.sessions, service.settings.analyses_dir)
        if removed:
            log.info("%d replaced file(s) removed", removed)

    def _busy(self, queue: str) -> int:
        self._watched = {claim: task for claim, task in self._watched.items() if not task.done()}
        return sum(claim.queue == queue for claim in self._watched)

    async def _start_waiting(self, queue: str) -> None:
        settings = self._service.settings
        room = {
            "builds": settings.concurrent_jobs,
            "comparisons": settings.concurrent_analyses,
            "evaluations": settings.concurrent_evaluations,
        }
        while self._busy(queue) < room[queue]:
            claim = await asyncio.to_thread(self._claim, queue)
            if claim is None:
                return
            self._watched[claim] = asyncio.create_task(self._watch(claim))

    def _claim(self, queue: str) -> Claim | None:
        with self._service.sessions.begin() as session:
            found = leases.claim(session, self._owner, QUEUES[queue], self._service.settings.lease_s)
            return Claim(*found, queue) if found else None

    async def _watch(self, claim: Claim) -> None:
        keeping = asyncio.create_task(self._keep(claim))
        try:
            await self._run_process(claim, keeping)
        finally:
            keeping.cancel()

    async def _keep(self, claim: Claim) -> None:
        """Renew the lease again and again; ends when it is lost."""
        lease_s = self._service.settings.lease_s
        kept_s = time.monotonic()
        while time.monotonic() - kept_s < lease_s:
            await asyncio.sleep(lease_s / 5)
            try:
                if not await asyncio.to_thread(self._renew, claim):
                    return
                kept_s = time.monotonic()
            except SQLAlchemyError:
                log.exception("the lease of job %s could not be renewed", claim.job_id)

    def _renew(self, claim: Claim) -> bool:
        with self._service.sessions.begin() as session:
            return leases.renew(session, claim.job_id, claim.lease, self._service.settings.lease_s)

    async def _run_process(self, claim: Claim, keeping: asyncio.Task[None]) -> None:
        try:
            address = await self._cluster.address() if claim.queue == "builds" else ""
        except ClusterError as error:
            await asyncio.to_thread(self._settle, claim, str(error))
            return
        settings = self._service.settings
        process = await start_module(
            settings.job_module, claim.job_id, claim.lease, address, environment=settings.environment()
        )
        try:
            cancelled = await self._wait(process, claim, keeping)
        finally:
            await stop(process)
        code = process.returncode
        reason = None if cancelled else f"The process that computed this ended with code {code}."
        await asyncio.to_thread(self._settle, claim, reason)

    async def _wait(
        self, process: asyncio.subprocess.Process, claim: Claim, keeping: asyncio.Task[None]
    ) -> bool:
        """Until process, cluster or lease end (False), or the job is cancelled or deleted (True)."""
        needs_cluster = claim.queue == "builds"
        while (
            process.returncode is None and not keeping.done() and not (needs_cluster and self._cluster.lost)
        ):
            try:
                async with asyncio.timeout(LOOK_S):
                    await process.wait()
            except TimeoutError:
                if await asyncio.to_thread(self._must_stop, claim.job_id):
                    await asyncio.to_thread(self._raise_flag, claim.job_id)
                    return True
        return False

    def _raise_flag(self, job_id: str) -> None:
        """Tell the workers, which Dask cannot stop."""
        settings = self._service.settings
        write_whole(settings.cancel_flag(job_id), b"")
        if settings.store_url:
            BlobTransfer(settings.store_url, job_id).cancel()

    def _must_stop(self, job_id: str) -> bool:
        try:
            with self._service.sessions() as session:
                job = session.get(Job, job_id)
                return job is None or job.cancel_requested
        except SQLAlchemyError:
            log.exception("job %s could not be read", job_id)
            return False

    def _settle(self, claim: Claim, crash: str | None) -> None:
        """A job whose process is gone and that has no last state was cancelled (crash None), or crashed."""
        with self._service.sessions.begin() as session:
            job = session.get(Job, claim.job_id)
            if job is None or job.state != "running" or job.lease != claim.lease:
                return
            if crash is None:
                end_job(session, claim.job_id, "cancelled", message="Cancelled")
            elif job.attempts + 1 < self._service.settings.job_attempts:
                job.attempts += 1
                job.state, job.message = "queued", "Interrupted; goes on from what was stored"
            else:
                end_job(session, claim.job_id, "failed", message="Failed", error=crash)

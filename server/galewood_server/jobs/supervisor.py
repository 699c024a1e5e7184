"""Runs the job queue: one process per job, cancellation, and recovery after crashes."""

from __future__ import annotations

import asyncio
import logging
import time
from dataclasses import dataclass
from datetime import datetime

from galewood.constants import STAGES_AFTER_TABLE
from galewood.util import write_atomically
from sqlalchemy.exc import SQLAlchemyError

from galewood_server.context import Service
from galewood_server.jobs import leases
from galewood_server.jobs.cluster.embedded import Cluster, ClusterError, Handover
from galewood_server.jobs.processes import ChildProcess, start_module
from galewood_server.jobs.queue import end_job
from galewood_server.storage import Job, JobKind, collect_garbage, forget_analysis_folders

log = logging.getLogger("galewood.jobs")
POLL_S = 0.4
QUEUES: dict[str, tuple[JobKind, ...]] = {
    "builds": ("build",),
    "individuals": ("individual",),
    "comparisons": ("comparison",),
    "evaluations": ("evaluation",),
}
"""Queue -> job kinds. Comparisons and individuals take seconds, so they do not wait for other kinds."""
STAGES_WITHOUT_CLUSTER = ("queued", "import")
"""Stages of a build in which the cluster is not started yet, so that it does not compete with the import."""


@dataclass(frozen=True)
class Claim:
    """A job claimed by this server, with its lease (leases.py)."""

    job_id: str
    lease: str
    queue: str


@dataclass(frozen=True)
class JobStatus:
    """What the supervisor needs to know of a running job."""

    cancelled: bool = False
    stage: str = ""
    reported: datetime | None = None
    """When the job last reported anything."""


class JobStalledError(Exception):
    """A job process is alive but has not reported progress for too long."""


CANCELLED_STATUS = JobStatus(cancelled=True)


class StallWatch:
    """Measures for how long a job has reported nothing, on this machine's clock."""

    def __init__(self, longest_s: float) -> None:
        self._longest_s = longest_s
        self._last: datetime | None = None
        self._since_s = time.monotonic()

    def check(self, reported: datetime | None) -> None:
        """Note when the job last reported. JobStalledError if that has not changed for too long."""
        now_s = time.monotonic()
        if reported is None or reported != self._last:
            self._last, self._since_s = reported, now_s
        elif now_s - self._since_s > self._longest_s:
            raise JobStalledError(f"The job made no progress for {self._longest_s / 60:.0f} minutes.")


class Supervisor:
    """Starts and supervises job processes. The state of jobs is kept only in the database."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._cluster = Cluster(service.settings)
        self._owner = leases.server_identity(service.settings.data_dir)
        self._running: dict[Claim, asyncio.Task[None]] = {}
        self._after_table: set[str] = set()
        """Running builds that have their table."""
        self._collected_s = time.monotonic()

    async def run(self) -> None:
        """Run until cancelled, then stop all child processes and requeue unfinished jobs."""
        interrupted = await asyncio.to_thread(self._requeue_running)
        if interrupted:
            log.info("resuming %d interrupted job(s)", interrupted)
        try:
            while True:
                await self._start_jobs()
                await self._cluster.close_if_idle(busy=self._running_builds > 0)
                await self._collect_garbage()
                await self._pause()
        finally:
            for task in self._running.values():
                task.cancel()
            await asyncio.gather(*self._running.values(), return_exceptions=True)
            await self._cluster.close()
            await asyncio.to_thread(self._requeue_running)

    def _requeue_running(self) -> int:
        with self._service.sessions.begin() as session:
            return leases.requeue_running(session, self._owner)

    async def _pause(self) -> None:
        try:
            async with asyncio.timeout(POLL_S):
                await self._service.jobs_changed.wait()
        except TimeoutError:
            pass
        self._service.jobs_changed.clear()

    async def _start_jobs(self) -> None:
        """Start queued jobs. Database errors are logged; the next poll tries again."""
        try:
            waiting = await asyncio.to_thread(
                self._claimable_kinds
            )  # one query for all queues: there are many polls
            for queue, kinds in QUEUES.items():
                if not waiting.isdisjoint(kinds):
                    await self._start_waiting(queue)
        except SQLAlchemyError:
            log.exception("the job queue could not be read")

    async def _collect_garbage(self) -> None:
        """Remove garbage every `garbage_collection_s`."""
        if time.monotonic() - self._collected_s > self._service.settings.garbage_collection_s:
            self._collected_s = time.monotonic()
            try:
                await asyncio.to_thread(self._remove_garbage)
            except (SQLAlchemyError, OSError):
                log.exception("garbage collection failed")

    def _remove_garbage(self) -> None:
        service = self._service
        with service.files_lock:
            removed = collect_garbage(service.sessions, service.stores, service.settings.replaced_files_s)
        forget_analysis_folders(service.sessions, service.settings.analyses_dir)
        if removed:
            log.info("garbage collection removed %d file(s)", removed)

    def _running_count(self, queue: str) -> int:
        """Running jobs that count for the limit of a queue: builds with a table make way for others."""
        self._running = {claim: task for claim, task in self._running.items() if not task.done()}
        return sum(claim.queue == queue for claim in self._running) - self._running_after_table(queue)

    def _running_after_table(self, queue: str) -> int:
        return sum(claim.queue == queue and claim.job_id in self._after_table for claim in self._running)

    @property
    def _running_builds(self) -> int:
        return sum(claim.queue == "builds" and not task.done() for claim, task in self._running.items())

    async def _start_waiting(self, queue: str) -> None:
        settings = self._service.settings
        limits = {
            "builds": settings.concurrent_jobs,
            "individuals": settings.concurrent_individuals,
            "comparisons": settings.concurrent_analyses,
            "evaluations": settings.concurrent_evaluations,
        }
        while self._running_count(queue) < limits[queue]:
            claim = await asyncio.to_thread(self._claim, queue)
            if claim is None:
                break
            self._running[claim] = asyncio.create_task(self._run_claim(claim))
        if queue == "builds" and self._running_count(queue) == 0:
            await self._start_after_tables(limits[queue])

    async def _start_after_tables(self, limit: int) -> None:
        """Go on with builds that have their table, while no other tree waits for one."""
        while self._running_after_table("builds") < limit:
            claim = await asyncio.to_thread(self._claim, "builds", after_table=True)
            if claim is None:
                return
            self._after_table.add(claim.job_id)
            self._running[claim] = asyncio.create_task(self._run_claim(claim))

    def _claimable_kinds(self) -> set[JobKind]:
        with self._service.sessions() as session:
            return leases.claimable_kinds(session)

    def _claim(self, queue: str, after_table: bool = False) -> Claim | None:
        with self._service.sessions.begin() as session:
            found = leases.claim(
                session, self._owner, QUEUES[queue], self._service.settings.lease_s, after_table=after_table
            )
            return Claim(*found, queue) if found else None

    async def _run_claim(self, claim: Claim) -> None:
        renewal = asyncio.create_task(self._renew_lease(claim))
        try:
            await self._run_process(claim, renewal)
        finally:
            renewal.cancel()
            self._after_table.discard(claim.job_id)
            self._service.jobs_changed.set()  # the next job starts now, not at the next poll

    async def _renew_lease(self, claim: Claim) -> None:
        """Renew the lease until it is lost."""
        lease_s = self._service.settings.lease_s
        renewed_s = time.monotonic()
        while time.monotonic() - renewed_s < lease_s:
            await asyncio.sleep(lease_s / 5)
            try:
                if not await asyncio.to_thread(self._renew, claim):
                    return
                renewed_s = time.monotonic()
            except SQLAlchemyError:
                log.exception("the lease of job %s could not be renewed", claim.job_id)

    def _renew(self, claim: Claim) -> bool:
        with self._service.sessions.begin() as session:
            return leases.renew(session, claim.job_id, claim.lease, self._service.settings.lease_s)

    async def _run_process(self, claim: Claim, renewal: asyncio.Task[None]) -> None:
        settings = self._service.settings
        process = await start_module(
            settings.job_module, claim.job_id, claim.lease, environment=settings.environment()
        )
        handover = Handover(self._cluster, process) if claim.queue == "builds" else None
        try:
            cancelled = await self._wait_for_end(process, claim, renewal, handover)
        except (ClusterError, JobStalledError) as error:
            await asyncio.to_thread(self._record_exit, claim, str(error))
            return
        finally:
            await process.stop()
            if handover:
                await handover.close()
        code = process.returncode
        reason = None if cancelled else f"The job process ended with exit code {code}."
        await asyncio.to_thread(self._record_exit, claim, reason)

    async def _wait_for_end(
        self,
        process: ChildProcess,
        claim: Claim,
        renewal: asyncio.Task[None],
        handover: Handover | None,
    ) -> bool:
        """Wait until the process, cluster or lease ends (False) or the job is cancelled or deleted (True).

        ClusterError if the cluster that the job needs could not be started, JobStalledError if the process
        is frozen: its lease is renewed by this server, so nothing else would notice.
        """
        watch = StallWatch(self._service.settings.job_stall_s)
        while process.returncode is None and not renewal.done() and not (handover and handover.lost):
            try:
                async with asyncio.timeout(POLL_S):
                    await process.wait()
            except TimeoutError:
                status = await asyncio.to_thread(self._status, claim.job_id)
                if status.cancelled:
                    await asyncio.to_thread(self._set_cancel_flag, claim.job_id)
                    return True
                self._note_stage(claim, status.stage, handover)
                watch.check(status.reported)
        return False

    def _note_stage(self, claim: Claim, stage: str, handover: Handover | None) -> None:
        """Start the cluster when a build is about to need it, the next build when its table is complete."""
        if handover is None or not stage:
            return
        if stage not in STAGES_WITHOUT_CLUSTER:
            handover.start()
        if stage in STAGES_AFTER_TABLE and claim.job_id not in self._after_table:
            self._after_table.add(claim.job_id)
            self._service.jobs_changed.set()

    def _set_cancel_flag(self, job_id: str) -> None:
        """Signal the cancellation to the workers, because Dask cannot stop running tasks."""
        settings = self._service.settings
        write_atomically(settings.cancel_flag(job_id), b"")
        if settings.store_url:
            from galewood_server.jobs.cluster.blob_transfer import BlobTransfer

            BlobTransfer(settings.store_url, job_id).set_cancel_flag()

    def _status(self, job_id: str) -> JobStatus:
        try:
            with self._service.sessions() as session:
                job = session.get(Job, job_id)
                return JobStatus(job.cancel_requested, job.stage, job.updated_at) if job else CANCELLED_STATUS
        except SQLAlchemyError:
            log.exception("job %s could not be read", job_id)
            return JobStatus()

    def _record_exit(self, claim: Claim, crash: str | None) -> None:
        """Update a job that ended without a final state: cancelled (crash is None), requeued or failed."""
        with self._service.sessions.begin() as session:
            job = session.get(Job, claim.job_id)
            if job is None or job.state != "running" or job.lease != claim.lease:
                return
            if crash is None:
                end_job(session, claim.job_id, "cancelled", message="Cancelled")
            elif job.attempts + 1 < self._service.settings.job_attempts:
                job.attempts += 1
                job.state, job.message = "queued", f"{crash} It will resume from stored results."
            else:
                end_job(session, claim.job_id, "failed", message="Failed", error=crash)

"""Runs the queue: starts one process a job, watches it, stops it when cancelled, picks up after a crash."""

from __future__ import annotations

import asyncio
import logging

from sqlalchemy import update

from server.cluster import Cluster, ClusterError
from server.context import Service
from server.jobs import end_job, next_queued, requeue_interrupted
from server.models import Job, utc_now
from server.processes import start_module, stop
from server.storage import write_atomically

log = logging.getLogger("galewood.jobs")
LOOK_S = 0.4


class Supervisor:
    """The one place that starts job processes. The truth about a job is in the database, never here."""

    def __init__(self, service: Service) -> None:
        self._service = service
        self._cluster = Cluster(service.settings)
        self._watched: dict[str, asyncio.Task[None]] = {}

    async def run(self) -> None:
        """Work until cancelled, then stop every child; unfinished jobs are resumed at the next start."""
        interrupted = await asyncio.to_thread(self._requeue)
        if interrupted:
            log.info("%d interrupted job(s) go on", interrupted)
        try:
            while True:
                await self._start_waiting()
                await self._cluster.close_if_idle(busy=bool(self._watched))
                await self._pause()
        finally:
            for task in self._watched.values():
                task.cancel()
            await asyncio.gather(*self._watched.values(), return_exceptions=True)
            await self._cluster.close()

    def _requeue(self) -> int:
        with self._service.sessions.begin() as session:
            return requeue_interrupted(session)

    async def _pause(self) -> None:
        try:
            async with asyncio.timeout(LOOK_S):
                await self._service.jobs_changed.wait()
        except TimeoutError:
            pass
        self._service.jobs_changed.clear()

    async def _start_waiting(self) -> None:
        self._watched = {job_id: task for job_id, task in self._watched.items() if not task.done()}
        while len(self._watched) < self._service.settings.concurrent_jobs:
            job_id = await asyncio.to_thread(self._claim)
            if job_id is None:
                return
            self._watched[job_id] = asyncio.create_task(self._watch(job_id))

    def _claim(self) -> str | None:
        """Take the job that waited longest; the condition on its state lets several servers share a queue."""
        with self._service.sessions.begin() as session:
            job = next_queued(session)
            if job is None:
                return None
            start = {"state": "running", "stage": "intake", "message": "Starting", "updated_at": utc_now()}
            waiting = update(Job).where(Job.id == job.id, Job.state == "queued")
            return session.scalar(waiting.values(**start).returning(Job.id))

    async def _watch(self, job_id: str) -> None:
        try:
            address = await self._cluster.address()
        except ClusterError as error:
            await asyncio.to_thread(self._settle, job_id, str(error))
            return
        environment = self._service.settings.environment()
        process = await start_module(
            self._service.settings.job_module, job_id, address, environment=environment
        )
        try:
            cancelled = await self._wait(process, job_id)
        finally:
            await stop(process)
        code = process.returncode
        reason = None if cancelled else f"The process that computed this tree ended with code {code}."
        await asyncio.to_thread(self._settle, job_id, reason)

    async def _wait(self, process: asyncio.subprocess.Process, job_id: str) -> bool:
        """Until the process or its cluster ends (False), or the job is cancelled or deleted (True)."""
        while process.returncode is None and not self._cluster.lost:
            try:
                async with asyncio.timeout(LOOK_S):
                    await process.wait()
            except TimeoutError:
                if await asyncio.to_thread(self._must_stop, job_id):
                    flag = self._service.settings.cancel_flag(job_id)
                    await asyncio.to_thread(write_atomically, flag, b"")
                    return True
        return False

    def _must_stop(self, job_id: str) -> bool:
        with self._service.sessions() as session:
            job = session.get(Job, job_id)
            return job is None or job.cancel_requested

    def _settle(self, job_id: str, crash: str | None) -> None:
        """A job whose process is gone and that has no last state was cancelled (crash None), or crashed."""
        with self._service.sessions.begin() as session:
            job = session.get(Job, job_id)
            if job is None or job.state != "running":
                return
            if crash is None:
                end_job(session, job_id, "cancelled", message="Cancelled")
            elif job.attempts + 1 < self._service.settings.job_attempts:
                job.attempts += 1
                job.state, job.message = "queued", "Interrupted; goes on from what was stored"
            else:
                end_job(session, job_id, "failed", message="Failed", error=crash)

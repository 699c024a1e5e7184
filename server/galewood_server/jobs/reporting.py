"""A job process's only way to the database while it works: progress out, "stop" in."""

from __future__ import annotations

import time
from dataclasses import dataclass
from typing import Any

from galewood.util import Cancelled
from sqlalchemy import select, update
from sqlalchemy.orm import Session

from galewood_server.jobs.queue import end_job
from galewood_server.storage import Job, Sessions

REPORT_S = 0.25
LEAST_DONE = 0.03
"""Share of the work after which its pace is worth telling."""


class JobFailedError(Exception):
    """A job cannot be done; the words are for whoever asked for it."""


@dataclass(frozen=True)
class JobLease:
    """The job that this process may work on, and the word that says so (leases.py)."""

    sessions: Sessions
    job_id: str
    lease: str

    def check(self, session: Session) -> None:
        """Raises Cancelled if the job is to be cancelled, was deleted, or is another server's by now."""
        mine = select(Job.cancel_requested).where(Job.id == self.job_id, Job.lease == self.lease)
        if session.scalar(mine) is not False:
            raise Cancelled

    def write(self, **values: Any) -> None:
        """Set columns of the job. Raises Cancelled."""
        with self.sessions.begin() as session:
            self.check(session)
            ours = update(Job).where(Job.id == self.job_id, Job.lease == self.lease)
            session.execute(ours.values(**values))

    def end(self, state: str, message: str, error: str | None = None) -> None:
        """Give the job its last state, if it is still ours."""
        with self.sessions.begin() as session:
            end_job(session, self.job_id, state, message=message, error=error, lease=self.lease)


class Reporter:
    """Writes progress a few times a second; stops the work on a job that is to be cancelled."""

    def __init__(self, job_lease: JobLease) -> None:
        self._job_lease = job_lease
        # time and fraction of the first report: a resumed job leaps
        self._began: tuple[float, float] | None = None
        self._written: tuple[float, str] = (-1.0, "")
        self._samples: tuple[int, int] | None = None

    def samples(self, done: int, total: int) -> None:
        """How many of the sampled runs there are by now; told with the next report."""
        self._samples = (done, total)

    def report(self, stage: str, fraction: float, message: str) -> None:
        """Raises Cancelled."""
        now_s = time.monotonic()
        if now_s - self._written[0] < REPORT_S and stage == self._written[1]:
            return
        self._written = (now_s, stage)
        values: dict[str, Any] = {"stage": stage, "fraction": fraction, "message": message}
        if self._samples:
            values["samples_done"], values["samples_total"] = self._samples
        self._job_lease.write(**values, seconds_left=self._seconds_left(now_s, fraction))

    def _seconds_left(self, now_s: float, fraction: float) -> float | None:
        if self._began is None:
            self._began = (now_s, fraction)
        spent_s, done = now_s - self._began[0], fraction - self._began[1]
        return spent_s / done * (1 - fraction) if done > LEAST_DONE else None

"""Database access of a running job process: the job lease and progress reports."""

from __future__ import annotations

import time
from dataclasses import dataclass, field
from typing import Any

from galewood.constants import STAGES_AFTER_TABLE
from galewood.util import Cancelled
from sqlalchemy import select, update
from sqlalchemy.orm import Session

from galewood_server.jobs.leases import is_awaited, put_back
from galewood_server.jobs.queue import end_job
from galewood_server.storage import Job, Sessions

REPORT_S = 0.25
USUAL_S = 60.0
"""Usual duration of the work, s: measured builds of the shipped trees took 25 to 65 s to their tables."""
USUAL_WEIGHT = 0.15
"""Fraction of the work, done at the usual speed, as which `USUAL_S` counts beside the observed speed."""


class Yielded(Exception):
    """Other jobs come before the rest of this one."""


class JobFailedError(Exception):
    """A job failed; the message is shown to the user."""


@dataclass(frozen=True)
class JobLease:
    """A claimed job and the token of its lease (leases.py)."""

    sessions: Sessions
    job_id: str
    lease: str

    def check(self, session: Session) -> None:
        """Raise Cancelled if the job was cancelled or deleted, or if another server has claimed it."""
        query = select(Job.cancel_requested).where(Job.id == self.job_id, Job.lease == self.lease)
        if session.scalar(query) is not False:
            raise Cancelled

    def yield_to_others(self) -> None:
        """Raise Yielded if another tree waits for its table."""
        with self.sessions() as session:
            if is_awaited(session, self.job_id, self.lease):
                raise Yielded

    def put_back(self) -> None:
        """Queue the job again, behind those that it yields to."""
        with self.sessions.begin() as session:
            put_back(session, self.job_id, self.lease)

    def reached(self) -> Reached:
        """How far an earlier process of this job has come. Raises Cancelled."""
        with self.sessions() as session:
            self.check(session)
            job = session.get_one(Job, self.job_id)
            return Reached.of(job.stage, job.fraction)

    def write(self, **values: Any) -> None:
        """Update columns of the job. Raises Cancelled."""
        with self.sessions.begin() as session:
            self.check(session)
            statement = update(Job).where(Job.id == self.job_id, Job.lease == self.lease)
            session.execute(statement.values(**values))

    def end(self, state: str, message: str, error: str | None = None) -> None:
        """Set the final state of the job if the lease is still valid."""
        with self.sessions.begin() as session:
            end_job(session, self.job_id, state, message=message, error=error, lease=self.lease)


@dataclass(frozen=True, order=True)
class Reached:
    """How far a job has come. The stages after a build's table count from 0 again."""

    part: int
    fraction: float
    stage: str = field(compare=False)

    @classmethod
    def of(cls, stage: str, fraction: float) -> Reached:
        """What a report says."""
        return cls(STAGES_AFTER_TABLE.index(stage) + 1 if stage in STAGES_AFTER_TABLE else 0, fraction, stage)


class ProgressReporter:
    """Writes progress to the database at most every REPORT_S and raises Cancelled for cancelled jobs.

    Progress never decreases: a job that resumes after a restart passes through its first stages again, which
    takes little, and shows what it had reached until then.
    """

    def __init__(self, job_lease: JobLease) -> None:
        self._job_lease = job_lease
        # time and fraction of the first report, because a resumed job does not start at 0
        self._began: tuple[float, float] | None = None
        self._last_report: tuple[float, str] = (-1.0, "")
        self._last_fraction = 0.0
        self._samples: tuple[int, int] | None = None
        self._reached: Reached | None = None

    def set_samples(self, done: int, total: int) -> None:
        """Set the number of finished training runs; written with the next report."""
        self._samples = (done, total)

    def report(self, stage: str, fraction: float, message: str) -> None:
        """Report the stage, fraction in [0, 1] and message. Raises Cancelled."""
        now_s = time.monotonic()
        if now_s - self._last_report[0] < REPORT_S and stage == self._last_report[1]:
            return
        if fraction < self._last_fraction:  # the stages after the table count from 0 again
            self._began = None
        self._last_report, self._last_fraction = (now_s, stage), fraction
        values = self._shown(Reached.of(stage, fraction), message)
        if self._samples:
            values["samples_done"], values["samples_total"] = self._samples
        self._job_lease.write(**values, seconds_left=self._seconds_left(now_s, fraction))

    def _shown(self, now: Reached, message: str) -> dict[str, Any]:
        """The columns for a report: those of the present stage, or what an earlier process had reached."""
        best = self._reached or self._job_lease.reached()
        self._reached = max(best, now)
        if now < best:
            return {"stage": best.stage, "fraction": best.fraction, "message": f"Resuming: {message}"}
        return {"stage": now.stage, "fraction": now.fraction, "message": message}

    def _seconds_left(self, now_s: float, fraction: float) -> float:
        if self._began is None:
            self._began = (now_s, fraction)
        spent_s, done = now_s - self._began[0], fraction - self._began[1]
        return seconds_left(spent_s, done, fraction)


def seconds_left(spent_s: float, done: float, fraction: float) -> float:
    """Estimate of the remaining time, s, if `done` of the work took `spent_s` and `fraction` of all is done.

    The observed duration per unit of work is averaged with the usual one, so that the first, short stages do
    not decide: their shares of the whole differ most between trees and machines.
    """
    whole_s = (USUAL_WEIGHT * USUAL_S + spent_s) / (USUAL_WEIGHT + done)
    return whole_s * (1 - fraction)

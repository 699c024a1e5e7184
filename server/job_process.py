"""One build in a process of its own: `python -m server.job_process JOB_ID SCHEDULER_ADDRESS`."""

from __future__ import annotations

import logging
import os
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from sqlalchemy import update

from precompute.build_types import BuildOptions, BuildResult, Cancelled, Progress
from precompute.intake_types import IntakeError, IntakeOptions
from server.database import Sessions, open_database
from server.engine import NICENESS, EngineLostError
from server.jobs import end_job
from server.models import Job, Tree, utc_now
from server.processes import die_with_parent
from server.runner import DaskRunner
from server.settings import Settings
from server.species import fingerprint
from server.storage import Stores

log = logging.getLogger("galewood.job")
REPORT_S = 0.25
TRY_AGAIN = 75  # EX_TEMPFAIL: the supervisor queues the job again

Build = Callable[..., BuildResult]


class Reporter:
    """Writes progress to the database a few times a second; stops the build of a job to be cancelled."""

    def __init__(self, sessions: Sessions, job_id: str) -> None:
        self._sessions = sessions
        self._job_id = job_id
        # time and fraction of the first report: a resumed job leaps
        self._began: tuple[float, float] | None = None
        self._written: tuple[float, str] = (-1.0, "")

    def __call__(self, progress: Progress) -> None:
        """Raises Cancelled."""
        now_s = time.monotonic()
        if now_s - self._written[0] < REPORT_S and progress.stage == self._written[1]:
            return
        self._written = (now_s, progress.stage)
        left_s = self._seconds_left(now_s, progress.fraction)
        with self._sessions.begin() as session:
            job = session.get(Job, self._job_id)
            if job is None or job.cancel_requested:
                raise Cancelled
            job.stage, job.fraction, job.message = progress.stage, progress.fraction, progress.message
            job.seconds_left = left_s

    def _seconds_left(self, now_s: float, fraction: float) -> float | None:
        if self._began is None:
            self._began = (now_s, fraction)
        spent_s, done = now_s - self._began[0], fraction - self._began[1]
        return spent_s / done * (1 - fraction) if done > 0.03 else None


@dataclass(frozen=True)
class Order:
    """What is to be built, as it was when the job began."""

    source: bytes
    filename: str
    options: BuildOptions
    fingerprint: str


def read_order(sessions: Sessions, stores: Stores, job_id: str) -> Order:
    """The order of a job: its tree's mesh and options, overruled by the job's own settings."""
    with sessions() as session:
        job = session.get_one(Job, job_id)
        tree = job.tree
        return Order(
            source=stores.sources.get(tree.source_sha256),
            filename=tree.filename,
            options=build_options({**tree.options, **job.settings}),
            fingerprint=fingerprint(tree.source_sha256, tree.options, job.settings),
        )


def build_options(given: dict[str, Any]) -> BuildOptions:
    """The options of a build from names and values."""
    intake = {key: given[key] for key in ("species", "height_m", "up_axis") if key in given}
    rest = {key: value for key, value in given.items() if key not in intake}
    return BuildOptions(intake=IntakeOptions(**intake), **rest)


def run_job(job_id: str, address: str, settings: Settings, build: Build) -> None:
    """Compute the table of a job's tree and publish it; every failure becomes the job's last state."""
    sessions, stores = open_database(settings.database), Stores(settings.data_dir)
    try:
        order = read_order(sessions, stores, job_id)
        runner = DaskRunner(address, settings.cancel_flag(job_id))
        reporter = Reporter(sessions, job_id)
        result = build(order.source, order.filename, order.options, runner, reporter, settings.cache_dir)
        _publish(sessions, stores, job_id, order, result)
    except Cancelled:
        _end(sessions, job_id, "cancelled", "Cancelled")
    except EngineLostError:
        log.warning("job %s lost its cluster", job_id)
        sys.exit(TRY_AGAIN)
    except IntakeError as error:
        _end(sessions, job_id, "failed", "Failed", f"{error.title} {error.hint}".strip())
    except Exception as error:
        log.exception("job %s failed", job_id)
        text = f"The computation failed ({type(error).__name__}); the cause is in the server's log."
        _end(sessions, job_id, "failed", "Failed", text)


def _publish(sessions: Sessions, stores: Stores, job_id: str, order: Order, result: BuildResult) -> None:
    """The files first, then, in one transaction, the tree that names them and the job's end."""
    tree = {
        "table_sha256": stores.tables.put(result.table),
        "mesh_sha256": stores.meshes.put(result.render_glb),
        "report": result.report,
        "fingerprint": order.fingerprint,
        "updated_at": utc_now(),
    }
    with sessions.begin() as session:
        if not end_job(session, job_id, "done", message="Done"):
            return
        session.execute(update(Job).where(Job.id == job_id).values(stage="done", fraction=1.0))
        tree_id = session.get_one(Job, job_id).tree_id
        session.execute(update(Tree).where(Tree.id == tree_id).values(**tree))


def _end(sessions: Sessions, job_id: str, state: str, message: str, error: str | None = None) -> None:
    with sessions.begin() as session:
        end_job(session, job_id, state, message=message, error=error)


def main(build: Build) -> None:
    """Read the arguments and work, gently, until done or until the server is gone."""
    logging.basicConfig(level=logging.INFO, format="%(levelname)s %(name)s: %(message)s")
    die_with_parent()
    os.nice(NICENESS)
    run_job(sys.argv[1], sys.argv[2], Settings(), build)


if __name__ == "__main__":
    from precompute.pipeline import build_table

    main(build_table)

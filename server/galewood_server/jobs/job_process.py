"""Child process that runs one job.

`python -m galewood_server.jobs.job_process JOB_ID LEASE`; the parent writes the address of the cluster, as a
line, to standard input when the cluster runs.
"""

from __future__ import annotations

import logging
import sys
import threading
from collections.abc import Callable
from functools import cache

from galewood.util import Cancelled, MeshError

from galewood_server.jobs.build_job import Build, run_build
from galewood_server.jobs.cluster.dask_cluster import EngineLostError
from galewood_server.jobs.progress import JobFailedError, JobLease, Yielded
from galewood_server.settings import Settings
from galewood_server.storage import Job, JobKind, Sessions, Stores, open_database

log = logging.getLogger("galewood.job")
Analysis = Callable[[JobLease, JobKind, Settings, Stores], None]
EXIT_TRY_AGAIN = 75  # EX_TEMPFAIL: the supervisor queues the job again


def run_job(
    job_lease: JobLease,
    address: Callable[[], str],
    settings: Settings,
    build: Build,
    analysis: Analysis | None = None,
) -> None:
    """Run a job; every failure is stored as its final state."""
    job_id = job_lease.job_id
    try:
        _work(job_lease, address, settings, build, analysis)
    except Cancelled:
        job_lease.end("cancelled", "Cancelled")
    except Yielded:
        job_lease.put_back()
    except EngineLostError:
        log.warning("job %s lost the connection to its cluster", job_id)
        sys.exit(EXIT_TRY_AGAIN)
    except MeshError as error:
        job_lease.end("failed", "Failed", f"{error.title} {error.hint}".strip())
    except JobFailedError as error:
        log.warning("job %s failed: %s", job_id, error.__cause__ or error)
        job_lease.end("failed", "Failed", str(error))
    except Exception as error:
        log.exception("job %s failed", job_id)
        text = f"The computation failed ({type(error).__name__}). The server log has the details."
        job_lease.end("failed", "Failed", text)


def _work(
    job_lease: JobLease,
    address: Callable[[], str],
    settings: Settings,
    build: Build,
    analysis: Analysis | None,
) -> None:
    stores = Stores(settings.data_dir, settings.store_url)
    kind = _kind(job_lease.sessions, job_lease.job_id)
    if kind == "build":
        run_build(job_lease, address, settings, stores, build)
    elif kind == "individual":
        from galewood_server.jobs.individual_job import run_individual

        run_individual(job_lease, settings, stores)
    elif analysis:
        analysis(job_lease, kind, settings, stores)
    else:
        from galewood_server.jobs.analyses.analysis_job import run_analysis

        run_analysis(job_lease, kind, settings, stores)


def _kind(sessions: Sessions, job_id: str) -> JobKind:
    with sessions() as session:
        job = session.get(Job, job_id)
        if job is None:
            raise Cancelled
        return job.kind


def _address_of_cluster() -> Callable[[], str]:
    """A function that waits for the line on standard input. It raises EngineLostError if there is none."""
    reading = threading.Lock()

    @cache
    def line() -> str:
        return sys.stdin.readline().strip()

    def address() -> str:
        with reading:
            if not line():
                raise EngineLostError("the server sent no cluster address")
            return line()

    return address


def main(build: Build, analysis: Analysis | None = None) -> None:
    """Run the job given on the command line. Tests pass `analysis`."""
    logging.basicConfig(level=logging.INFO, format="%(levelname)s %(name)s: %(message)s")
    job_id, lease = sys.argv[1:3]
    settings = Settings()
    job_lease = JobLease(open_database(settings.database), job_id, lease)
    run_job(job_lease, _address_of_cluster(), settings, build, analysis)


if __name__ == "__main__":
    from galewood.pipeline.stages import build_table

    main(build_table)

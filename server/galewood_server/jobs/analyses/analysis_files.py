"""Storing the result of an analysis job: its files first, then the row that references them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

from galewood_server.jobs.progress import JobLease
from galewood_server.jobs.queue import end_job
from galewood_server.storage import Stores, mark_garbage, store_referenced

PLOT_FILE = "errors.png"


def store_result(
    job_lease: JobLease,
    stores: Stores,
    result: dict[str, Any],
    report: bytes,
    pictures: Mapping[str, bytes] | None = None,
) -> None:
    """Store the report and plots and set the job to done if the lease is still valid. Raises Cancelled."""
    plots = dict(pictures or {})
    references: dict[str, Any] = {"result_sha256": _store(job_lease, stores, "results", report)}
    references["pictures"] = {
        name: _store(job_lease, stores, "pictures", plot) for name, plot in plots.items()
    }
    done: dict[str, Any] = {"stage": "done", "fraction": 1.0, "result": result, **references}
    with job_lease.sessions.begin() as session:
        if end_job(session, job_lease.job_id, "done", message="Done", lease=job_lease.lease, **done):
            store_referenced(session, stores, "results", report)
            for plot in plots.values():
                store_referenced(session, stores, "pictures", plot)


def _store(job_lease: JobLease, stores: Stores, kind: str, data: bytes) -> str:
    """Store a file and return its hash. Raises Cancelled.

    The file is marked as garbage until the job references it, so that garbage collection removes it if the
    job is cancelled or its process dies.
    """
    with job_lease.sessions.begin() as session:
        job_lease.check(session)
        mark_garbage(session, kind, hashlib.sha256(data).hexdigest())
    return stores.named(kind).put(data)

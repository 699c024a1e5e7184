"""How a study's job process ends: its files first, then the row that names them."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from typing import Any

from galewood_server.jobs.queue import end_job
from galewood_server.jobs.reporting import JobLease
from galewood_server.storage import Stores, hold, mark_garbage

PLOT = "errors.png"


def finish(
    job_lease: JobLease,
    stores: Stores,
    result: dict[str, Any],
    report: bytes,
    pictures: Mapping[str, bytes] | None = None,
) -> None:
    """Store what was found and give the job its last state, if it is still ours. Raises Cancelled."""
    plots = dict(pictures or {})
    named: dict[str, Any] = {"result_sha256": _keep(job_lease, stores, "results", report)}
    named["pictures"] = {name: _keep(job_lease, stores, "pictures", plot) for name, plot in plots.items()}
    done: dict[str, Any] = {"stage": "done", "fraction": 1.0, "result": result, **named}
    with job_lease.sessions.begin() as session:
        if end_job(session, job_lease.job_id, "done", message="Done", lease=job_lease.lease, **done):
            hold(session, stores, "results", report)
            for plot in plots.values():
                hold(session, stores, "pictures", plot)


def _keep(job_lease: JobLease, stores: Stores, kind: str, data: bytes) -> str:
    """Store a file under its hash and return that. It counts as retired until the job names it: should the
    job be cancelled or its process die right now, the sweep takes the file away.
    """
    with job_lease.sessions.begin() as session:
        job_lease.check(session)
        mark_garbage(session, kind, hashlib.sha256(data).hexdigest())
    return stores.named(kind).put(data)

"""How a study's job process ends: its files first, then the row that names them."""

from __future__ import annotations

import hashlib
from typing import Any

from server.jobs import end_job
from server.reporting import Mandate
from server.retired import retire
from server.storage import Stores

PLOT = "errors.png"


def keep(mandate: Mandate, stores: Stores, kind: str, data: bytes) -> str:
    """Store a file under its hash. It counts as retired until the job names it: should the job be cancelled
    or its process die right now, the sweep takes the file away.
    """
    with mandate.sessions.begin() as session:
        mandate.check(session)
        retire(session, kind, hashlib.sha256(data).hexdigest())
    return stores.named(kind).put(data)


def finish(mandate: Mandate, **values: Any) -> None:
    """The job's last state and what it found, if it is still ours."""
    done: dict[str, Any] = {"stage": "done", "fraction": 1.0, **values}
    with mandate.sessions.begin() as session:
        end_job(session, mandate.job_id, "done", message="Done", lease=mandate.lease, **done)

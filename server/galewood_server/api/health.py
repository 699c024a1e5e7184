"""Liveness and readiness checks."""

from __future__ import annotations

import shutil
import sqlite3
from contextlib import closing
from importlib.metadata import version

from fastapi import APIRouter, Response
from galewood.constants import TABLE_VERSION, WIRE_VERSION
from sqlalchemy import func, select
from sqlalchemy.exc import SQLAlchemyError

from galewood_server.context import Service, ServiceDep
from galewood_server.http import Health, Liveness, Readiness
from galewood_server.storage import ACTIVE_STATES, Job, Tree

router = APIRouter(tags=["service"])
VERSION = version("galewood")
LOCK_S = 1.0
"""How long the readiness check waits for SQLite's lock."""


@router.get("/healthz")
def healthz(service: ServiceDep) -> Health:
    """Service status with the number of trees, active jobs and open sockets."""
    with service.sessions() as session:
        return Health(
            status="ok",
            version=VERSION,
            trees=session.scalar(select(func.count(Tree.id))) or 0,
            ready=session.scalar(select(func.count(Tree.id)).where(Tree.table_sha256.is_not(None))) or 0,
            jobs_active=session.scalar(select(func.count(Job.id)).where(Job.state.in_(ACTIVE_STATES))) or 0,
            sockets=service.sockets,
        )


@router.get("/api/health")
def live() -> Liveness:
    """Liveness: the process responds. No other component is checked; on failure, restart the process."""
    return Liveness(status="ok", version=VERSION, table_version=TABLE_VERSION, wire_version=WIRE_VERSION)


@router.get(
    "/api/health/ready", responses={503: {"model": Readiness, "description": "The service is not ready."}}
)
def ready(service: ServiceDep, response: Response) -> Readiness:
    """Readiness: checks of database, data folder and page. 503: route requests elsewhere."""
    checks = {
        "database": _database(service),
        "storage": _storage(service),
        "page": (service.settings.page_dir / "index.html").is_file(),
    }
    ok = checks["database"] and checks["storage"]
    response.status_code = 200 if ok else 503
    return Readiness(status="ok" if ok else "unable", version=VERSION, checks=checks)


def _database(service: Service) -> bool:
    """Whether the database answers and can be written, not only read."""
    try:
        with service.sessions() as session:
            session.execute(select(1))
            bind = session.get_bind()
        path = bind.engine.url.database if bind.dialect.name == "sqlite" else None
        return path is None or _is_writable(path)
    except (SQLAlchemyError, sqlite3.Error):
        return False


def _is_writable(path: str) -> bool:
    """Whether a write transaction begins soon: others may hold SQLite's lock. sqlite3.Error if not."""
    with closing(sqlite3.connect(path, timeout=LOCK_S, isolation_level=None)) as connection:
        connection.execute("BEGIN IMMEDIATE")
        connection.execute("ROLLBACK")
    return True


def _storage(service: Service) -> bool:
    try:
        return shutil.disk_usage(service.settings.data_dir).free > service.settings.free_bytes
    except OSError:
        return False

"""Files that nothing names any more: removed after a while, as somebody may just be fetching them."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Mapping
from datetime import timedelta
from pathlib import Path

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from galewood_server.storage.database import Sessions, database_now
from galewood_server.storage.models import ACTIVE, Garbage, Job, JobKind, Tree
from galewood_server.storage.stores import Stores

FIELDS = {
    "sources": "source_sha256",
    "meshes": "mesh_sha256",
    "tables": "table_sha256",
    "models": "model_sha256",
}
KEPT_ANALYSES = 12
ASKED = ("table_sha256", "model_sha256", "mesh_sha256")


def mark_garbage(session: Session, kind: str, sha256: str | None) -> None:
    """Say that a file lost a user; whether it has others is asked when its time has come."""
    if sha256:
        session.add(Garbage(kind=kind, sha256=sha256, garbage_since=database_now(session)))


def hold(session: Session, stores: Stores, kind: str, data: bytes) -> str:
    """In the transaction that names a file: keep it from the sweep, and store it again should the sweep have
    just taken it. Its hash. What is large is better stored before as well, so that the transaction is short.
    """
    sha256 = hashlib.sha256(data).hexdigest()
    # waits for a sweep that has this file in hand, and makes the next one wait for us
    session.execute(delete(Garbage).where(Garbage.kind == kind, Garbage.sha256 == sha256))
    return stores.named(kind).put(data)


def mark_replaced(session: Session, tree: Tree, files: Mapping[str, str | None]) -> None:
    """Before a tree gets other files, by field: those that it has now and loses."""
    for kind, field in FIELDS.items():
        if field in files and getattr(tree, field) != files[field]:
            mark_garbage(session, kind, getattr(tree, field))


def mark_tree_files(session: Session, tree: Tree) -> None:
    """Before a tree is deleted: its files, and those of its jobs."""
    for kind, field in FIELDS.items():
        mark_garbage(session, kind, getattr(tree, field))
    for job in tree.jobs:
        _mark_job_files(session, job)


def forget_old_analyses(session: Session, tree: Tree, kind: JobKind) -> None:
    """Of a tree's ended studies of a kind the newest stay."""
    ended = [job for job in tree.jobs if job.kind == kind and job.state not in ACTIVE]
    for job in ended[:-KEPT_ANALYSES]:
        _mark_job_files(session, job)
        tree.jobs.remove(job)


def _mark_job_files(session: Session, job: Job) -> None:
    mark_garbage(session, "results", job.result_sha256)
    for sha256 in job.pictures.values():
        mark_garbage(session, "pictures", sha256)


def referenced(session: Session) -> dict[str, set[str]]:
    """Kind → the hashes of all files that trees and jobs name."""
    named: dict[str, set[str]] = {kind: set() for kind in (*FIELDS, "pictures", "results")}
    for kind, field in FIELDS.items():
        named[kind] |= set(filter(None, session.scalars(select(getattr(Tree, field)))))
    named["results"] |= set(filter(None, session.scalars(select(Job.result_sha256))))
    for pictures in session.scalars(select(Job.pictures)):
        named["pictures"] |= set(pictures.values())
    return named


def in_work(session: Session) -> set[str]:
    """Hashes of the tables, models and meshes that studies under way were asked about."""
    asked = session.scalars(select(Job.settings).where(Job.state.in_(ACTIVE), Job.kind != "build")).all()
    return {str(one[field]) for one in asked for field in ASKED if field in one}


def collect_garbage(sessions: Sessions, stores: Stores, grace_s: float) -> int:
    """Remove files that were retired so long ago and that nothing names. How many."""
    with sessions.begin() as session:
        old = database_now(session) - timedelta(seconds=grace_s)
        # their rows first: whoever is about to name one of these files (`hold`) now waits until it is gone
        rows = delete(Garbage).where(Garbage.garbage_since < old).returning(Garbage)
        due = {(one.kind, one.sha256): one.garbage_since for one in session.scalars(rows)}
        busy = in_work(session) if due else set()
        named = referenced(session) if due else {}
        unused = [(kind, sha256) for kind, sha256 in due if sha256 not in named[kind]]
        for kind, sha256 in unused:
            if sha256 in busy:
                session.add(Garbage(kind=kind, sha256=sha256, garbage_since=due[kind, sha256]))
            else:
                stores.named(kind).remove(sha256)
    return sum(sha256 not in busy for _kind, sha256 in unused)


def forget_analysis_folders(sessions: Sessions, folder: Path) -> None:
    """Remove what evaluations keep beside while they run, of those that have ended, however they did."""
    kept = [path for path in folder.glob("*") if path.is_dir()]
    if kept:
        with sessions() as session:
            active = set(session.scalars(select(Job.id).where(Job.state.in_(ACTIVE))))
        for path in kept:
            if path.name not in active:
                shutil.rmtree(path, ignore_errors=True)

"""Garbage collection of unreferenced files, after a grace period in which clients may still fetch them."""

from __future__ import annotations

import hashlib
import json
import shutil
from collections.abc import Iterable, Mapping
from datetime import timedelta
from pathlib import Path

from sqlalchemy import delete, select
from sqlalchemy.orm import Session

from galewood_server.storage.database import Sessions, database_now
from galewood_server.storage.files import is_hash
from galewood_server.storage.models import ACTIVE_STATES, TABLE_JOBS, Garbage, Job, JobKind, Tree
from galewood_server.storage.raw_rows import raw_column
from galewood_server.storage.stores import Stores
from galewood_server.storage.tree_files import ANALYSIS_INPUTS, FILE_COLUMNS

KEPT_ANALYSES = 12


def mark_garbage(session: Session, kind: str, sha256: str | None) -> None:
    """Mark a file that lost a reference. Other references are checked when it is collected."""
    if sha256:
        session.add(Garbage(kind=kind, sha256=sha256, garbage_since=database_now(session)))


def store_referenced(session: Session, stores: Stores, kind: str, data: bytes) -> str:
    """Store a file in the transaction that references it and protect it from garbage collection.

    Returns its hash. Large files should also be stored before the transaction, to keep it short.
    """
    sha256 = hashlib.sha256(data).hexdigest()
    # waits for a garbage collection that is removing this file and makes the next one wait
    session.execute(delete(Garbage).where(Garbage.kind == kind, Garbage.sha256 == sha256))
    return stores.named(kind).put(data)


def replace_files(session: Session, tree: Tree, files: Mapping[str, str | None]) -> None:
    """Set the files of a tree and mark those that it loses as garbage; `files`: column -> new hash."""
    for field, kind in FILE_COLUMNS.items():
        if field in files and getattr(tree, field) != files[field]:
            mark_garbage(session, kind, getattr(tree, field))
            setattr(tree, field, files[field])


def mark_tree_files(session: Session, tree_id: str) -> dict[str, str]:
    """Mark the files of a tree that is about to be deleted, and those of its jobs.

    Returns the tree's: column -> hash. Damaged values are skipped, so that a damaged tree can be deleted.
    """
    columns = [raw_column(getattr(Tree, field)) for field in FILE_COLUMNS]
    row = session.execute(select(*columns).where(Tree.id == tree_id)).one()
    files = {field: name for field, name in zip(FILE_COLUMNS, row, strict=True) if _is_name(name)}
    for field, name in files.items():
        mark_garbage(session, FILE_COLUMNS[field], name)
    jobs = select(Job.result_sha256, raw_column(Job.pictures)).where(Job.tree_id == tree_id)
    for result, pictures in session.execute(jobs).tuples().all():
        _mark_files(session, result, picture_hashes(pictures))
    return files


def _is_name(value: object) -> bool:
    return isinstance(value, str) and is_hash(value)


def picture_hashes(stored: object) -> set[str]:
    """The hashes in a job's `pictures` as they are stored; none if these are damaged."""
    try:
        return set(filter(_is_name, json.loads(str(stored)).values()))
    except (ValueError, AttributeError):
        return set()


def forget_old_analyses(session: Session, tree: Tree, kind: JobKind) -> None:
    """Delete all but the newest KEPT_ANALYSES ended analyses of a kind."""
    ended = [job for job in tree.jobs if job.kind == kind and job.state not in ACTIVE_STATES]
    for job in ended[:-KEPT_ANALYSES]:
        _mark_files(session, job.result_sha256, job.pictures.values())
        tree.jobs.remove(job)


def _mark_files(session: Session, result: object, pictures: Iterable[str]) -> None:
    if isinstance(result, str):
        mark_garbage(session, "results", result)
    for sha256 in pictures:
        mark_garbage(session, "pictures", sha256)


def referenced_files(session: Session) -> dict[str, set[str]]:
    """Store name → hashes of all files that trees and jobs reference."""
    names: dict[str, set[str]] = {kind: set() for kind in (*FILE_COLUMNS.values(), "pictures", "results")}
    for field, kind in FILE_COLUMNS.items():
        names[kind] |= set(filter(None, session.scalars(select(getattr(Tree, field)))))
    names["results"] |= set(filter(None, session.scalars(select(Job.result_sha256))))
    for pictures in session.scalars(select(raw_column(Job.pictures))):
        names["pictures"] |= picture_hashes(pictures)
    return names


def files_in_use(session: Session) -> set[str]:
    """Hashes of the input files of active analyses."""
    settings = session.scalars(
        select(Job.settings).where(Job.state.in_(ACTIVE_STATES), Job.kind.not_in(TABLE_JOBS))
    ).all()
    return {str(one[field]) for one in settings for field in ANALYSIS_INPUTS if one.get(field)}


def collect_garbage(sessions: Sessions, stores: Stores, grace_s: float) -> int:
    """Remove unreferenced files that were marked at least `grace_s` ago. Returns their number."""
    with sessions.begin() as session:
        old = database_now(session) - timedelta(seconds=grace_s)
        # rows first: a concurrent `store_referenced` of one of these files then waits for this transaction
        rows = delete(Garbage).where(Garbage.garbage_since < old).returning(Garbage)
        expired = {(one.kind, one.sha256): one.garbage_since for one in session.scalars(rows)}
        in_use: set[str] = files_in_use(session) if expired else set()
        names = referenced_files(session) if expired else {}
        unused = [(kind, sha256) for kind, sha256 in expired if sha256 not in names[kind]]
        for kind, sha256 in unused:
            if sha256 in in_use:
                session.add(Garbage(kind=kind, sha256=sha256, garbage_since=expired[kind, sha256]))
            else:
                stores.named(kind).remove(sha256)
    return sum(sha256 not in in_use for _kind, sha256 in unused)


def forget_analysis_folders(sessions: Sessions, folder: Path) -> None:
    """Remove the working folders of evaluations that have ended."""
    kept = [path for path in folder.glob("*") if path.is_dir()]
    if kept:
        with sessions() as session:
            active = set(session.scalars(select(Job.id).where(Job.state.in_(ACTIVE_STATES))))
        for path in kept:
            if path.name not in active:
                shutil.rmtree(path, ignore_errors=True)

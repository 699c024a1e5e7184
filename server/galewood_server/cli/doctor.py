"""Consistency checks of the database and the file stores."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from galewood.constants import TABLE_VERSION
from galewood.sandbox import unavailable_restrictions
from galewood.table import TableError, read_metadata
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from galewood_server.access import stored_bytes
from galewood_server.settings import Settings
from galewood_server.storage import (
    ACTIVE_STATES,
    FILE_COLUMNS,
    PREFERRED_CODINGS,
    STORE_NAMES,
    DamagedFileError,
    FileStore,
    Garbage,
    Job,
    Sessions,
    Stores,
    Tree,
    check_revision,
    engine_of,
    file_age_s,
    migration_config,
    open_database,
    readable_rows,
    referenced_files,
    start_failure,
)

YOUNG_S = 3600.0  # a young unreferenced file may belong to a running upload or build
Kind = Literal["missing", "torn", "orphaned", "database", "disk", "jobs", "version", "confinement"]
FAULT_KINDS: tuple[Kind, ...] = ("missing", "torn", "orphaned", "database", "disk")


@dataclass(frozen=True)
class Finding:
    """One finding: a fault or a note."""

    kind: Kind
    what: str
    repaired: bool = False

    @property
    def is_fault(self) -> bool:
        """Whether the finding requires action."""
        return self.kind in FAULT_KINDS and not self.repaired


def run_checks(settings: Settings, *, repair: bool = False) -> list[Finding]:
    """Run all checks. With `repair`, remove corrupt and unreferenced files and clear references to missing
    files, so that tables are computed again. Missing uploads cannot be repaired."""
    found = list(_database(settings))
    if any(finding.is_fault for finding in found):
        return found  # the other checks need the database
    sessions, stores = open_database(settings.database), Stores(settings.data_dir, settings.store_url)
    for kind in STORE_NAMES:
        found += _corrupt(kind, stores.named(kind), repair)
    with sessions.begin() as session:
        found += [*_damaged_rows(session), *_missing(session, stores, repair)]
    found += _orphaned(sessions, stores, repair)
    found += _partial_files(settings, repair)
    with sessions() as session:
        found += [*_jobs(session), *_versions(session, stores)]
    _remove_stale_copies(settings, stores, repair)
    return [*found, *_disk(settings), *(Finding("confinement", line) for line in unavailable_restrictions())]


def _database(settings: Settings) -> Iterator[Finding]:
    """Check that the database is reachable and has the current schema."""
    engine = engine_of(open_database(settings.database))
    head = ScriptDirectory.from_config(migration_config(settings.database)).get_current_head()
    try:
        with engine.connect() as connection:
            current = MigrationContext.configure(connection).get_current_revision()
        check_revision(current)
    except Exception as error:  # every driver error is reported as a finding
        yield Finding(
            "database", start_failure(error, settings) or f"cannot be opened ({type(error).__name__})"
        )
        return
    finally:
        engine.dispose()
    if current != head:
        yield Finding(
            "database",
            f"has schema revision {current}, but {head} is required; starting the server migrates it",
        )


def _corrupt(kind: str, store: FileStore, repair: bool) -> Iterator[Finding]:
    for sha256 in list(store.names()):
        try:
            intact = hashlib.sha256(store.get_from_origin(sha256)).hexdigest() == sha256
        except OSError:
            intact = False
        if not intact:
            if repair:
                store.remove(sha256)
            yield Finding("torn", f"{kind}/{sha256}: its content does not match its hash", repair)


def _damaged_rows(session: Session) -> Iterator[Finding]:
    for kind in (Tree, Job):
        readable_names = {row.id for row in readable_rows(session, kind)}
        for name in sorted(set(session.scalars(select(kind.id))) - readable_names):
            yield Finding(
                "database", f"the record {name!a} of {kind.__tablename__} is damaged: delete its tree"
            )


def _missing(session: Session, stores: Stores, repair: bool) -> Iterator[Finding]:
    for tree in readable_rows(session, Tree):
        for field, kind in FILE_COLUMNS.items():
            sha256 = getattr(tree, field)
            if sha256 and not stores.named(kind).has(sha256):
                repaired = repair and kind != "sources"
                if repaired:
                    _clear_reference(tree, field)
                yield Finding("missing", f"{kind}/{sha256} of the tree {tree.name!r} ({tree.id})", repaired)
    for job in readable_rows(session, Job):
        yield from _missing_of_job(job, stores, repair)


def _clear_reference(tree: Tree, field: str) -> None:
    """Clear a reference; the tree is computed again at the next start or on request.

    Without its records, its bare table or its compliance the tree keeps its table.
    """
    setattr(tree, field, None)
    tree.fingerprint = None
    if field not in ("records_sha256", "bare_table_sha256", "compliance_sha256"):
        tree.table_sha256 = tree.bare_table_sha256 = tree.records_sha256 = tree.compliance_sha256 = None


def _missing_of_job(job: Job, stores: Stores, repair: bool) -> Iterator[Finding]:
    missing = {name: sha256 for name, sha256 in job.pictures.items() if not stores.pictures.has(sha256)}
    for name, sha256 in missing.items():
        yield Finding("missing", f"pictures/{sha256}: {name!r} of the job {job.id}", repair)
    if missing and repair:
        job.pictures = {name: sha256 for name, sha256 in job.pictures.items() if name not in missing}
    if job.result_sha256 and not stores.results.has(job.result_sha256):
        yield Finding("missing", f"results/{job.result_sha256} of the job {job.id}", repair)
        if repair:
            job.result_sha256 = None


def _orphaned(sessions: Sessions, stores: Stores, repair: bool) -> Iterator[Finding]:
    present = {kind: set(stores.named(kind).names()) for kind in STORE_NAMES}
    # query after listing the files, so that newly referenced files are not reported
    with sessions() as session:
        named = referenced_files(session)
        garbage = {(one.kind, one.sha256) for one in session.scalars(select(Garbage))}
    for kind in STORE_NAMES:
        for sha256 in sorted(present[kind] - named.get(kind, set())):
            store = stores.named(kind)
            if (kind, sha256) in garbage or store.age_s(sha256) < YOUNG_S:
                continue
            if repair:
                store.remove(sha256)
            yield Finding("orphaned", f"{kind}/{sha256}: not referenced", repair)


def _partial_files(settings: Settings, repair: bool) -> Iterator[Finding]:
    """Temporary files left by a crash."""
    for path in settings.data_dir.resolve().rglob(".part-*"):
        if file_age_s(path) > YOUNG_S:
            if repair:
                path.unlink(missing_ok=True)
            yield Finding("orphaned", f"{path.name}: an incomplete temporary file", repair)


def _remove_stale_copies(settings: Settings, stores: Stores, repair: bool) -> None:
    """Remove compressed and light copies and thumbnails of files that no longer exist; no findings."""
    if not repair:
        return
    for coding in PREFERRED_CODINGS:
        for path in (settings.cache_dir / "encoded" / coding).rglob("*"):
            used = (stores.tables, stores.records, stores.compliances, stores.meshes)
            if path.is_file() and not any(store.has(path.name) for store in used):
                path.unlink(missing_ok=True)
    light = settings.light_copy("*")
    for path in [*(settings.cache_dir / "thumbnails").glob("*.png"), *light.parent.glob(light.name)]:
        if not stores.meshes.has(path.stem):
            path.unlink(missing_ok=True)


def _jobs(session: Session) -> Iterator[Finding]:
    counted = select(Job.state, func.count()).where(Job.state.in_(ACTIVE_STATES)).group_by(Job.state)
    for state, count in session.execute(counted).tuples():
        yield Finding("jobs", f"{count} {state}; a running server will resume them")


def _versions(session: Session, stores: Stores) -> Iterator[Finding]:
    for tree in readable_rows(session, Tree, Tree.table_sha256.is_not(None)):
        if stores.tables.has(tree.table_sha256 or ""):
            try:
                version = read_metadata(stores.tables.get(tree.table_sha256 or "")).get("version")
            except (TableError, DamagedFileError) as error:
                yield Finding("version", f"the table of {tree.name!r} is unreadable: {error}")
                continue
            if version != TABLE_VERSION:
                text = f"the table of {tree.name!r} has version {version}, this software uses {TABLE_VERSION}"
                yield Finding("version", text)


def _disk(settings: Settings) -> Iterator[Finding]:
    free = shutil.disk_usage(settings.data_dir).free
    if free < settings.free_bytes:
        yield Finding(
            "disk", f"{free >> 20} MB are free, less than the minimum of {settings.free_bytes >> 20} MB"
        )
    stored = stored_bytes(settings)
    if settings.stored_bytes and stored > settings.stored_bytes:
        yield Finding(
            "disk", f"{stored >> 20} MB are stored, more than the quota of {settings.stored_bytes >> 20} MB"
        )

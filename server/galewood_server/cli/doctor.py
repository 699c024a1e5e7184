"""Is all there that the database names, and whole? The stores are held against the rows."""

from __future__ import annotations

import hashlib
import shutil
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

from alembic.migration import MigrationContext
from alembic.script import ScriptDirectory
from galewood.sandbox import missing_here
from galewood.table import VERSION, TableError, read_metadata
from sqlalchemy import func, select
from sqlalchemy.orm import Session

from galewood_server.access import stored_bytes
from galewood_server.settings import Settings
from galewood_server.storage import (
    ACTIVE,
    FIELDS,
    KINDS,
    PREFERRED,
    FileStore,
    Garbage,
    Job,
    Sessions,
    Stores,
    Tree,
    engine_of,
    file_age_s,
    migration_config,
    open_database,
    referenced,
)

YOUNG_S = 3600.0  # a file that nothing names may belong to an upload or a build under way
Kind = Literal["missing", "torn", "orphaned", "database", "disk", "jobs", "version", "confinement"]
FAULTS: tuple[Kind, ...] = ("missing", "torn", "orphaned", "database", "disk")


@dataclass(frozen=True)
class Finding:
    """One thing found; a fault unless it is only worth knowing."""

    kind: Kind
    what: str
    repaired: bool = False

    @property
    def is_fault(self) -> bool:
        """Whether it still needs somebody to do something."""
        return self.kind in FAULTS and not self.repaired


def examine(settings: Settings, *, repair: bool = False) -> list[Finding]:
    """Everything that is not as it should be. With `repair`, files that are torn or that nothing names go,
    and rows let go of files that are gone, so that tables are computed again; uploads cannot be."""
    found = list(_database(settings))
    if any(finding.is_fault for finding in found):
        return found  # without its tables the database says nothing about files
    sessions, stores = open_database(settings.database), Stores(settings.data_dir, settings.store_url)
    for kind in KINDS:
        found += _torn(kind, stores.named(kind), repair)
    with sessions.begin() as session:
        found += _missing(session, stores, repair)
    found += _orphaned(sessions, stores, repair)
    found += _left_parts(settings, repair)
    with sessions() as session:
        found += [*_jobs(session), *_versions(session, stores)]
    _forget_copies(settings, stores, repair)
    return [*found, *_disk(settings), *(Finding("confinement", line) for line in missing_here())]


def _database(settings: Settings) -> Iterator[Finding]:
    """Reachable, and of this software's version."""
    engine = engine_of(open_database(settings.database))
    head = ScriptDirectory.from_config(migration_config(settings.database)).get_current_head()
    try:
        with engine.connect() as connection:
            current = MigrationContext.configure(connection).get_current_revision()
    except Exception as error:  # whatever the driver raises, it is the finding
        yield Finding("database", f"cannot be opened ({type(error).__name__})")
        return
    finally:
        engine.dispose()
    if current != head:
        yield Finding(
            "database", f"is at revision {current}, this software needs {head}; a start migrates it"
        )


def _torn(kind: str, store: FileStore, repair: bool) -> Iterator[Finding]:
    for sha256 in list(store.names()):
        try:
            whole = hashlib.sha256(store.get_anew(sha256)).hexdigest() == sha256
        except OSError:
            whole = False
        if not whole:
            if repair:
                store.remove(sha256)
            yield Finding("torn", f"{kind}/{sha256}: its bytes are not those it is named by", repair)


def _missing(session: Session, stores: Stores, repair: bool) -> Iterator[Finding]:
    for tree in session.scalars(select(Tree)):
        for kind, field in FIELDS.items():
            sha256 = getattr(tree, field)
            if sha256 and not stores.named(kind).has(sha256):
                mended = repair and kind != "sources"
                if mended:
                    _let_go(tree, field)
                yield Finding("missing", f"{kind}/{sha256} of the tree {tree.name!r} ({tree.id})", mended)
    for job in session.scalars(select(Job)):
        yield from _missing_of_job(job, stores, repair)


def _let_go(tree: Tree, field: str) -> None:
    """A tree without its table or model is computed again at the next start, or when it is asked for."""
    setattr(tree, field, None)
    tree.fingerprint = tree.table_sha256 = None


def _missing_of_job(job: Job, stores: Stores, repair: bool) -> Iterator[Finding]:
    gone = {name: sha256 for name, sha256 in job.pictures.items() if not stores.pictures.has(sha256)}
    for name, sha256 in gone.items():
        yield Finding("missing", f"pictures/{sha256}: {name!r} of the job {job.id}", repair)
    if gone and repair:
        job.pictures = {name: sha256 for name, sha256 in job.pictures.items() if name not in gone}
    if job.result_sha256 and not stores.results.has(job.result_sha256):
        yield Finding("missing", f"results/{job.result_sha256} of the job {job.id}", repair)
        if repair:
            job.result_sha256 = None


def _orphaned(sessions: Sessions, stores: Stores, repair: bool) -> Iterator[Finding]:
    present = {kind: set(stores.named(kind).names()) for kind in KINDS}
    # asked after the files were listed: what was named in between is not taken for an orphan
    with sessions() as session:
        named = referenced(session)
        leaving = {(one.kind, one.sha256) for one in session.scalars(select(Garbage))}
    for kind in KINDS:
        for sha256 in sorted(present[kind] - named.get(kind, set())):
            store = stores.named(kind)
            if (kind, sha256) in leaving or store.age_s(sha256) < YOUNG_S:
                continue
            if repair:
                store.remove(sha256)
            yield Finding("orphaned", f"{kind}/{sha256}: nothing names it", repair)


def _left_parts(settings: Settings, repair: bool) -> Iterator[Finding]:
    """What a crash left of a file that was being written."""
    for path in settings.data_dir.resolve().rglob(".part-*"):
        if file_age_s(path) > YOUNG_S:
            if repair:
                path.unlink(missing_ok=True)
            yield Finding("orphaned", f"{path.name}: a file that was never finished", repair)


def _forget_copies(settings: Settings, stores: Stores, repair: bool) -> None:
    """Compressed copies and thumbnails of files that are gone: worth no word, made anew when asked for."""
    if not repair:
        return
    for coding in PREFERRED:
        for path in (settings.cache_dir / "encoded" / coding).rglob("*"):
            if path.is_file() and not (stores.tables.has(path.name) or stores.meshes.has(path.name)):
                path.unlink(missing_ok=True)
    for path in (settings.cache_dir / "thumbnails").glob("*.png"):
        if not stores.meshes.has(path.stem):
            path.unlink(missing_ok=True)


def _jobs(session: Session) -> Iterator[Finding]:
    counted = select(Job.state, func.count()).where(Job.state.in_(ACTIVE)).group_by(Job.state)
    for state, count in session.execute(counted).tuples():
        yield Finding("jobs", f"{count} {state}; a running server carries them on")


def _versions(session: Session, stores: Stores) -> Iterator[Finding]:
    for tree in session.scalars(select(Tree).where(Tree.table_sha256.is_not(None))):
        if stores.tables.has(tree.table_sha256 or ""):
            try:
                version = read_metadata(stores.tables.get(tree.table_sha256 or "")).get("version")
            except TableError as error:
                yield Finding("version", f"the table of {tree.name!r} cannot be read: {error}")
                continue
            if version != VERSION:
                text = f"the table of {tree.name!r} has version {version}, this software plays {VERSION}"
                yield Finding("version", text)


def _disk(settings: Settings) -> Iterator[Finding]:
    free = shutil.disk_usage(settings.data_dir).free
    if free < settings.free_bytes:
        yield Finding("disk", f"{free >> 20} MB are free, less than {settings.free_bytes >> 20} MB")
    stored = stored_bytes(settings)
    if settings.stored_bytes and stored > settings.stored_bytes:
        yield Finding(
            "disk", f"{stored >> 20} MB are stored, over the quota of {settings.stored_bytes >> 20} MB"
        )

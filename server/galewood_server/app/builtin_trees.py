"""Built-in trees: registered at startup; those that are not shipped are computed in the background."""

from __future__ import annotations

import asyncio
import logging
from pathlib import Path

from galewood.pipeline.results import SHIPPED_FOLDER, build_key, read_shipped
from pydantic import BaseModel, TypeAdapter
from sqlalchemy.orm import Session

from galewood_server.app import shipped_trees
from galewood_server.context import Service
from galewood_server.jobs import fingerprint, queue_job
from galewood_server.storage import ACTIVE_STATES, Form, Tree, lock_transaction, readable_rows

log = logging.getLogger("galewood.builtin_trees")
REGISTRATION_LOCK_KEY = 0x67616C66
"""Key of the transactions that register a tree, beside that of the migrations."""


class BuiltinTree(BaseModel):
    """An entry of assets/species/species.json."""

    id: str
    name: str
    file: str
    species: str
    height_m: float
    form: Form = "open"
    credits: str = ""


def read_builtin_trees(folder: Path) -> list[BuiltinTree]:
    """The built-in trees of a folder, smallest mesh first; empty if the folder has no species.json.

    OSError, ValueError (invalid species.json).
    """
    index = folder / "species.json"
    if not index.is_file():
        return []
    entries = TypeAdapter(list[BuiltinTree]).validate_json(index.read_bytes())
    return sorted(entries, key=lambda entry: (folder / entry.file).stat().st_size)


def register(service: Service) -> None:
    """Add the built-in trees to the database, with their shipped tables, and queue builds of other tables."""
    if not service.settings.builtin_trees:
        return
    try:
        for entry in read_builtin_trees(service.settings.species_dir):
            _register(service, entry)
    except (OSError, ValueError):
        log.exception("the built-in trees cannot be read from %s", service.settings.species_dir)


async def queue_outdated_uploads(service: Service) -> None:
    """Queue builds of uploads whose tables are outdated."""
    await asyncio.to_thread(_queue_outdated_uploads, service)
    service.wake_supervisor()


def _queue_outdated_uploads(service: Service) -> None:
    """Queue builds of uploads whose fingerprint has changed, with their last settings.

    Individuals keep their table: whoever asks for one again gets it anew.
    """
    with service.sessions.begin() as session:
        for tree in readable_rows(
            session, Tree, Tree.builtin.is_(False), Tree.grown.is_(False), Tree.fingerprint.is_not(None)
        ):
            done = [job for job in tree.jobs if job.kind == "build" and job.state == "done"]
            settings = done[-1].settings if done else {}
            stale = tree.fingerprint != fingerprint(tree.source_sha256, tree.options, settings)
            # a build that failed with this version is not repeated at every start
            tried = tree.job is not None and (
                tree.job.state in ACTIVE_STATES
                or (tree.job.settings == settings and tree.job.state != "done")
            )
            if stale and not tried:
                queue_job(session, tree, settings)
                log.info("queued %s to be computed again", tree.name)


def _register(service: Service, entry: BuiltinTree) -> None:
    source = (service.settings.species_dir / entry.file).read_bytes()
    source_sha256 = service.stores.sources.put(source)
    with service.sessions.begin() as session:
        lock_transaction(session, REGISTRATION_LOCK_KEY)  # of servers that start together, one adds the tree
        tree = _upsert(session, entry, source_sha256)
        current = fingerprint(source_sha256, tree.options, {})
        if tree.fingerprint == current and tree.table_sha256:
            return
        folder = service.settings.species_dir / SHIPPED_FOLDER
        shipped = read_shipped(folder, entry.id, build_key(source, tree.options))
        if shipped:
            shipped_trees.install(session, service, tree, shipped, current)
            log.info("%s: its table is shipped", entry.name)
        elif tree.job is None or tree.job.state not in ACTIVE_STATES:
            queue_job(session, tree, {})
            log.info("queued %s to be computed", entry.name)


def _upsert(session: Session, entry: BuiltinTree, source_sha256: str) -> Tree:
    tree = session.get(Tree, entry.id)
    if tree is None:
        tree = Tree(id=entry.id, builtin=True)
        session.add(tree)
    tree.name, tree.species, tree.height_m = entry.name, entry.species, entry.height_m
    tree.filename, tree.source_sha256, tree.form = entry.file, source_sha256, entry.form
    tree.options = {"species": entry.species, "height_m": entry.height_m}
    tree.report = tree.report or {"credits": entry.credits}
    session.flush()
    return tree

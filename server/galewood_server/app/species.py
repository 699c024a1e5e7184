"""The species that come with the software: registered at the start, computed in the background."""

from __future__ import annotations

import asyncio
import logging
from pathlib import Path

from pydantic import BaseModel, TypeAdapter
from sqlalchemy import select
from sqlalchemy.orm import Session

from galewood_server.context import Service
from galewood_server.jobs import fingerprint, queue_job
from galewood_server.storage import ACTIVE, Tree

log = logging.getLogger("galewood.species")


class Species(BaseModel):
    """An entry of assets/species/species.json."""

    id: str
    name: str
    file: str
    species: str
    height_m: float
    credits: str = ""


def read_species(folder: Path) -> list[Species]:
    """The species of a folder, the smallest mesh first, as it is ready soonest; none if there is no list."""
    index = folder / "species.json"
    if not index.is_file():
        return []
    entries = TypeAdapter(list[Species]).validate_json(index.read_bytes())
    return sorted(entries, key=lambda entry: (folder / entry.file).stat().st_size)


async def register(service: Service) -> None:
    """Enter the built-in species and queue those whose table is missing or out of date."""
    await asyncio.to_thread(_renew_uploads, service)
    if not service.settings.builtin_species:
        service.wake_supervisor()
        return
    try:
        for entry in await asyncio.to_thread(read_species, service.settings.species_dir):
            await asyncio.to_thread(_register, service, entry)
    except (OSError, ValueError):
        log.exception("the built-in species cannot be read from %s", service.settings.species_dir)
    service.wake_supervisor()


def _renew_uploads(service: Service) -> None:
    """Queue the uploads whose table an older version of the software made: as they were last computed."""
    with service.sessions.begin() as session:
        for tree in session.scalars(
            select(Tree).where(Tree.builtin.is_(False), Tree.fingerprint.is_not(None))
        ):
            done = [job for job in tree.jobs if job.kind == "build" and job.state == "done"]
            settings = done[-1].settings if done else {}
            stale = tree.fingerprint != fingerprint(tree.source_sha256, tree.options, settings)
            # once a version: a mesh that it cannot compute is not tried again at every start
            tried = tree.job is not None and (
                tree.job.state in ACTIVE or (tree.job.settings == settings and tree.job.state != "done")
            )
            if stale and not tried:
                queue_job(session, tree, settings)
                log.info("%s waits to be computed again", tree.name)


def _register(service: Service, entry: Species) -> None:
    source = (service.settings.species_dir / entry.file).read_bytes()
    source_sha256 = service.stores.sources.put(source)
    with service.sessions.begin() as session:
        tree = _enter(session, entry, source_sha256)
        current = fingerprint(source_sha256, tree.options, {})
        busy = tree.job is not None and tree.job.state in ACTIVE
        if not busy and (tree.fingerprint != current or not tree.table_sha256):
            queue_job(session, tree, {})
            log.info("%s waits to be computed", entry.name)


def _enter(session: Session, entry: Species, source_sha256: str) -> Tree:
    tree = session.get(Tree, entry.id)
    if tree is None:
        tree = Tree(id=entry.id, builtin=True)
        session.add(tree)
    tree.name, tree.species, tree.height_m = entry.name, entry.species, entry.height_m
    tree.filename, tree.source_sha256 = entry.file, source_sha256
    tree.options = {"species": entry.species, "height_m": entry.height_m}
    tree.report = tree.report or {"credits": entry.credits}
    session.flush()
    return tree

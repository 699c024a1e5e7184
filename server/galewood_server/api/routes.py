"""All routers in matching order."""

from __future__ import annotations

from fastapi import APIRouter

from galewood_server.api import (
    artefacts,
    comparisons,
    evaluations,
    events,
    health,
    job_pictures,
    jobs,
    metrics,
    revisions,
    socket,
    tables,
    thumbnails,
    trees,
    uploads,
    winds,
    wood_species,
)

ROUTERS: tuple[APIRouter, ...] = tuple(
    module.router
    for module in (
        uploads, trees, revisions, thumbnails, jobs, job_pictures, comparisons, evaluations,
        tables, artefacts, wood_species, winds, events, socket, health, metrics,
    )
)  # fmt: skip

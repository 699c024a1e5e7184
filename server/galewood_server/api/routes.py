"""Every route of the interface, in the order in which they are matched."""

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
    species,
    tables,
    thumbnails,
    trees,
    uploads,
    winds,
)

ROUTERS: tuple[APIRouter, ...] = tuple(
    module.router
    for module in (
        uploads, trees, revisions, thumbnails, jobs, job_pictures, comparisons, evaluations,
        tables, artefacts, species, winds, events, socket, health, metrics,
    )
)  # fmt: skip

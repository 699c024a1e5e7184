"""All routers in matching order."""

from __future__ import annotations

from fastapi import APIRouter

from galewood_server.api import (
    conversions,
    events,
    exports,
    health,
    jobs,
    metrics,
    socket,
    stand_risks,
    tree_strain,
    trees,
    winds,
    wood_species,
)
from galewood_server.api.analyses import comparisons, evaluations
from galewood_server.api.files import artefacts, job_pictures, light_meshes, structures, tables, thumbnails
from galewood_server.api.uploads import individuals, pieces, revisions, upload
from galewood_server.http import with_head_routes

ROUTERS: tuple[APIRouter, ...] = tuple(
    with_head_routes(module.router)
    for module in (
        upload, individuals, trees, revisions, pieces, thumbnails, structures, tree_strain, exports, jobs,
        job_pictures, comparisons, evaluations, tables, artefacts, light_meshes, wood_species, winds,
        conversions, stand_risks, events, socket, health, metrics,
    )
)  # fmt: skip

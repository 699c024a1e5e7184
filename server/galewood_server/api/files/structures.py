"""The tetrahedra and the skeleton of a tree's wood, for display: extracted once and cached."""

from __future__ import annotations

import asyncio
from functools import partial
from pathlib import Path, PurePath
from zipfile import BadZipFile

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse
from galewood.constants import STAGES_AFTER_TABLE
from galewood.util import write_atomically
from pydantic import BaseModel

from galewood_server.api.trees import find_tree
from galewood_server.context import Service, ServiceDep
from galewood_server.http import NOT_MODIFIED, ProblemError, etag_matches, problems
from galewood_server.storage import TABLE_JOBS

router = APIRouter(prefix="/api/trees", tags=["trees"])


class SkeletonOut(BaseModel):
    """Branches of a tree: points, the index of the point that each grows from (−1: the root), radii."""

    points_m: list[tuple[float, float, float]]
    parent: list[int]
    radius_m: list[float]


class StructureOut(BaseModel):
    """What was simulated of a tree: tetrahedra (indices of vertices) and skeleton; tree frame, y up."""

    vertices_m: list[tuple[float, float, float]]
    tets: list[tuple[int, int, int, int]]
    skeleton: SkeletonOut


@router.get(
    "/{tree_id}/structure",
    response_model=StructureOut,
    responses={**NOT_MODIFIED, **problems(404, 503)},
)
async def get_structure(tree_id: str, request: Request, service: ServiceDep) -> Response:
    """The tetrahedra of the wood and its branch skeleton, as they were simulated; they move by the
    displacement of the table's nodes. 404 `no-structure` before the wood is meshed, or if this server has not
    kept the tetrahedra."""
    name = await asyncio.to_thread(_tetrahedra, service, tree_id)
    headers = {"ETag": f'"{name}"', "Cache-Control": "no-cache"}
    target = service.settings.cache_dir / "structures" / f"{name}.json"
    if etag_matches(request.headers.get("if-none-match", ""), headers["ETag"]) and target.is_file():
        return Response(status_code=304, headers=headers)
    kept = service.settings.cache_dir / "tets" / f"{name}.npz"
    await service.pictures.have(target, request, partial(_extract, kept, target))
    return FileResponse(target, media_type="application/json", headers=headers)


def _tetrahedra(service: Service, tree_id: str) -> str:
    """The name, without its ending, of the file of the tetrahedra of a tree. ProblemError 404."""
    with service.sessions() as session:
        tree = find_tree(session, tree_id)
        meshed = [job for job in tree.jobs if job.kind in TABLE_JOBS and job.result]
        complete = [job for job in meshed if job.state == "done" or job.stage in STAGES_AFTER_TABLE]
        # until a build has replaced a complete table, its tetrahedra are not those of the tree
        chosen = complete if tree.state == "ready" else meshed
        if not chosen:
            raise _no_structure()
        return PurePath(str((chosen[-1].result or {})["tetrahedra"])).stem


def _extract(kept: Path, target: Path) -> None:
    """Write the structure of a tree. ProblemError 404 if its tetrahedra are not here; MeshError."""
    from galewood.solid.skeleton import structure_limited  # loads the meshing packages

    try:
        write_atomically(target, structure_limited(kept))
    except (FileNotFoundError, KeyError, ValueError, BadZipFile):
        raise _no_structure() from None


def _no_structure() -> ProblemError:
    return ProblemError(
        404, "no-structure", "The tetrahedra of this tree are not available", hint="Build the tree again."
    )

"""The tetrahedra and the skeleton of a tree's wood, for display: extracted once and cached."""

from __future__ import annotations

import asyncio
import hashlib
import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse
from galewood.util import write_whole
from pydantic import BaseModel

from galewood_server.api.trees import find_tree
from galewood_server.api.uploads import read_mesh
from galewood_server.context import Service, ServiceDep
from galewood_server.http import NOT_MODIFIED, ProblemError, etag_matches, problems

if TYPE_CHECKING:
    from galewood.mesh import TreeMesh

router = APIRouter(prefix="/api/trees", tags=["trees"])
TARGET_TETS = 5500
"""Of a build without other settings (galewood.pipeline.BuildOptions)."""
DIGITS = 4  # of lengths in m


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


@dataclass(frozen=True)
class _Source:
    """The mesh from which a tree was built."""

    sha256: str
    filename: str
    options: dict[str, Any]
    target_tets: int

    @property
    def key(self) -> str:
        parts = json.dumps([self.sha256, self.options, self.target_tets], sort_keys=True)
        return hashlib.sha256(parts.encode()).hexdigest()


@router.get(
    "/{tree_id}/structure",
    response_model=StructureOut,
    responses={**NOT_MODIFIED, **problems(404)},
)
async def get_structure(tree_id: str, request: Request, service: ServiceDep) -> Response:
    """The tetrahedra of the wood and its branch skeleton, as they were simulated; they move by the
    displacement of the table's nodes. 404 `no-structure` before the wood is meshed, or if this server has not
    kept the tetrahedra."""
    source = await asyncio.to_thread(_source, service, tree_id)
    headers = {"ETag": f'"{source.key[:32]}"', "Cache-Control": "no-cache"}
    target = service.settings.cache_dir / "structures" / f"{source.key}.json"
    if etag_matches(request.headers.get("if-none-match", ""), headers["ETag"]) and target.is_file():
        return Response(status_code=304, headers=headers)
    if not target.is_file():
        data = await asyncio.to_thread(service.stores.sources.get, source.sha256)
        mesh, _ = await read_mesh(service, data, source.filename, source.options)
        kept = service.settings.cache_dir / "tets"
        await asyncio.to_thread(_extract, mesh, source.target_tets, kept, target)
    return FileResponse(target, media_type="application/json", headers=headers)


def _source(service: Service, tree_id: str) -> _Source:
    with service.sessions() as session:
        tree = find_tree(session, tree_id)
        built = [job.settings for job in tree.jobs if job.kind == "build" and job.state == "done"]
        target = int(built[-1].get("target_tets") or TARGET_TETS) if built else TARGET_TETS
        return _Source(tree.source_sha256, tree.filename, dict(tree.options), target)


def _extract(mesh: TreeMesh, target_tets: int, kept: Path, target: Path) -> None:
    """Write the structure of a tree. ProblemError 404 if its tetrahedra are not here."""
    from galewood.skeleton import structure_limited  # loads the meshing packages
    from galewood.tets import kept_tetrahedra

    try:
        found = structure_limited(kept_tetrahedra(mesh, target_tets, kept))
    except (FileNotFoundError, KeyError, ValueError):
        raise ProblemError(
            404, "no-structure", "The tetrahedra of this tree are not available", hint="Build the tree again."
        ) from None
    skeleton = {name: found[name].tolist() for name in ("parent",)} | {
        name: found[name].round(DIGITS).tolist() for name in ("points_m", "radius_m")
    }
    structure = {
        "vertices_m": found["vertices_m"].round(DIGITS).tolist(),
        "tets": found["tets"].tolist(),
        "skeleton": skeleton,
    }
    write_whole(target, json.dumps(structure, separators=(",", ":")).encode())

"""Thumbnails of trees, rendered once from the render mesh and cached."""

from __future__ import annotations

import asyncio
from functools import partial
from pathlib import Path

from fastapi import APIRouter, Request, Response
from fastapi.responses import FileResponse
from galewood.util import write_atomically

from galewood_server.api.trees import find_tree
from galewood_server.context import Service, ServiceDep
from galewood_server.http import (
    NOT_MODIFIED,
    ContentVersion,
    ProblemError,
    contents,
    etag_matches,
    problems,
)
from galewood_server.storage import is_hash

router = APIRouter(prefix="/api/trees", tags=["trees"])
PNG_CONTENT = contents("256 × 256 pixels.", "image/png")


@router.get(
    "/{tree_id}/thumbnail",
    response_class=FileResponse,
    responses={**PNG_CONTENT, **NOT_MODIFIED, **problems(404, 503)},
)
async def get_thumbnail(
    tree_id: str, request: Request, service: ServiceDep, _version: ContentVersion = ""
) -> Response:
    """Front view of the tree on a transparent background. It changes with the tree's mesh."""
    sha256 = await asyncio.to_thread(_mesh_of, service, tree_id)
    etag = f'"{sha256}-256"'
    headers = {"ETag": etag, "Cache-Control": "no-cache"}
    if etag_matches(request.headers.get("if-none-match", ""), etag):
        return Response(status_code=304, headers=headers)
    target = service.settings.cache_dir / "thumbnails" / f"{sha256}.png"
    await service.pictures.have(target, request, partial(_draw, service, sha256, target))
    return FileResponse(target, media_type="image/png", headers=headers)


def _mesh_of(service: Service, tree_id: str) -> str:
    with service.sessions() as session:
        sha256 = find_tree(session, tree_id).mesh_sha256 or ""
    if not is_hash(sha256) or not service.stores.meshes.has(sha256):
        raise ProblemError(
            404, "no-such-mesh", "This tree has no mesh yet", hint="Wait until it is computed."
        )
    return sha256


def _draw(service: Service, sha256: str, target: Path) -> None:
    from galewood.pipeline.pictures import draw_limited

    write_atomically(target, draw_limited(service.stores.meshes.get(sha256)))

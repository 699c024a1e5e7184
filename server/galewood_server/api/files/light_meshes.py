"""Light copies of the render meshes of built-in trees and individuals, with pictures that they share."""

from __future__ import annotations

import hashlib
import re

from fastapi import APIRouter, Request
from fastapi.responses import FileResponse, Response
from galewood.pipeline.results import LIGHT_FOLDER, PICTURES_FOLDER, light_mesh

from galewood_server.api.files.artefacts import get_mesh
from galewood_server.context import Service, ServiceDep
from galewood_server.http import (
    IMMUTABLE_CACHE,
    NOT_MODIFIED,
    contents,
    etag_matches,
    not_found,
    problems,
)
from galewood_server.storage import is_hash

router = APIRouter(prefix="/api/light-meshes", tags=["artefacts"])
_PICTURE = re.compile(r"[a-z0-9-]{1,60}\.[0-9a-f]{12}\.webp")


@router.get(
    "/pictures/{file}",
    response_class=FileResponse,
    responses={**contents("The picture.", "image/webp"), **problems(404)},
)
def get_light_picture(file: str, service: ServiceDep) -> Response:
    """A picture of a light mesh, by the name of its content."""
    path = service.settings.species_dir / LIGHT_FOLDER / PICTURES_FOLDER / file
    if not _PICTURE.fullmatch(file) or not path.is_file():
        raise not_found("picture", file)
    return FileResponse(path, media_type="image/webp", headers={"Cache-Control": IMMUTABLE_CACHE})


@router.get(
    "/{sha256}",
    response_class=Response,
    responses={**contents("The file.", "model/gltf-binary"), **NOT_MODIFIED, **problems(400, 404, 416)},
)
def get_light_mesh(sha256: str, request: Request, service: ServiceDep) -> Response:
    """The render mesh of a tree as small as the server has it, with the same vertices in the same order.

    That of a built-in tree, and of an individual on the server that has grown it, is compressed
    (EXT_meshopt_compression, KHR_mesh_quantization), and its pictures (EXT_texture_webp) have addresses
    relative to its own. That of an upload is the render mesh itself.
    """
    content = light_mesh(service.settings.species_dir / LIGHT_FOLDER, sha256) or _grown(service, sha256)
    if content is None:
        return get_mesh(sha256, request, service)
    etag = f'"{hashlib.sha256(content).hexdigest()}"'
    headers = {"ETag": etag, "Cache-Control": "no-cache"}  # another version may compress a mesh differently
    if etag_matches(request.headers.get("if-none-match", ""), etag):
        return Response(status_code=304, headers=headers)
    return Response(content, media_type="model/gltf-binary", headers=headers)


def _grown(service: Service, sha256: str) -> bytes | None:
    """The light copy of the render mesh of an individual; None: this server has none."""
    try:
        return service.settings.light_copy(sha256).read_bytes() if is_hash(sha256) else None
    except OSError:
        return None

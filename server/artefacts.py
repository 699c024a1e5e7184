"""Tables and meshes by their hash: immutable, cacheable for ever, with ranges."""

from __future__ import annotations

from fastapi import APIRouter, Request
from fastapi.responses import FileResponse, Response

from server.context import ServiceHere
from server.errors import not_found
from server.storage import FileStore

router = APIRouter(prefix="/api", tags=["artefacts"])
FOREVER = "public, max-age=31536000, immutable"


@router.get("/tables/{sha256}", response_class=FileResponse)
def get_table(sha256: str, request: Request, service: ServiceHere) -> Response:
    """A table file (docs/formats/table.md)."""
    return _file(request, service.stores.tables, "table", sha256, "application/octet-stream")


@router.get("/meshes/{sha256}", response_class=FileResponse)
def get_mesh(sha256: str, request: Request, service: ServiceHere) -> Response:
    """A tree as it is drawn: GLB whose vertices are in the order of its table."""
    return _file(request, service.stores.meshes, "mesh", sha256, "model/gltf-binary")


def _file(request: Request, store: FileStore, kind: str, sha256: str, media_type: str) -> Response:
    if not store.has(sha256):
        raise not_found(kind, sha256)
    headers = {"ETag": f'"{sha256}"', "Cache-Control": FOREVER}
    if sha256 in request.headers.get("if-none-match", ""):
        return Response(status_code=304, headers=headers)
    return FileResponse(store.path(sha256), media_type=media_type, headers=headers)

"""The pieces of an upload to choose from, and further trees of its file as uploads of their own."""

from __future__ import annotations

import asyncio
from dataclasses import replace

from fastapi import APIRouter, Response

from galewood_server.api.trees import check_from_file, find_tree
from galewood_server.api.uploads.upload import read_mesh, store_tree
from galewood_server.context import Service, ServiceDep
from galewood_server.http import (
    ProblemError,
    TreeChanges,
    TreeOut,
    Upload,
    contents,
    problems,
)

router = APIRouter(prefix="/api/trees", tags=["trees"])
GLB_CONTENT = contents("All pieces as a GLB.", "model/gltf-binary")


@router.post(
    "/{tree_id}/pieces",
    response_class=Response,
    max_body_size=1024,
    responses={**GLB_CONTENT, **problems(403, 404, 413, 422, 503)},
)
async def read_pieces(tree_id: str, service: ServiceDep) -> Response:
    """All pieces of an upload's tree, also those that are left out, to choose from: a GLB with the attribute
    `_PIECE` (docs/how-to/pieces.md). A POST, because it reads the file again."""
    upload = await asyncio.to_thread(_upload, service, tree_id)
    async with service.imports.taken():
        glb = await asyncio.to_thread(_pieces, service, upload)
    return Response(glb, media_type="model/gltf-binary", headers={"Cache-Control": "no-store"})


@router.post(
    "/{tree_id}/copies",
    status_code=201,
    max_body_size=64 * 1024,
    responses={
        200: {"model": TreeOut, "description": "Such a tree already exists."},
        **problems(400, 403, 404, 413, 422, 503, 507),
    },
)
async def copy_tree(tree_id: str, body: TreeChanges, service: ServiceDep, response: Response) -> TreeOut:
    """Import the file of an upload once more as a tree of its own, with other options: another `tree` of a
    file with several, for instance. Options that are missing are those of the upload; null restores the
    default. The file is not sent again, and stored once."""
    upload = await asyncio.to_thread(_upload, service, tree_id)
    options = {**upload.changes.import_options(), **body.model_dump(exclude_unset=True)}
    upload = replace(upload, changes=TreeChanges.model_validate(options))
    read = await read_mesh(service, upload.data, upload.filename, upload.changes)
    tree, new = await asyncio.to_thread(store_tree, service, upload, read)
    response.status_code = 201 if new else 200
    response.headers["Location"] = f"/api/trees/{tree.id}"
    return tree


def _upload(service: Service, tree_id: str) -> Upload:
    """The file of an upload, and its import options. ProblemError 403, 404."""
    with service.sessions() as session:
        tree = find_tree(session, tree_id)
        if tree.builtin:
            hint = "Only the file of an upload can be imported again."
            raise ProblemError(403, "builtin-tree", "This is a built-in tree", hint=hint)
        check_from_file(tree)
        data = service.stores.sources.get(tree.source_sha256)
        return Upload(data, tree.filename, TreeChanges.model_validate(tree.options))


def _pieces(service: Service, upload: Upload) -> bytes:
    from galewood.sandbox import Limits
    from galewood.tree import pieces_sandboxed

    settings = service.settings
    limits = Limits(settings.import_memory_bytes, settings.import_cpu_s, settings.import_wall_s)
    return pieces_sandboxed(upload.data, upload.filename, upload.changes, limits)

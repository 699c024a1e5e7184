"""Mesh upload. Untrusted meshes are parsed in a sandboxed process before anything is stored."""

from __future__ import annotations

import asyncio
import hashlib
import json
from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from fastapi import APIRouter, Request, Response
from galewood.options import ImportRequest
from sqlalchemy.exc import IntegrityError, SQLAlchemyError
from sqlalchemy.orm import Session

from galewood_server.access import check_quota, count_stored
from galewood_server.api.trees import TABLE_COLUMNS, remove_unshared, tree_out
from galewood_server.context import Service, ServiceDep
from galewood_server.http import (
    UPLOAD_FORM,
    ProblemError,
    TreeOut,
    Upload,
    problems,
    read_upload,
)
from galewood_server.jobs import queue_job
from galewood_server.storage import FILE_COLUMNS, Tree, new_id, readable_rows

if TYPE_CHECKING:
    from galewood.pipeline.stages import ReadUpload

router = APIRouter(prefix="/api/trees", tags=["trees"])
READ_COLUMNS = {
    "mesh_sha256": (Tree.mesh_sha256,),
    "import_sha256": (Tree.import_sha256,),
    "beams_sha256": TABLE_COLUMNS,
}
"""Column of a file that an import leaves -> columns of trees that may hold the same file."""


@router.post(
    "",
    status_code=201,
    openapi_extra=UPLOAD_FORM,
    responses={
        200: {
            "model": TreeOut,
            "description": "The same file was uploaded before with the same options.",
        },
        **problems(400, 408, 413, 415, 503, 507),
    },
)
async def upload_tree(
    request: Request, response: Response, service: ServiceDep, build: bool = False
) -> TreeOut:
    """Upload a mesh. The response contains the mesh import report (`report`) and a preview (`mesh_sha256`:
    a GLB whose meshes are named `wood_…` and `leaves_…`). Use PATCH to change the import options, and
    POST /api/jobs or `build=true` to compute the table. If `report.needs_review` is true, `report.questions`
    says what to check first, and `build=true` computes nothing; the option `accept` prevents that. The same
    file with the same options is one tree."""
    upload = await _receive(request, service)
    tree = await asyncio.to_thread(_find, service, upload)
    if tree is None:
        read = await read_mesh(service, upload.data, upload.filename, upload.changes)
        tree, new = await asyncio.to_thread(store_tree, service, upload, read)
    else:
        new = False
    response.status_code = 201 if new else 200
    response.headers["Location"] = f"/api/trees/{tree.id}"
    build = build and new and not tree.report.get("needs_review")
    return await asyncio.to_thread(_queue_build, service, tree) if build else tree


async def read_mesh(service: Service, data: bytes, filename: str, options: ImportRequest) -> ReadUpload:
    """Import a mesh in a sandboxed process; few at once.

    MeshError; ProblemError 503 if too many wait.
    """
    async with service.imports.taken():
        return await asyncio.to_thread(service.importer, data, filename, options)


async def _receive(request: Request, service: Service) -> Upload:
    slots = service.upload_slots
    if slots.locked():
        raise ProblemError(
            503,
            "busy",
            "Too many concurrent uploads",
            hint="Try again shortly.",
            headers={"Retry-After": "5"},
        )
    async with slots:
        content_length = request.headers.get("content-length", "")
        await asyncio.to_thread(
            check_quota, service.settings, int(content_length) if content_length.isdigit() else 0
        )
        return await read_upload(request, service.settings.upload_bytes)


def _find(service: Service, upload: Upload) -> TreeOut | None:
    with service.sessions() as session:
        tree = find_same(session, hashlib.sha256(upload.data).hexdigest(), upload.changes.import_options())
        if tree is None:
            return None
        service.stores.sources.put(upload.data)  # written only if the stored file is damaged or lost
        return tree_out(tree)


def find_same(session: Session, source_sha256: str, options: dict[str, Any]) -> Tree | None:
    trees = readable_rows(session, Tree, Tree.source_sha256 == source_sha256, Tree.builtin.is_(False))
    return next((tree for tree in trees if tree.options == options), None)


def store_tree(service: Service, upload: Upload, read: ReadUpload) -> tuple[TreeOut, bool]:
    """Store an upload. Returns the tree and whether it is new: equal concurrent uploads become one tree."""
    check_quota(service.settings, len(upload.data) + read_bytes(read))
    with service.files_lock:
        return _store_files(service, upload, read)


def read_bytes(read: ReadUpload) -> int:
    """Size of the files that an import leaves."""
    return len(read.render_glb) + len(read.tree) + len(read.beams or b"")


def put_read(service: Service, read: ReadUpload) -> dict[str, str | None]:
    """Store the files that an import leaves: column of the tree -> hash."""
    stores = service.stores
    return {
        "mesh_sha256": stores.meshes.put(read.render_glb),
        "import_sha256": stores.imports.put(read.tree),
        "beams_sha256": stores.tables.put(read.beams) if read.beams else None,
    }


def _store_files(service: Service, upload: Upload, read: ReadUpload) -> tuple[TreeOut, bool]:
    tree = Tree(
        name=upload.changes.name or upload.filename.rsplit(".", 1)[0] or "tree",
        species=read.species,
        height_m=read.height_m,
        filename=upload.filename,
        options=upload.changes.import_options(),
        report=read.report,
        source_sha256=service.stores.sources.put(upload.data),
        **put_read(service, read),
    )
    count_stored(service.settings, len(upload.data) + read_bytes(read))
    with service.sessions() as session:
        try:
            return insert_tree(session, tree)
        except Exception:
            _remove_files(session, service, tree)
            raise


def _remove_files(session: Session, service: Service, tree: Tree) -> None:
    """Remove the files of a tree that could not be stored."""
    with suppress(SQLAlchemyError), session.begin():
        remove_unshared(session, service.stores.sources, (Tree.source_sha256,), tree.source_sha256)
        remove_read(session, service, {name: getattr(tree, name) for name in READ_COLUMNS})


def remove_read(session: Session, service: Service, files: Mapping[str, str | None]) -> None:
    """Remove files that an import has left, column -> hash, unless another tree has them."""
    for column, sharing in READ_COLUMNS.items():
        store = service.stores.named(FILE_COLUMNS[column])
        remove_unshared(session, store, sharing, files.get(column))


def insert_tree(session: Session, tree: Tree) -> tuple[TreeOut, bool]:
    """Insert a row under an id that follows from its file and options, or under a new one if that is taken.

    If an equal tree has taken an id meanwhile, return that tree, and False.
    """
    source_sha256, options = tree.source_sha256, tree.options
    values = {c.key: getattr(tree, c.key) for c in Tree.__table__.columns if getattr(tree, c.key) is not None}
    for name in (_tree_id(source_sha256, options), new_id()):
        try:
            with session.begin():
                row = Tree(**{**values, "id": name})
                session.add(row)
                session.flush()
                return tree_out(row), True
        except IntegrityError:
            with session.begin():
                duplicate = find_same(session, source_sha256, options)
                if duplicate:
                    return tree_out(duplicate), False
    raise RuntimeError("a new identifier was already taken")


def _tree_id(source_sha256: str, options: dict[str, Any]) -> str:
    text = json.dumps([source_sha256, options], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _queue_build(service: Service, tree: TreeOut) -> TreeOut:
    with service.sessions.begin() as session:
        row = session.get_one(Tree, tree.id)
        queue_job(session, row, {})
        out = tree_out(row)
    service.wake_supervisor()
    return out

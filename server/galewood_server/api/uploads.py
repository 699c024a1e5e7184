"""Taking in a mesh: read, repaired and judged in a child process before anything is stored."""

from __future__ import annotations

import asyncio
import hashlib
import json
from typing import Any

from fastapi import APIRouter, Request, Response
from galewood.mesh import TreeMesh
from pydantic import ValidationError
from sqlalchemy import select
from sqlalchemy.exc import IntegrityError
from sqlalchemy.orm import Session

from galewood_server.access import check_face_count, need_room, note_stored
from galewood_server.api.trees import tree_out
from galewood_server.context import Service, ServiceHere
from galewood_server.http import (
    FORM,
    NAMES,
    ProblemError,
    TreeChanges,
    TreeOut,
    Upload,
    import_options,
    problems,
    read_upload,
)
from galewood_server.jobs import queue_job
from galewood_server.storage import Tree, new_id

router = APIRouter(prefix="/api/trees", tags=["trees"])


@router.post(
    "",
    status_code=201,
    openapi_extra=FORM,
    responses={
        200: {
            "model": TreeOut,
            "description": "This very file was taken in before, under these assumptions.",
        },
        **problems(400, 408, 413, 415, 503, 507),
    },
)
async def upload_tree(
    request: Request, response: Response, service: ServiceHere, build: bool = False
) -> TreeOut:
    """Take in a mesh. The answer holds what was assumed (`report`) and a preview (`mesh_sha256`: a GLB whose
    meshes are named `wood_…` and `leaves_…`); PATCH the tree to assume otherwise, POST /api/jobs to
    compute it, or let `build=true` do so at once. The same file under the same assumptions is one tree."""
    upload = await _receive(request, service)
    fields = _fields(upload)
    tree = await asyncio.to_thread(_find, service, upload, fields)
    if tree is None:
        check_face_count(upload.data, service.settings.upload_faces)
        mesh, glb = await read_mesh(service, upload.data, upload.filename, assumed(fields))
        tree, new = await asyncio.to_thread(_store, service, upload, fields, mesh, glb)
    else:
        new = False
    response.status_code = 201 if new else 200
    return await asyncio.to_thread(_start, service, tree) if build and new else tree


async def read_mesh(
    service: Service, data: bytes, filename: str, options: dict[str, Any]
) -> tuple[TreeMesh, bytes]:
    """Intake in a child process, a few at a time. MeshError."""
    async with service.import_slots:
        return await asyncio.to_thread(service.importer, data, filename, import_options(options))


async def _receive(request: Request, service: Service) -> Upload:
    slots = service.upload_slots
    if slots.locked():
        raise ProblemError(
            503, "busy", "Too many uploads at once", hint="Try again shortly.", headers={"Retry-After": "5"}
        )
    async with slots:
        declared = request.headers.get("content-length", "")
        await asyncio.to_thread(need_room, service.settings, int(declared) if declared.isdigit() else 0)
        return await read_upload(request, service.settings.upload_bytes)


def _fields(upload: Upload) -> TreeChanges:
    given: dict[str, Any] = {key: value for key, value in upload.fields.items() if value}
    if "wood_materials" in given:
        given["wood_materials"] = [name.strip() for name in given["wood_materials"].split(",")]
    try:
        return TreeChanges.model_validate(given)
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"])
        raise ProblemError(
            422, "invalid-field", f"The field {field!r} cannot be used", detail=first["msg"]
        ) from None


def assumed(fields: TreeChanges) -> dict[str, Any]:
    """What was said about the mesh, without what was left out."""
    return fields.model_dump(include=set(NAMES), exclude_none=True)


def _find(service: Service, upload: Upload, fields: TreeChanges) -> TreeOut | None:
    with service.sessions() as session:
        tree = _same(session, hashlib.sha256(upload.data).hexdigest(), assumed(fields))
        return tree_out(tree) if tree else None


def _same(session: Session, source_sha256: str, options: dict[str, Any]) -> Tree | None:
    uploads = select(Tree).where(Tree.source_sha256 == source_sha256, Tree.builtin.is_(False))
    found = session.scalars(uploads.order_by(Tree.created_at)).all()
    return next((tree for tree in found if tree.options == options), None)


def _store(
    service: Service, upload: Upload, fields: TreeChanges, mesh: TreeMesh, glb: bytes
) -> tuple[TreeOut, bool]:
    """The tree, and whether it is new: two uploads of one file at the same moment end as one tree."""
    need_room(service.settings, len(upload.data) + len(glb))
    with service.files_lock:
        return _store_both(service, upload, fields, mesh, glb)


def _store_both(
    service: Service, upload: Upload, fields: TreeChanges, mesh: TreeMesh, glb: bytes
) -> tuple[TreeOut, bool]:
    tree = Tree(
        name=fields.name or upload.filename.rsplit(".", 1)[0] or "tree",
        species=mesh.species,
        height_m=mesh.height_m,
        filename=upload.filename,
        options=assumed(fields),
        report=mesh.report,
        source_sha256=service.stores.sources.put(upload.data),
        mesh_sha256=service.stores.meshes.put(glb),
    )
    note_stored(service.settings, len(upload.data) + len(glb))
    with service.sessions() as session:
        names = (_name_of(tree.source_sha256, tree.options), new_id())
        return _insert(session, tree, names)


def _insert(session: Session, tree: Tree, names: tuple[str, ...]) -> tuple[TreeOut, bool]:
    """Try the name that follows from the file; taken by its twin, or by a tree whose assumptions changed."""
    source_sha256, options = tree.source_sha256, tree.options
    values = {c.key: getattr(tree, c.key) for c in Tree.__table__.columns if getattr(tree, c.key) is not None}
    for name in names:
        try:
            with session.begin():
                row = Tree(**{**values, "id": name})
                session.add(row)
                session.flush()
                return tree_out(row), True
        except IntegrityError:
            with session.begin():
                twin = _same(session, source_sha256, options)
                if twin:
                    return tree_out(twin), False
    raise RuntimeError("a new identifier was taken already")


def _name_of(source_sha256: str, options: dict[str, Any]) -> str:
    text = json.dumps([source_sha256, options], sort_keys=True)
    return hashlib.sha256(text.encode()).hexdigest()[:16]


def _start(service: Service, tree: TreeOut) -> TreeOut:
    with service.sessions.begin() as session:
        row = session.get_one(Tree, tree.id)
        queue_job(session, row, {})
        answer = tree_out(row)
    service.wake_supervisor()
    return answer

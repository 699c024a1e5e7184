"""Trees: uploaded, listed, computed, deleted."""

from __future__ import annotations

import asyncio
from typing import Any, Literal

from fastapi import APIRouter, Request, Response
from pydantic import BaseModel, ConfigDict, Field, ValidationError, field_validator
from sqlalchemy import select
from sqlalchemy.orm import Session

from precompute.intake_types import IntakeOptions, TreeMesh
from server.context import Service, ServiceHere
from server.errors import ProblemError, not_found
from server.jobs import queue_job
from server.models import ACTIVE, Tree
from server.schemas import BuildSettings, JobOut, PrecomputeRequest, TreeList, TreeOut
from server.uploads import Upload, read_upload

router = APIRouter(prefix="/api/trees", tags=["trees"])

UPLOAD_FORM: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "required": ["file"],
                    "properties": {
                        "file": {"type": "string", "format": "binary", "description": "GLB, OBJ, PLY or STL"},
                        "species": {"type": "string"},
                        "height_m": {"type": "number"},
                        "name": {"type": "string"},
                        "up_axis": {"type": "string", "enum": ["x", "y", "z"]},
                    },
                }
            }
        },
    }
}


class UploadFields(BaseModel):
    """The text fields of an upload."""

    model_config = ConfigDict(extra="forbid")

    species: str | None = None
    height_m: float | None = Field(default=None, gt=0.1, le=150)
    name: str | None = Field(default=None, max_length=200)
    up_axis: Literal["x", "y", "z"] | None = None

    @field_validator("species")
    @classmethod
    def _known(cls, name: str | None) -> str | None:
        return BuildSettings(species=name).species


def tree_out(tree: Tree) -> TreeOut:
    """A tree as the interface shows it."""
    job = tree.job
    fields = {name: getattr(tree, name) for name in TreeOut.model_fields if name != "job_id"}
    return TreeOut(**fields, job_id=job.id if job else None)


def job_out(tree: Tree) -> JobOut | None:
    """The newest job of a tree."""
    return JobOut.model_validate(tree.job) if tree.job else None


@router.get("")
def list_trees(service: ServiceHere) -> TreeList:
    """Every tree, the built-in species first, then by age."""
    with service.sessions() as session:
        trees = session.scalars(select(Tree).order_by(Tree.builtin.desc(), Tree.created_at)).all()
        return TreeList(trees=[tree_out(tree) for tree in trees])


@router.get("/{tree_id}")
def get_tree(tree_id: str, service: ServiceHere) -> TreeOut:
    """One tree with the report of its intake."""
    with service.sessions() as session:
        return tree_out(_tree(session, tree_id))


@router.post("", status_code=201, openapi_extra=UPLOAD_FORM)
async def upload_tree(request: Request, service: ServiceHere) -> TreeOut:
    """Take in a mesh: read, repaired and judged in a child process before anything is stored."""
    upload = await read_upload(request, service.settings.upload_bytes)
    fields = _fields(upload)
    options = IntakeOptions(
        species=fields.species, height_m=fields.height_m, up_axis=fields.up_axis, wood=None
    )
    async with service.intake_slots:
        mesh, glb = await asyncio.to_thread(service.intake, upload.data, upload.filename, options)
    return await asyncio.to_thread(_store, service, upload, fields, mesh, glb)


def _fields(upload: Upload) -> UploadFields:
    try:
        return UploadFields.model_validate({key: value for key, value in upload.fields.items() if value})
    except ValidationError as error:
        first = error.errors()[0]
        field = ".".join(str(part) for part in first["loc"])
        raise ProblemError(
            422, "invalid-field", f"The field {field!r} cannot be used", detail=first["msg"]
        ) from None


def _store(service: Service, upload: Upload, fields: UploadFields, mesh: TreeMesh, glb: bytes) -> TreeOut:
    tree = Tree(
        name=fields.name or upload.filename.rsplit(".", 1)[0] or "tree",
        species=mesh.species,
        height_m=mesh.height_m,
        filename=upload.filename,
        options=fields.model_dump(include={"species", "height_m", "up_axis"}, exclude_none=True),
        report=mesh.report,
        source_sha256=service.stores.sources.put(upload.data),
        mesh_sha256=service.stores.meshes.put(glb),
    )
    with service.sessions.begin() as session:
        session.add(tree)
        session.flush()
        return tree_out(tree)


@router.post("/{tree_id}/precompute", status_code=202, max_body_size=64 * 1024)
def precompute_tree(tree_id: str, service: ServiceHere, body: PrecomputeRequest | None = None) -> JobOut:
    """Queue the computation of a tree's table."""
    settings = (body or PrecomputeRequest()).settings.model_dump(exclude_none=True)
    with service.sessions.begin() as session:
        answer = JobOut.model_validate(queue_job(session, _tree(session, tree_id), settings))
    service.wake_supervisor()
    return answer


@router.delete("/{tree_id}", status_code=204)
def delete_tree(tree_id: str, service: ServiceHere) -> Response:
    """Forget an uploaded tree with its jobs, and its files where no other tree shares them."""
    with service.sessions.begin() as session:
        tree = _tree(session, tree_id)
        if tree.builtin:
            raise ProblemError(
                403, "builtin-tree", "The built-in species stay", hint="Only uploads are deleted."
            )
        if tree.job and tree.job.state in ACTIVE:
            raise ProblemError(
                409, "still-building", "This tree is being computed", hint="Cancel its job first."
            )
        session.delete(tree)
        session.flush()
        _remove_files(session, service, tree)
    return Response(status_code=204)


def _remove_files(session: Session, service: Service, tree: Tree) -> None:
    kept = (
        (service.stores.sources, Tree.source_sha256, tree.source_sha256),
        (service.stores.meshes, Tree.mesh_sha256, tree.mesh_sha256),
        (service.stores.tables, Tree.table_sha256, tree.table_sha256),
    )
    for store, column, sha256 in kept:
        if sha256 and not session.scalars(select(Tree.id).where(column == sha256)).first():
            store.remove(sha256)


def _tree(session: Session, tree_id: str) -> Tree:
    tree = session.get(Tree, tree_id)
    if tree is None:
        raise not_found("tree", tree_id)
    return tree

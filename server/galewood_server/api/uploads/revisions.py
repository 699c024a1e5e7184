"""Changing the name or the import options of a tree before its table is computed."""

from __future__ import annotations

import asyncio
import hashlib
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fastapi import APIRouter
from galewood.options import ImportRequest

from galewood_server.access import check_quota, count_stored
from galewood_server.api.trees import check_from_file, find_tree, tree_out
from galewood_server.api.uploads.upload import READ_COLUMNS, put_read, read_bytes, read_mesh, remove_read
from galewood_server.context import Service, ServiceDep
from galewood_server.http import ProblemError, TreeChanges, TreeOut, problems
from galewood_server.storage import Tree

if TYPE_CHECKING:
    from galewood.pipeline.stages import ReadUpload

router = APIRouter(prefix="/api/trees", tags=["trees"])


@dataclass(frozen=True)
class Revision:
    """A mesh imported again: its options and the result."""

    options: dict[str, Any]
    read: ReadUpload


@router.patch("/{tree_id}", max_body_size=64 * 1024, responses=problems(400, 403, 404, 409, 413, 503, 507))
async def change_tree(tree_id: str, body: TreeChanges, service: ServiceDep) -> TreeOut:
    """Rename an upload or import its mesh again with other options, which updates its report and preview.
    A field that is null is determined by mesh import again; a missing field is unchanged. Once there is a
    table, only the name can be changed: use POST /api/jobs to compute a table with other settings."""
    options = await asyncio.to_thread(_options, service, tree_id, body)
    revision = None
    if options is not None:
        source, filename = await asyncio.to_thread(_source, service, tree_id)
        read = await read_mesh(service, source, filename, ImportRequest.model_validate(options))
        revision = Revision(options, read)
        await asyncio.to_thread(check_quota, service.settings, read_bytes(read))
    return await asyncio.to_thread(_write, service, tree_id, body.name, revision)


def _options(service: Service, tree_id: str, body: TreeChanges) -> dict[str, Any] | None:
    """The new import options; None if they do not change. ProblemError 403, 404, 409."""
    with service.sessions() as session:
        tree = find_tree(session, tree_id)
        if tree.builtin:
            raise ProblemError(403, "builtin-tree", "Built-in trees cannot be changed")
        given = body.model_fields_set - {"name"}
        kept = {key: value for key, value in tree.options.items() if key not in given}
        options = {**kept, **body.import_options()}
        if options == tree.options:
            return None
        check_from_file(tree)
        _check_unbuilt(tree)
        return options


def _check_unbuilt(tree: Tree) -> None:
    if tree.state not in ("uploaded", "failed"):
        raise ProblemError(
            409,
            "already-built",
            "This tree has a table or is being computed",
            hint="Upload the file again with other options, or start a job with other settings.",
        )


def _source(service: Service, tree_id: str) -> tuple[bytes, str]:
    with service.sessions() as session:
        tree = find_tree(session, tree_id)
        return service.stores.sources.get(tree.source_sha256), tree.filename


def _write(service: Service, tree_id: str, name: str | None, revision: Revision | None) -> TreeOut:
    with service.files_lock, service.sessions.begin() as session:
        tree = find_tree(session, tree_id)
        before: dict[str, str | None] = {}
        if name:
            tree.name = name
        if revision:
            _check_unbuilt(tree)
            read = revision.read
            tree.options, tree.report = revision.options, read.report
            tree.species, tree.height_m = read.species, read.height_m
            before = {column: getattr(tree, column) for column in READ_COLUMNS}
            tree.mesh_sha256 = hashlib.sha256(read.render_glb).hexdigest()
        session.flush()
        tree_out(tree)  # before the files are stored: refused if it cannot be serialised
        if revision:
            for column, sha256 in put_read(service, revision.read).items():
                setattr(tree, column, sha256)
            session.flush()
            count_stored(service.settings, read_bytes(revision.read))
            remove_read(session, service, before)
        return tree_out(tree)

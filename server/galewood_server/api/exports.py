"""Exports of computed trees for engines: made in a sandboxed child process, kept by what they depend on."""

from __future__ import annotations

import asyncio
import hashlib
import json
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Annotated, Self

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import FileResponse
from galewood.io.export import EXPORT_REVISION, RIGID_KINDS, ExportKind, ExportOptions, LoopOptions, file_name
from galewood.motion.wind import PRESETS, Wind, parse_wind
from galewood.util import write_atomically
from pydantic import Field, model_validator

from galewood_server.api.analyses.common import computed_tree
from galewood_server.context import Service, ServiceDep
from galewood_server.http import NOT_MODIFIED, ProblemError, contents, etag_matches, problems

router = APIRouter(prefix="/api/trees", tags=["trees"])
ZIP_CONTENT = contents("The files of the export.", "application/zip")
MOST_FRAMES = 3600
"""Of an export, so that an export takes seconds."""


class ExportQuery(LoopOptions):
    """Options of an export, as of `galewood export`."""

    wind: str = Field(
        default="",
        max_length=4096,
        description=f"A preset ({', '.join(PRESETS)}) or a wind document as JSON.",
    )
    winds: str = Field(
        default="",
        max_length=256,
        description=f"Several presets ({','.join(PRESETS)}): a clip for each, of bones and pivots.",
    )

    @model_validator(mode="after")
    def _few_frames(self) -> Self:
        if self.seconds * self.fps * len(self.winds.split(",")) > MOST_FRAMES:
            raise ValueError(f"an export may have {MOST_FRAMES} frames: seconds × fps × winds")
        return self

    def options(self) -> ExportOptions:
        """The options. WindError."""
        winds = {name: _preset(name) for name in self.winds.split(",") if self.winds}
        chosen = self.model_dump(exclude={"wind", "winds"})
        return ExportOptions(wind=_wind(self.wind), winds=winds, **chosen)


@dataclass(frozen=True)
class _Source:
    """What an export is made from."""

    table_sha256: str
    mesh_sha256: str
    compliance_sha256: str | None
    name: str


@router.get(
    "/{tree_id}/exports/{kind}",
    response_class=FileResponse,
    responses={**ZIP_CONTENT, **NOT_MODIFIED, **problems(404, 409, 422, 503)},
)
async def get_export(
    tree_id: str,
    kind: ExportKind,
    request: Request,
    service: ServiceDep,
    query: Annotated[ExportQuery, Query()],
) -> Response:
    """A tree that sways, by default in a loop, as a ZIP archive: `vat` (textures), `bones` (rigged GLB),
    `pivots` (for Unreal), `usd`, `glb` (morph targets), `live` (morph targets that the file itself moves),
    and, without a loop, `impostor` (pictures from all sides, to be drawn far away), `mjcf` (rigid bodies for
    MuJoCo) and `urdf` (for robot simulators). The first request for it takes some seconds."""
    options = query.options()
    source = await asyncio.to_thread(_source, service, tree_id, options.name)
    if kind in RIGID_KINDS and source.compliance_sha256 is None:
        title = f"This tree has no compliance file, which the export {kind} needs"
        hint = "It is stored when the computation ends. Trees of very many nodes have none: export bones."
        raise ProblemError(409, "no-compliance", title, hint=hint)
    key = _key(source, kind, options)
    name = f"{source.name}-{kind}.zip"
    headers = {"ETag": f'"{key[:32]}"', "Cache-Control": "no-cache"}
    if etag_matches(request.headers.get("if-none-match", ""), headers["ETag"]):
        return Response(status_code=304, headers=headers)
    target = service.settings.cache_dir / "exports" / f"{key}.zip"
    make = partial(_export, service, source, kind, options, target)
    await service.exports.have(target, request, make)
    return FileResponse(target, media_type="application/zip", filename=name, headers=headers)


def _wind(text: str) -> Wind:
    if not text:
        return Wind()
    if text in PRESETS:
        return PRESETS[text]
    try:
        return parse_wind(json.loads(text))
    except (json.JSONDecodeError, RecursionError):
        presets = ", ".join(PRESETS)
        raise ProblemError(
            422, "bad-wind", "Unknown wind", hint=f"Use one of {presets}, or a wind document as JSON."
        ) from None


def _preset(name: str) -> Wind:
    if name not in PRESETS:
        hint = f"Use {', '.join(PRESETS)}, separated by commas."
        raise ProblemError(422, "bad-wind", f"Unknown wind {name!r}", hint=hint)
    return PRESETS[name]


def _source(service: Service, tree_id: str, name: str | None) -> _Source:
    with service.sessions() as session:
        tree = computed_tree(session, tree_id)
        known = tree.table_sha256 or "", tree.mesh_sha256 or "", tree.compliance_sha256
        return _Source(*known, name or file_name(tree.name))


def _key(source: _Source, kind: str, options: ExportOptions) -> str:
    parts = [EXPORT_REVISION, source.table_sha256, source.mesh_sha256, source.name, kind, options.document()]
    return hashlib.sha256(json.dumps(parts).encode()).hexdigest()


def _export(service: Service, source: _Source, kind: str, options: ExportOptions, target: Path) -> None:
    from galewood.io.export import export_limited  # loads what a build needs

    stores = service.stores
    table, mesh = stores.tables.get(source.table_sha256), stores.meshes.get(source.mesh_sha256)
    wanted = source.compliance_sha256 if kind in RIGID_KINDS else None
    compliance = stores.compliances.get(wanted) if wanted else None
    write_atomically(target, export_limited(table, mesh, kind, source.name, options, compliance))

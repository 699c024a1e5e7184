"""Inventories of stems and recordings of anemometers as JSON that the page plays (`galewood convert`)."""

from __future__ import annotations

import asyncio
import hashlib
from functools import partial
from pathlib import Path
from typing import Annotated, Any, Literal

from fastapi import APIRouter, Query, Request, Response
from fastapi.responses import FileResponse
from galewood.constants import INVENTORY_VERSION
from galewood.measurements import InventoryReport, MeasurementReport, Stem, convert_limited
from galewood.util import write_atomically
from pydantic import BaseModel

from galewood_server.api.health import VERSION
from galewood_server.context import Service, ServiceDep
from galewood_server.http import ProblemError, problems, read_body

router = APIRouter(prefix="/api", tags=["conversions"])
LONGEST_RECORD_S = 1e9
FILE_BODY: dict[str, Any] = {
    "requestBody": {
        "required": True,
        "content": {"application/octet-stream": {"schema": {"type": "string", "format": "binary"}}},
    }
}


class InventoryOut(BaseModel):
    """The stems of an inventory (spec/formats/inventory.md), and how its file was interpreted."""

    version: Literal[1]
    stems: list[Stem]
    report: InventoryReport


class MeasuredWindOut(BaseModel):
    """The wind document of a measurement (spec/formats/wind.md), and how its file was interpreted."""

    wind: dict[str, Any]
    report: MeasurementReport


@router.post(
    "/convert",
    response_model=InventoryOut | MeasuredWindOut,
    openapi_extra=FILE_BODY,
    responses=problems(413, 415, 422, 503),
)
async def convert(
    request: Request,
    service: ServiceDep,
    start_s: Annotated[
        float,
        Query(ge=0, le=LONGEST_RECORD_S, description="Recording: start of the used part, s."),
    ] = 0.0,
) -> Response:
    """Convert an inventory of stems (CSV, GeoJSON) or the record of an anemometer (CSV). Needs no key, and
    nothing is stored. 415 `unknown-content`: the file is neither; 422 names the line of an error."""
    limit_bytes = service.settings.upload_bytes
    title = f"The file is larger than {limit_bytes // 1024**2} MB"
    too_large = ProblemError(413, "file-too-large", title, hint="Split the file.")
    async with service.conversions.admitted(request) as turns:
        body = await read_body(request, limit_bytes, too_large)
        async with turns:
            document = await asyncio.to_thread(lambda: convert_limited(body.take(), start_s))
    return Response(document, media_type="application/json")


@router.get("/inventory", response_model=InventoryOut, responses=problems(404, 415, 422, 503))
async def get_inventory(request: Request, service: ServiceDep) -> Response:
    """Return the inventory that this service was started with (`galewood forest FILE`), which the page plants
    with `?inventory=api/inventory`."""
    path = service.settings.inventory
    target = await asyncio.to_thread(_converted_file, service, path) if path else None
    if path is None or target is None:
        raise ProblemError(
            404,
            "no-inventory",
            "This service has no inventory",
            hint="Start it with `galewood forest FILE`, or set GALEWOOD_INVENTORY.",
        )
    await service.inventories.have(target, request, partial(_convert, path, target))
    return FileResponse(
        target,
        media_type="application/json",
        headers={"Cache-Control": "no-cache"},
        filename=path.name,
        content_disposition_type="inline",
    )


def _converted_file(service: Service, path: Path) -> Path | None:
    """Where the conversion of the operator's file as it is now is kept; None if there is no such file."""
    try:
        found = path.stat()
    except FileNotFoundError:
        return None
    state = (VERSION, INVENTORY_VERSION, str(path), found.st_mtime_ns, found.st_size)
    name = hashlib.sha256(repr(state).encode()).hexdigest()
    return service.settings.cache_dir / "inventories" / f"{name}.json"


def _convert(path: Path, target: Path) -> None:
    write_atomically(target, convert_limited(path.read_bytes()))

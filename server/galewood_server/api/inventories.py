"""The inventory that this service was started with (`galewood forest FILE`)."""

from __future__ import annotations

from fastapi import APIRouter
from fastapi.responses import FileResponse

from galewood_server.context import ServiceDep
from galewood_server.http import ProblemError, contents, problems

router = APIRouter(prefix="/api/inventory", tags=["inventory"])
FILE = contents("The file as it is: CSV or GeoJSON.", "text/csv", "application/geo+json")


@router.get("", response_class=FileResponse, responses={**FILE, **problems(404)})
async def get_inventory(service: ServiceDep) -> FileResponse:
    """Return the inventory of stems that the page plants with `?inventory=api/inventory`."""
    path = service.settings.inventory
    if path is None or not path.is_file():
        raise ProblemError(
            404,
            "no-inventory",
            "This service has no inventory",
            hint="Start it with `galewood forest FILE`, or set GALEWOOD_INVENTORY.",
        )
    kind = "application/geo+json" if path.suffix.lower() in (".json", ".geojson") else "text/csv"
    headers = {"Cache-Control": "no-cache"}
    return FileResponse(
        path, media_type=kind, headers=headers, filename=path.name, content_disposition_type="inline"
    )

"""The wood species that can be assigned to a tree by name."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response
from galewood.wood import SPECIES, Wood

from galewood_server.http import NOT_MODIFIED, WoodSpeciesList, WoodSpeciesOut, json_with_etag

router = APIRouter(prefix="/api/species", tags=["species"])


@router.get("", response_model=WoodSpeciesList, responses=NOT_MODIFIED)
def list_species(request: Request) -> Response:
    """All wood species with their material constants and sources."""
    return json_with_etag(
        request, WoodSpeciesList(species=[_out(name, wood) for name, wood in sorted(SPECIES.items())])
    )


def _out(name: str, wood: Wood) -> WoodSpeciesOut:
    fields = {key: getattr(wood, key) for key in WoodSpeciesOut.model_fields if key != "id"}
    return WoodSpeciesOut(id=name, **fields)

"""The woods that a tree can be given by name."""

from __future__ import annotations

from fastapi import APIRouter, Request, Response
from galewood.wood import SPECIES, Wood

from galewood_server.http import NOT_MODIFIED, SpeciesList, SpeciesOut, tagged

router = APIRouter(prefix="/api/species", tags=["species"])


@router.get("", response_model=SpeciesList, responses=NOT_MODIFIED)
def list_species(request: Request) -> Response:
    """Every wood with its constants and where they come from."""
    return tagged(request, SpeciesList(species=[_out(name, wood) for name, wood in sorted(SPECIES.items())]))


def _out(name: str, wood: Wood) -> SpeciesOut:
    fields = {key: getattr(wood, key) for key in SpeciesOut.model_fields if key != "id"}
    return SpeciesOut(id=name, **fields)

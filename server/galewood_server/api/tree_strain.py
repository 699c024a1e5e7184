"""The strain of a tree in a steady wind (`galewood strain`)."""

from __future__ import annotations

import asyncio
from typing import Annotated

from fastapi import APIRouter, Query, Request, Response
from galewood.table import Foliage
from pydantic import BaseModel, Field

from galewood_server.api.trees import find_tree
from galewood_server.context import Service, ServiceDep
from galewood_server.http import ProblemError, problems, while_connected

router = APIRouter(prefix="/api/trees", tags=["trees"])


class StrainQuery(BaseModel):
    """The wind, and whether the tree is in leaf."""

    speed_m_s: float = Field(default=15.0, ge=0.1, le=100, description="At the top of the tree.")
    direction_deg: float = Field(
        default=0.0, ge=-360, le=360, description="Where it blows, in the tree's frame: 0 to x, 90 to z."
    )
    foliage: Foliage = Field(default="leaf", description="In leaf, or bare as in winter.")


class SectionOut(BaseModel):
    """A section of a stem or bough, and what it bears."""

    height_m: float
    x_m: float
    z_m: float
    diameter_cm: float
    moment_nm: float
    strain: float
    stress_mpa: float


class LargestOut(BaseModel):
    """Where the largest strains are; null: the tree has no boughs of 4 cm."""

    stem: SectionOut | None
    boughs: SectionOut | None


class TreeStrainOut(BaseModel):
    """Bending strain at the outermost fibre along the axes of a tree, as it is drawn, and what this is not
    (`caution`)."""

    points_m: list[tuple[float, float, float]]
    parent: list[int] = Field(description="The point that each grows from; −1: the root.")
    strain: list[float | None] = Field(description="Between a point and its parent; null: not computed.")
    rupture_strain: float = Field(description="Of sound green wood of its species.")
    wind_m_s: float
    direction_deg: float
    breast_height_strain: float | None
    largest: LargestOut
    base_moment_nm: float
    top_displacement_m: float
    load_factor: float
    weight_share: float
    caution: str


@router.get("/{tree_id}/strain", response_model=TreeStrainOut, responses={**problems(404, 409, 422, 503)})
async def tree_strain(
    tree_id: str, request: Request, service: ServiceDep, query: Annotated[StrainQuery, Query()]
) -> Response:
    """The strain of a tree's wood, sound and as stiff as its species, in a steady wind; takes some seconds.

    A calculation for sound wood, and no substitute for an inspection."""
    from galewood.solid.strain import strain_limited  # loads the packages of the beams

    mesh, species = await asyncio.to_thread(_mesh, service, tree_id)
    in_leaf = query.foliage == "leaf"
    async with service.conversions.admitted(request) as turns, turns:
        found = await while_connected(
            request,
            lambda wanted: strain_limited(
                mesh, species, query.speed_m_s, query.direction_deg, leaves=in_leaf, wanted=wanted
            ),
        )
    return Response(found, media_type="application/json")


def _mesh(service: Service, tree_id: str) -> tuple[bytes, str | None]:
    """The drawn mesh and the species of a tree. ProblemError 404, 409."""
    with service.sessions() as session:
        tree = find_tree(session, tree_id)
        if not tree.mesh_sha256:
            raise ProblemError(
                409, "not-read", "This tree has not been read yet", hint="Wait until it moves."
            )
        sha256, species = tree.mesh_sha256, tree.species
    return service.stores.meshes.get(sha256), species

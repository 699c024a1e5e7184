"""The risk of the stems of an inventory in wind (`galewood stand`)."""

from __future__ import annotations

from typing import Annotated, Any

from fastapi import APIRouter, Query, Request, Response
from galewood.check.stand import ReportKind, stand_limited
from galewood.table import Foliage
from pydantic import BaseModel, Field

from galewood_server.api.conversions import FILE_BODY
from galewood_server.context import ServiceDep
from galewood_server.http import ProblemError, contents, problems, read_body, while_connected

router = APIRouter(prefix="/api", tags=["conversions"])
MEDIA_TYPES = {"json": "application/json", "csv": "text/csv; charset=utf-8"}


class StandRiskQuery(BaseModel):
    """What the risk is computed for."""

    foliage: Foliage = Field(default="leaf", description="In leaf, or bare as in winter.")
    speed_m_s: float = Field(
        default=20.0, ge=0.1, le=100, description="Gust in which sway, moment and strain are reported."
    )
    format: ReportKind = Field(
        default="json", description="JSON, in the order of the inventory, or a table by rank."
    )


class StemRiskOut(BaseModel):
    """A stem in wind. Winds are gusts at its top, m/s; null: it does not break up to 100 m/s."""

    rank: int = Field(description="1 breaks first.")
    index: int = Field(description="Of the stem in the inventory, from 0.")
    line: int = Field(description="Of the stem in its file.")
    species: str
    tree: str = Field(description="The built-in tree that stands for it.")
    wood: str = Field(description="Species of the wood; `default`: average wood.")
    east_m: float
    north_m: float
    lon_deg: float | None
    lat_deg: float | None
    height_m: float
    height_estimated: bool = Field(description="Whether the height is not measured: from the diameter.")
    dbh_cm: float
    dbh_assumed: bool = Field(description="Whether the diameter is not measured: the tree's proportions.")
    rough: bool = Field(description="Less than half or more than twice as high, or as slender, as the tree.")
    frequency_hz: float
    edge_distance_m: float
    load_share: float = Field(description="Share of the load at the edge that it bears.")
    direction_deg: float = Field(description="Where the wind blows: 0 to the east, 90 to the south.")
    sway_m: float
    base_moment_knm: float
    strain: float = Field(description="The largest of the stem.")
    critical_m_s: float | None
    critical_low_m_s: float | None = Field(description="10 % of possible trees break in a weaker gust.")
    critical_high_m_s: float | None = Field(description="90 % of possible trees break in a weaker gust.")


class StandRiskOut(BaseModel):
    """The stems of an inventory in wind, what was assumed, and what this is not (`caution`)."""

    options: dict[str, Any]
    stems_per_ha: float
    mean_height_m: float
    stems: list[StemRiskOut]
    assumptions: list[str]
    caution: str


@router.post(
    "/stand-risk",
    response_model=StandRiskOut,
    openapi_extra=FILE_BODY,
    responses={**contents("The same as a table.", "text/csv"), **problems(413, 422, 503)},
)
async def stand_risk(
    request: Request, service: ServiceDep, query: Annotated[StandRiskQuery, Query()]
) -> Response:
    """The wind risk of the stems of an inventory: CSV, GeoJSON, or an inventory document. Needs no key, and
    nothing is stored. 413 `too-many-stems`; 422 `bad-inventory` names the line of an error.

    A calculation for sound wood, and no substitute for an inspection."""
    limit_bytes = service.settings.upload_bytes
    title = f"The file is larger than {limit_bytes // 1024**2} MB"
    too_large = ProblemError(413, "file-too-large", title, hint="Split the file.")
    async with service.conversions.admitted(request) as turns:
        body = await read_body(request, limit_bytes, too_large)
        async with turns:
            report = await while_connected(
                request,
                lambda wanted: stand_limited(
                    body.take(), query.foliage, query.speed_m_s, query.format, wanted
                ),
            )
    return Response(report, media_type=MEDIA_TYPES[query.format])

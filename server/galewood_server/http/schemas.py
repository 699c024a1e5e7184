"""What the REST interface sends and takes."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any

from galewood.options import BuildRequest, ImportRequest
from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from galewood_server.storage import JobState, TreeState

TreeName = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=200)]


class JobOut(BaseModel):
    """A job: `fraction` in [0, 1], `seconds_left` an estimate, `error` a sentence.

    `samples_done` of `samples_total` runs are simulated; `pictures` are names with a hash each.
    """

    model_config = ConfigDict(from_attributes=True)

    id: str
    tree_id: str
    state: JobState
    stage: str
    fraction: float
    message: str
    seconds_left: float | None
    samples_done: int | None = None
    samples_total: int | None = None
    pictures: dict[str, str] = Field(default_factory=dict)
    error: str | None
    created_at: datetime
    updated_at: datetime


class TreeOut(BaseModel):
    """A tree: `state` is `ready` as soon as there is a table; `job_id` is its newest job."""

    model_config = ConfigDict(from_attributes=True)

    id: str
    name: str
    species: str | None
    builtin: bool
    state: TreeState
    height_m: float | None
    table_sha256: str | None
    mesh_sha256: str | None
    job_id: str | None
    report: dict[str, Any]
    created_at: datetime


class TreeList(BaseModel):
    """A page of the trees, built-in species first, then by age; `next` asks for the page after it."""

    trees: list[TreeOut]
    total: int
    next: str | None


class JobList(BaseModel):
    """A page of the jobs, the newest first; `next` asks for the page after it."""

    jobs: list[JobOut]
    total: int
    next: str | None


class TableOut(BaseModel):
    """A table that a tree has now."""

    sha256: str
    size_bytes: int
    tree_id: str
    name: str
    species: str | None
    height_m: float | None
    mesh_sha256: str | None


class TableList(BaseModel):
    """Every table in use."""

    tables: list[TableOut]
    total: int
    next: str | None


class SpeciesOut(BaseModel):
    """Wood that a tree can be given: elastic constants along and across the fibre, density, damping, drag."""

    id: str
    name: str
    young_longitudinal_pa: float
    density_kg_m3: float
    damping_ratio: float
    drag_coefficient: float
    source: str


class SpeciesList(BaseModel):
    """The woods that are known by name."""

    species: list[SpeciesOut]


class Change(BaseModel):
    """One event of /api/events: a tree with its newest job, or the last word on a tree that was deleted."""

    tree: TreeOut
    job: JobOut | None
    deleted: bool = False


class Assumptions(ImportRequest):
    """What mesh import would otherwise assume; the tree's report says what it did assume."""


class TreeChanges(Assumptions):
    """Body of PATCH /api/trees/{id}: another name, other assumptions (the mesh is then read again)."""

    name: TreeName | None = None


class BuildSettings(BuildRequest):
    """Options of a build; whatever is left out keeps the tree's own value or the default."""


class PrecomputeRequest(BaseModel):
    """Body of POST /api/trees/{id}/precompute; may be left out."""

    model_config = ConfigDict(extra="forbid")

    settings: BuildSettings = Field(default_factory=lambda: BuildSettings())


class JobRequest(PrecomputeRequest):
    """Body of POST /api/jobs."""

    tree_id: str = Field(min_length=1, max_length=64)


class Liveness(BaseModel):
    """Answer of /api/health: the versions of the software, of its tables and of its streams."""

    status: str
    version: str
    table_version: int
    wire_version: int


class Readiness(BaseModel):
    """Answer of /api/health/ready: `status` is "ok" or "unable"."""

    status: str
    version: str
    checks: dict[str, bool]


class ProblemOut(BaseModel):
    """A problem (RFC 9457): `code` is for programs, `title`, `detail` and `hint` for people."""

    type: str
    title: str
    status: int
    detail: str
    hint: str
    code: str


class Health(BaseModel):
    """Answer of /healthz."""

    status: str
    version: str
    trees: int
    ready: int
    jobs_active: int
    sockets: int

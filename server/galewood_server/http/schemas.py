"""Request and response models of the REST API."""

from __future__ import annotations

from datetime import datetime
from typing import Annotated, Any

from galewood.options import BuildRequest, ImportRequest
from pydantic import BaseModel, ConfigDict, Field, StringConstraints

from galewood_server.http.texts import StorableText
from galewood_server.storage import Form, JobState, TreeState

TreeName = Annotated[StorableText, StringConstraints(strip_whitespace=True, min_length=1, max_length=200)]


class JobOut(BaseModel):
    """A build job: `fraction` is in [0, 1], `seconds_left` is an estimate, `error` a message for users.

    `samples_done` of `samples_total` runs are simulated; `pictures` maps names of preview images to hashes.
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
    """A tree: `state` is `ready` once it has a complete table; `job_id` is its newest build job.

    `records_sha256` is null until the records of the paper's state search are computed, and for tables of
    older versions, which contain them. `bare_table_sha256` is the table of the same mesh without its leaves,
    for the winter; null: there is none. `form`: grown in the open, or slender between other trees; a built-in
    species may have one tree of each form. `compliance_sha256` is needed only to pull the tree at a point.
    """

    model_config = ConfigDict(from_attributes=True)

    id: str
    name: str
    species: str | None
    builtin: bool
    form: Form = "open"
    state: TreeState
    height_m: float | None
    table_sha256: str | None
    bare_table_sha256: str | None = None
    records_sha256: str | None
    compliance_sha256: str | None = None
    mesh_sha256: str | None
    job_id: str | None
    report: dict[str, Any]
    created_at: datetime


class TreeList(BaseModel):
    """A page of the trees: built-in trees first, then by age. `next` is the cursor of the next page."""

    trees: list[TreeOut]
    total: int
    next: str | None


class JobList(BaseModel):
    """A page of the jobs, newest first. `next` is the cursor of the next page."""

    jobs: list[JobOut]
    total: int
    next: str | None


class TableOut(BaseModel):
    """The current table of a tree; `records_sha256` is the file of the paper's records, once it exists, and
    `bare_table_sha256` the table of the same mesh without its leaves, if there is one."""

    sha256: str
    size_bytes: int
    bare_table_sha256: str | None = None
    records_sha256: str | None
    tree_id: str
    name: str
    species: str | None
    height_m: float | None
    mesh_sha256: str | None


class TableList(BaseModel):
    """A page of the current tables. `next` is the cursor of the next page."""

    tables: list[TableOut]
    total: int
    next: str | None


class WoodSpeciesOut(BaseModel):
    """A wood species: Young's modulus along the fibre, density, damping ratio and drag coefficient."""

    id: str
    name: str
    young_longitudinal_pa: float
    density_kg_m3: float
    damping_ratio: float
    drag_coefficient: float
    source: str


class WoodSpeciesList(BaseModel):
    """All wood species."""

    species: list[WoodSpeciesOut]


class Change(BaseModel):
    """An event of /api/events: a tree with its newest build job; `deleted` if the tree was removed."""

    tree: TreeOut
    job: JobOut | None
    deleted: bool = False


class ImportFields(ImportRequest):
    """Mesh import options. Missing options are determined by mesh import and listed in the tree's report."""


class TreeChanges(ImportFields):
    """Body of PATCH /api/trees/{id}: a new name or other import options (the mesh is then imported again)."""

    name: TreeName | None = None


class BuildSettings(BuildRequest):
    """Settings of a build. Missing ones default to the tree's import options or the build's defaults."""


class PrecomputeRequest(BaseModel):
    """Body of POST /api/trees/{id}/precompute (optional)."""

    model_config = ConfigDict(extra="forbid")

    settings: BuildSettings = Field(default_factory=lambda: BuildSettings())


class JobRequest(PrecomputeRequest):
    """Body of POST /api/jobs."""

    tree_id: StorableText = Field(min_length=1, max_length=64)


class Liveness(BaseModel):
    """Response of /api/health: versions of the software, the table format and the stream protocol."""

    status: str
    version: str
    table_version: int
    wire_version: int


class Readiness(BaseModel):
    """Response of /api/health/ready: `status` is "ok" or "unable"."""

    status: str
    version: str
    checks: dict[str, bool]


class ProblemOut(BaseModel):
    """Problem details (RFC 9457): `code` is machine-readable; `title`, `detail` and `hint` are for users."""

    type: str
    title: str
    status: int
    detail: str
    hint: str
    code: str


class Health(BaseModel):
    """Response of /healthz."""

    status: str
    version: str
    trees: int
    ready: int
    jobs_active: int
    sockets: int

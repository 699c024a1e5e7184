"""Request and response models of the REST API."""

from __future__ import annotations

import json
from datetime import UTC, datetime
from typing import Annotated, Any

from galewood.options import BuildRequest, ImportRequest
from galewood.wood import is_evergreen
from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    StringConstraints,
    computed_field,
)

from galewood_server.http.texts import AS_SHOWN, StorableText
from galewood_server.storage import Form, JobState, TreeState

TreeName = Annotated[str, StringConstraints(strip_whitespace=True, min_length=1, max_length=200), AS_SHOWN]


def _as_utc(time: datetime) -> datetime:
    return time.replace(tzinfo=UTC) if time.tzinfo is None else time.astimezone(UTC)


def _from_text(value: object) -> object:
    return json.loads(value) if isinstance(value, str) else value


StoredTime = Annotated[datetime, AfterValidator(_as_utc)]
"""A time in UTC, also as SQLite holds it, without a zone."""
from_stored_json = BeforeValidator(_from_text)
"""Reads a JSON column, also as its text."""


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
    pictures: Annotated[dict[str, str], from_stored_json] = Field(default_factory=dict)
    error: str | None
    created_at: StoredTime
    updated_at: StoredTime


class TreeSummary(BaseModel):
    """A tree without its report: `state` is `ready` once it has a complete table; `job_id` is its newest
    build job.

    `records_sha256` is null until the records of the paper's state search are computed. `bare_table_sha256`
    is the table of the same mesh without its leaves, for the winter; null: there is none. `form`: grown
    in the open, or slender between other trees; a built-in species may have one tree of each form.
    `compliance_sha256` is needed only to pull the tree at a point. `evergreen`: its species keeps its
    leaves or needles in winter. `grown`: an individual of a species (POST /api/individuals).
    `updated_at` changes with every change of the tree, also of its report.
    """

    id: str
    name: str
    species: str | None
    builtin: bool
    form: Form = "open"
    grown: bool = False
    state: TreeState
    height_m: float | None
    table_sha256: str | None
    bare_table_sha256: str | None = None
    records_sha256: str | None
    compliance_sha256: str | None = None
    mesh_sha256: str | None
    job_id: str | None
    created_at: StoredTime
    updated_at: StoredTime

    @computed_field
    @property
    def evergreen(self) -> bool:
        return is_evergreen(self.species)


class TreeOut(TreeSummary):
    """A tree with its report: that of its mesh import and, once it is built, of its build."""

    report: Annotated[dict[str, Any], from_stored_json]


class PageOut(BaseModel):
    """A page of a list. `next` is the cursor of the next page. `damaged`: ids of records that cannot be read
    and are left out; `total` counts them."""

    total: int
    next: str | None
    damaged: list[str]


class TreeList(PageOut):
    """A page of the trees: built-in trees first, then by age."""

    trees: list[TreeSummary]


class JobList(PageOut):
    """A page of the jobs, newest first."""

    jobs: list[JobOut]


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


class TableList(PageOut):
    """A page of the current tables."""

    tables: list[TableOut]


class WoodSpeciesOut(BaseModel):
    """A wood species: Young's modulus along the fibre, density, damping, drag and streamlining in leaf."""

    id: str
    name: str
    young_longitudinal_pa: float
    density_kg_m3: float
    damping_ratio: float
    drag_coefficient: float
    streamlined_exponent: float
    source: str


class WoodSpeciesList(BaseModel):
    """All wood species."""

    species: list[WoodSpeciesOut]


class TreeChanges(ImportRequest):
    """Body of PATCH /api/trees/{id}: a new name or other import options (the mesh is then imported again)."""

    name: TreeName | None = Field(default=None, description="Name of the tree; default: that of the file.")

    def import_options(self) -> dict[str, Any]:
        """The given import options, as they are stored."""
        return self.model_dump(include=set(ImportRequest.model_fields), exclude_none=True)


class BuildSettings(BuildRequest):
    """Settings of a build. Missing import options are those of the tree."""

    def given(self) -> dict[str, Any]:
        """The given settings, as they are stored."""
        return self.model_dump(exclude_unset=True, exclude_none=True)


class JobRequest(BaseModel):
    """Body of POST /api/jobs."""

    model_config = ConfigDict(extra="forbid")

    tree_id: StorableText = Field(min_length=1, max_length=64)
    settings: BuildSettings = Field(default_factory=lambda: BuildSettings())


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
    """Problem details (RFC 9457): `code` is machine-readable; `title`, `detail` and `hint` are for users.
    There is a `detail` only where it says more than `title` and `hint`."""

    type: str
    title: str
    status: int
    detail: str | None = None
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

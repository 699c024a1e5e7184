"""What the REST interface sends and takes."""

from __future__ import annotations

from datetime import datetime
from typing import Any

from pydantic import BaseModel, ConfigDict, Field, field_validator

from precompute.wood import SPECIES
from server.models import JobState, TreeState


class JobOut(BaseModel):
    """A job: `fraction` in [0, 1], `seconds_left` an estimate, `error` a sentence."""

    model_config = ConfigDict(from_attributes=True)

    id: str
    tree_id: str
    state: JobState
    stage: str
    fraction: float
    message: str
    seconds_left: float | None
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
    """Every tree, built-in species first."""

    trees: list[TreeOut]


class Change(BaseModel):
    """One event of /api/events: a tree with its newest job, or the last word on a tree that was deleted."""

    tree: TreeOut
    job: JobOut | None
    deleted: bool = False


class BuildSettings(BaseModel):
    """What a build may be told to do otherwise; everything left out keeps the tree's own or the default."""

    model_config = ConfigDict(extra="forbid")

    species: str | None = None
    height_m: float | None = Field(default=None, gt=0.1, le=150)
    target_tets: int | None = Field(default=None, ge=500, le=60_000)
    sampled_elements: int | None = Field(default=None, ge=1, le=2000)
    design_speed_m_s: float | None = Field(default=None, gt=0, le=60)
    frames: int | None = Field(default=None, ge=30, le=1800)

    @field_validator("species")
    @classmethod
    def _known(cls, name: str | None) -> str | None:
        if name is not None and name not in SPECIES:
            raise ValueError(f"unknown species {name[:40]!r}; known: {', '.join(sorted(SPECIES))}")
        return name


class PrecomputeRequest(BaseModel):
    """Body of POST /api/trees/{id}/precompute; may be left out."""

    model_config = ConfigDict(extra="forbid")

    settings: BuildSettings = Field(default_factory=lambda: BuildSettings())


class Health(BaseModel):
    """Answer of /healthz."""

    status: str
    version: str
    trees: int
    ready: int
    jobs_active: int
    sockets: int

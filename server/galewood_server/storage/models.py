"""Database tables: trees, jobs, garbage and shared forests."""

from __future__ import annotations

import secrets
from datetime import UTC, datetime
from typing import Any, Literal

from sqlalchemy import JSON, Boolean, DateTime, Dialect, Float, ForeignKey, Integer, String, Text, false
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column, relationship
from sqlalchemy.types import TypeDecorator

Form = Literal["open", "forest"]
TreeState = Literal["uploaded", "building", "preliminary", "ready", "failed"]
JobState = Literal["queued", "running", "done", "failed", "cancelled"]
JobKind = Literal["build", "individual", "comparison", "evaluation"]
TABLE_JOBS: tuple[JobKind, ...] = ("build", "individual")
"""Kinds of jobs that make the table of a tree."""
ACTIVE_STATES: tuple[JobState, ...] = ("queued", "running")


def utc_now() -> datetime:
    """The current time as an aware UTC datetime."""
    return datetime.now(UTC)


def new_id() -> str:
    """A random, unguessable identifier."""
    return secrets.token_hex(8)


def tree_state(table_sha256: object, preliminary: object, job_state: object) -> TreeState:
    """The state of a tree with this table and this state of its newest build job; None: there is none."""
    if table_sha256:
        return "preliminary" if preliminary else "ready"
    if job_state in ACTIVE_STATES:
        return "building"
    return "failed" if job_state == "failed" else "uploaded"


class UtcDateTime(TypeDecorator[datetime]):
    """Aware UTC datetimes, also on databases that do not store time zones (SQLite)."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        return value.astimezone(UTC) if value else None

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


class Base(DeclarativeBase):
    """Base class of the tables; a test compares them with storage/migrations."""


class Tree(Base):
    """A mesh, its import report, and the newest table computed from it."""

    __tablename__ = "trees"

    id: Mapped[str] = mapped_column(String(64), primary_key=True, default=new_id)
    name: Mapped[str] = mapped_column(String(200))
    species: Mapped[str | None] = mapped_column(String(64))
    builtin: Mapped[bool] = mapped_column(Boolean, default=False)
    # an individual of a built-in species: its source is a document from which this software grows it
    grown: Mapped[bool] = mapped_column(Boolean, default=False, server_default=false())
    # grown in the open, or slender between others: built-in species have both
    form: Mapped[Form] = mapped_column(String(16), default="open", server_default="open")
    height_m: Mapped[float | None] = mapped_column(Float)
    filename: Mapped[str] = mapped_column(String(255))
    options: Mapped[dict[str, Any]] = mapped_column(JSON, default=dict)
    report: Mapped[dict[str, Any]] = mapped_column(JSON, default=dict)
    source_sha256: Mapped[str] = mapped_column(String(64))
    mesh_sha256: Mapped[str | None] = mapped_column(String(64))
    # what the import has read, for the first build, and the table of beams that moves the tree until then
    import_sha256: Mapped[str | None] = mapped_column(String(64))
    beams_sha256: Mapped[str | None] = mapped_column(String(64))
    table_sha256: Mapped[str | None] = mapped_column(String(64))
    # the table of the same mesh without its leaves, for the winter
    bare_table_sha256: Mapped[str | None] = mapped_column(String(64))
    # the records of the paper's state search, which belong to this table and follow it
    records_sha256: Mapped[str | None] = mapped_column(String(64))
    # for pulling the tree at a point; belongs to the mesh and its model
    compliance_sha256: Mapped[str | None] = mapped_column(String(64))
    # the FEM model of the table's training runs
    model_sha256: Mapped[str | None] = mapped_column(String(64))
    # the table is preliminary (from the first few winds); the build will replace it
    preliminary: Mapped[bool] = mapped_column(Boolean, default=False)
    # hash of the table's source, options, settings and pipeline version
    fingerprint: Mapped[str | None] = mapped_column(String(64))
    created_at: Mapped[datetime] = mapped_column(UtcDateTime, default=utc_now)
    updated_at: Mapped[datetime] = mapped_column(UtcDateTime, default=utc_now, onupdate=utc_now)
    jobs: Mapped[list[Job]] = relationship(
        back_populates="tree",
        cascade="all, delete-orphan",
        order_by="(Job.created_at, Job.id)",
        lazy="selectin",
    )

    @property
    def job(self) -> Job | None:
        """The newest build job."""
        return next((job for job in reversed(self.jobs) if job.kind in TABLE_JOBS), None)

    @property
    def state(self) -> TreeState:
        """Derived from the table and the newest build job."""
        job = self.job
        return tree_state(self.table_sha256, self.preliminary, job.state if job else None)


class Job(Base):
    """A build, the growth or an analysis of one tree."""

    __tablename__ = "jobs"

    id: Mapped[str] = mapped_column(String(64), primary_key=True, default=new_id)
    tree_id: Mapped[str] = mapped_column(ForeignKey("trees.id", ondelete="CASCADE"), index=True)
    kind: Mapped[JobKind] = mapped_column(String(16), default="build")
    state: Mapped[JobState] = mapped_column(String(16), default="queued", index=True)
    stage: Mapped[str] = mapped_column(String(32), default="queued")
    fraction: Mapped[float] = mapped_column(Float, default=0.0)
    message: Mapped[str] = mapped_column(Text, default="")
    seconds_left: Mapped[float | None] = mapped_column(Float)
    error: Mapped[str | None] = mapped_column(Text)
    settings: Mapped[dict[str, Any]] = mapped_column(JSON, default=dict)
    attempts: Mapped[int] = mapped_column(Integer, default=0)
    cancel_requested: Mapped[bool] = mapped_column(Boolean, default=False)
    samples_done: Mapped[int | None] = mapped_column(Integer)
    samples_total: Mapped[int | None] = mapped_column(Integer)
    # name → SHA-256 of preview images and plots
    pictures: Mapped[dict[str, str]] = mapped_column(JSON, default=dict)
    # main figures of an analysis, and the hash of its result file; of a build, the file of its `tetrahedra`
    result: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    result_sha256: Mapped[str | None] = mapped_column(String(64))
    # owning server, lease token and expiry (jobs/leases.py)
    owner: Mapped[str | None] = mapped_column(String(64))
    lease: Mapped[str | None] = mapped_column(String(64))
    lease_until: Mapped[datetime | None] = mapped_column(UtcDateTime)
    created_at: Mapped[datetime] = mapped_column(UtcDateTime, default=utc_now)
    updated_at: Mapped[datetime] = mapped_column(UtcDateTime, default=utc_now, onupdate=utc_now)
    tree: Mapped[Tree] = relationship(back_populates="jobs")


class Garbage(Base):
    """A file that was replaced or whose tree was deleted; removed later unless it is referenced again."""

    __tablename__ = "retired"

    id: Mapped[int] = mapped_column(Integer, primary_key=True)
    kind: Mapped[str] = mapped_column(String(16))
    sha256: Mapped[str] = mapped_column(String(64))
    garbage_since: Mapped[datetime] = mapped_column("retired_at", UtcDateTime, index=True)


class SharedForest(Base):
    """Which server holds a shared forest, until when (peers/forest_leases.py)."""

    __tablename__ = "shared_forests"

    share: Mapped[str] = mapped_column(String(64), primary_key=True)
    server_url: Mapped[str] = mapped_column(String(255))
    lease: Mapped[str] = mapped_column(String(64))
    lease_until: Mapped[datetime] = mapped_column(UtcDateTime)

"""The database: trees and the jobs that compute their tables."""

from __future__ import annotations

import secrets
from datetime import UTC, datetime
from typing import Any, Literal

from sqlalchemy import JSON, Boolean, DateTime, Dialect, Float, ForeignKey, Integer, String, Text
from sqlalchemy.orm import DeclarativeBase, Mapped, mapped_column, relationship
from sqlalchemy.types import TypeDecorator

TreeState = Literal["uploaded", "building", "preliminary", "ready", "failed"]
JobState = Literal["queued", "running", "done", "failed", "cancelled"]
JobKind = Literal["build", "comparison", "evaluation"]
ACTIVE: tuple[JobState, ...] = ("queued", "running")


def utc_now() -> datetime:
    """The present moment, aware of its zone."""
    return datetime.now(UTC)


def new_id() -> str:
    """An identifier that cannot be guessed from another."""
    return secrets.token_hex(8)


class UtcDateTime(TypeDecorator[datetime]):
    """Aware UTC times, also on databases that forget the zone (SQLite)."""

    impl = DateTime(timezone=True)
    cache_ok = True

    def process_bind_param(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        return value.astimezone(UTC) if value else None

    def process_result_value(self, value: datetime | None, dialect: Dialect) -> datetime | None:
        if value is None:
            return None
        return value.replace(tzinfo=UTC) if value.tzinfo is None else value.astimezone(UTC)


class Base(DeclarativeBase):
    """Root of the tables; `server/migrations` must be kept in step (a test compares them)."""


class Tree(Base):
    """A mesh, what intake said of it, and the newest table computed from it."""

    __tablename__ = "trees"

    id: Mapped[str] = mapped_column(String(64), primary_key=True, default=new_id)
    name: Mapped[str] = mapped_column(String(200))
    species: Mapped[str | None] = mapped_column(String(64))
    builtin: Mapped[bool] = mapped_column(Boolean, default=False)
    height_m: Mapped[float | None] = mapped_column(Float)
    filename: Mapped[str] = mapped_column(String(255))
    options: Mapped[dict[str, Any]] = mapped_column(JSON, default=dict)
    report: Mapped[dict[str, Any]] = mapped_column(JSON, default=dict)
    source_sha256: Mapped[str] = mapped_column(String(64))
    mesh_sha256: Mapped[str | None] = mapped_column(String(64))
    table_sha256: Mapped[str | None] = mapped_column(String(64))
    # the finite-element model that the table was sampled from
    model_sha256: Mapped[str | None] = mapped_column(String(64))
    # the table is an early one, from the first few winds; a build replaces it by the full one
    preliminary: Mapped[bool] = mapped_column(Boolean, default=False)
    # what the table was computed from: source, options, settings and version of the pipeline
    fingerprint: Mapped[str | None] = mapped_column(String(64))
    created_at: Mapped[datetime] = mapped_column(UtcDateTime, default=utc_now)
    updated_at: Mapped[datetime] = mapped_column(UtcDateTime, default=utc_now, onupdate=utc_now)
    jobs: Mapped[list[Job]] = relationship(
        back_populates="tree", cascade="all, delete-orphan", order_by="Job.created_at", lazy="selectin"
    )

    @property
    def job(self) -> Job | None:
        """The newest build."""
        return next((job for job in reversed(self.jobs) if job.kind == "build"), None)

    @property
    def state(self) -> TreeState:
        """Follows from the table and the newest job, so that it cannot disagree with them."""
        if self.table_sha256:
            return "preliminary" if self.preliminary else "ready"
        if self.job and self.job.state in ACTIVE:
            return "building"
        return "failed" if self.job and self.job.state == "failed" else "uploaded"


class Job(Base):
    """One computation for one tree: its table, or something found out about that table."""

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
    # name → SHA-256 of what a build shows on its way
    pictures: Mapped[dict[str, str]] = mapped_column(JSON, default=dict)
    # figures found, and the file they are in if they are many
    result: Mapped[dict[str, Any] | None] = mapped_column(JSON)
    result_sha256: Mapped[str | None] = mapped_column(String(64))
    # who runs it, by a word that is new with each claim, and until when nobody else may (jobs/leases.py)
    owner: Mapped[str | None] = mapped_column(String(64))
    lease: Mapped[str | None] = mapped_column(String(64))
    lease_until: Mapped[datetime | None] = mapped_column(UtcDateTime)
    created_at: Mapped[datetime] = mapped_column(UtcDateTime, default=utc_now)
    updated_at: Mapped[datetime] = mapped_column(UtcDateTime, default=utc_now, onupdate=utc_now)
    tree: Mapped[Tree] = relationship(back_populates="jobs")


class Garbage(Base):
    """A file that was replaced or whose tree was deleted; removed later, unless something names it again."""

    __tablename__ = "retired"

    id: Mapped[int] = mapped_column(Integer, primary_key=True)
    kind: Mapped[str] = mapped_column(String(16))
    sha256: Mapped[str] = mapped_column(String(64))
    garbage_since: Mapped[datetime] = mapped_column("retired_at", UtcDateTime, index=True)

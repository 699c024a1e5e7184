"""Rows of trees and jobs as the database holds them, for lists.

Nothing is converted in a query, so one damaged value does not spoil the rows beside it; and equal rows are
equal tuples, so what was made of a row is found again by the row itself, whichever server has changed it.
"""

from __future__ import annotations

import logging
from collections.abc import Iterator
from typing import Any, TypeVar

from sqlalchemy import JSON, ColumnElement, Select, Text, cast, select, type_coerce
from sqlalchemy.orm import InstrumentedAttribute, Session, aliased
from sqlalchemy.types import NullType

from galewood_server.storage.models import TABLE_JOBS, Job, Tree

RawRow = tuple[Any, ...]
Row = TypeVar("Row", bound=Tree | Job)
log = logging.getLogger("galewood.rows")
TREE_FIELDS = (
    "id",
    "name",
    "species",
    "builtin",
    "form",
    "grown",
    "height_m",
    "table_sha256",
    "bare_table_sha256",
    "records_sha256",
    "compliance_sha256",
    "mesh_sha256",
    "preliminary",
    "created_at",
    "updated_at",
    "job_id",
    "job_state",
)
"""What `tree_rows` selects: columns of the tree without its report, and two of its newest build job."""
JOB_FIELDS = (
    "id",
    "tree_id",
    "state",
    "stage",
    "fraction",
    "message",
    "seconds_left",
    "samples_done",
    "samples_total",
    "pictures",
    "error",
    "created_at",
    "updated_at",
)
"""What `job_rows` selects."""


def raw_column(column: InstrumentedAttribute[Any]) -> ColumnElement[Any]:
    """A column as it is stored; JSON as its text."""
    raw: ColumnElement[Any] = (
        cast(column, Text) if isinstance(column.type, JSON) else type_coerce(column, NullType())
    )
    return raw.label(column.key)


def tree_rows(*more: InstrumentedAttribute[Any]) -> Select[Any]:
    """Trees as TREE_FIELDS, followed by more columns."""
    other = aliased(Job)
    newest = (
        select(other.id)
        .where(other.tree_id == Tree.id, other.kind.in_(TABLE_JOBS))
        .order_by(other.created_at.desc(), other.id.desc())
        .limit(1)
        .correlate(Tree)
        .scalar_subquery()
    )
    of_tree = [raw_column(getattr(Tree, name)) for name in TREE_FIELDS if not name.startswith("job_")]
    of_job = [raw_column(Job.id).label("job_id"), raw_column(Job.state).label("job_state")]
    return select(*of_tree, *of_job, *map(raw_column, more)).outerjoin(Job, Job.id == newest)


def job_rows() -> Select[Any]:
    """Build jobs as JOB_FIELDS."""
    return select(*(raw_column(getattr(Job, name)) for name in JOB_FIELDS)).where(Job.kind.in_(TABLE_JOBS))


def readable_rows(session: Session, kind: type[Row], *conditions: ColumnElement[bool]) -> Iterator[Row]:
    """The objects of all rows that meet the conditions; rows that cannot be read are left out and logged."""
    for name in session.scalars(select(kind.id).where(*conditions).order_by(kind.created_at, kind.id)).all():
        try:
            row = session.get(kind, name)
        except (ValueError, TypeError) as error:  # of a stored time or JSON document
            log.error("the record %a of %s is damaged and left out: %a", name, kind.__tablename__, str(error))
            continue
        if row is not None:
            yield row

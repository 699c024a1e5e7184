"""Leases of jobs, pictures and preliminary tables of builds, comparisons of a table with its model."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0002"
down_revision = "0001"
branch_labels = None
depends_on = None

TREES = (
    sa.Column("model_sha256", sa.String(64)),
    sa.Column("preliminary", sa.Boolean, nullable=False, server_default=sa.false()),
)
JOBS = (
    sa.Column("kind", sa.String(16), nullable=False, server_default="build"),
    sa.Column("samples_done", sa.Integer),
    sa.Column("samples_total", sa.Integer),
    sa.Column("pictures", sa.JSON, nullable=False, server_default="{}"),
    sa.Column("result", sa.JSON),
    sa.Column("result_sha256", sa.String(64)),
    sa.Column("owner", sa.String(64)),
    sa.Column("lease", sa.String(64)),
    sa.Column("lease_until", sa.DateTime(timezone=True)),
)


def upgrade() -> None:
    for table, columns in (("trees", TREES), ("jobs", JOBS)):
        for column in columns:
            op.add_column(table, column.copy())


def downgrade() -> None:
    for table, columns in (("trees", TREES), ("jobs", JOBS)):
        with op.batch_alter_table(table) as batch:
            for column in columns:
                batch.drop_column(column.name)

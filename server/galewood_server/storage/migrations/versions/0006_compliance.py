"""Compliance files, for pulling a tree at a point."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0006"
down_revision = "0005"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("trees", sa.Column("compliance_sha256", sa.String(64)))


def downgrade() -> None:
    with op.batch_alter_table("trees") as table:
        table.drop_column("compliance_sha256")

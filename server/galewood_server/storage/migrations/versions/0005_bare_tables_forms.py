"""Tables of trees without their leaves, and the forms of built-in species."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0005"
down_revision = "0004"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("trees", sa.Column("bare_table_sha256", sa.String(64)))
    op.add_column("trees", sa.Column("form", sa.String(16), nullable=False, server_default="open"))


def downgrade() -> None:
    with op.batch_alter_table("trees") as table:
        table.drop_column("form")
        table.drop_column("bare_table_sha256")

"""Records of the paper's state search, in a file of their own."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0004"
down_revision = "0003"
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.add_column("trees", sa.Column("records_sha256", sa.String(64)))


def downgrade() -> None:
    with op.batch_alter_table("trees") as table:
        table.drop_column("records_sha256")

"""Trees, jobs, garbage and shared forests."""

from __future__ import annotations

import sqlalchemy as sa
from alembic import op

revision = "0001"
down_revision = None
branch_labels = None
depends_on = None


def upgrade() -> None:
    op.create_table(
        "trees",
        sa.Column("id", sa.String(64), primary_key=True),
        sa.Column("name", sa.String(200), nullable=False),
        sa.Column("species", sa.String(64)),
        sa.Column("builtin", sa.Boolean, nullable=False),
        sa.Column("height_m", sa.Float),
        sa.Column("filename", sa.String(255), nullable=False),
        sa.Column("options", sa.JSON, nullable=False),
        sa.Column("report", sa.JSON, nullable=False),
        sa.Column("source_sha256", sa.String(64), nullable=False),
        sa.Column("mesh_sha256", sa.String(64)),
        sa.Column("import_sha256", sa.String(64)),
        sa.Column("beams_sha256", sa.String(64)),
        sa.Column("table_sha256", sa.String(64)),
        sa.Column("fingerprint", sa.String(64)),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("updated_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("model_sha256", sa.String(64)),
        sa.Column("preliminary", sa.Boolean, nullable=False, server_default=sa.false()),
        sa.Column("records_sha256", sa.String(64)),
        sa.Column("bare_table_sha256", sa.String(64)),
        sa.Column("form", sa.String(16), nullable=False, server_default="open"),
        sa.Column("grown", sa.Boolean, nullable=False, server_default=sa.false()),
        sa.Column("compliance_sha256", sa.String(64)),
    )
    op.create_table(
        "jobs",
        sa.Column("id", sa.String(64), primary_key=True),
        sa.Column("tree_id", sa.String(64), sa.ForeignKey("trees.id", ondelete="CASCADE"), nullable=False),
        sa.Column("state", sa.String(16), nullable=False),
        sa.Column("stage", sa.String(32), nullable=False),
        sa.Column("fraction", sa.Float, nullable=False),
        sa.Column("message", sa.Text, nullable=False),
        sa.Column("seconds_left", sa.Float),
        sa.Column("error", sa.Text),
        sa.Column("settings", sa.JSON, nullable=False),
        sa.Column("attempts", sa.Integer, nullable=False),
        sa.Column("cancel_requested", sa.Boolean, nullable=False),
        sa.Column("created_at", sa.DateTime(timezone=True), nullable=False),
        sa.Column("updated_at", sa.DateTime(timezone=True), nullable=False),
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
    op.create_index("ix_jobs_tree_id", "jobs", ["tree_id"])
    op.create_index("ix_jobs_state", "jobs", ["state"])
    op.create_table(
        "retired",
        sa.Column("id", sa.Integer, primary_key=True),
        sa.Column("kind", sa.String(16), nullable=False),
        sa.Column("sha256", sa.String(64), nullable=False),
        sa.Column("retired_at", sa.DateTime(timezone=True), nullable=False),
    )
    op.create_index("ix_retired_retired_at", "retired", ["retired_at"])
    op.create_table(
        "shared_forests",
        sa.Column("share", sa.String(64), primary_key=True),
        sa.Column("server_url", sa.String(255), nullable=False),
        sa.Column("lease", sa.String(64), nullable=False),
        sa.Column("lease_until", sa.DateTime(timezone=True), nullable=False),
    )


def downgrade() -> None:
    for table in ("shared_forests", "retired", "jobs", "trees"):
        op.drop_table(table)

"""The files of a tree: the columns that hold their hashes, and their stores.

The row of a tree is the manifest of its files (docs/design/0030-files-of-a-tree.md).
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from sqlalchemy import or_, select

from galewood_server.storage.database import Sessions
from galewood_server.storage.models import Tree

if TYPE_CHECKING:
    from galewood.pipeline.results import BuildResult

FILE_COLUMNS = {
    "source_sha256": "sources",
    "mesh_sha256": "meshes",
    "import_sha256": "imports",
    "beams_sha256": "tables",
    "table_sha256": "tables",
    "bare_table_sha256": "tables",
    "records_sha256": "records",
    "compliance_sha256": "compliances",
    "model_sha256": "models",
}
"""Column of a tree -> store of the file whose hash it holds."""
IMPORT_COLUMNS = ("import_sha256", "beams_sha256")
"""Columns of the files that an import leaves for the first build; its table replaces them."""
FOLLOWING_COLUMNS = ("records_sha256", "bare_table_sha256", "compliance_sha256")
"""Columns of the files that follow a complete table."""
ANALYSIS_INPUTS = ("table_sha256", "records_sha256", "model_sha256", "mesh_sha256")
"""Columns of the files that an analysis reads."""


def no_table() -> dict[str, str | None]:
    """The columns of everything that belongs to one table, without a file."""
    return dict.fromkeys(("table_sha256", "model_sha256", *FOLLOWING_COLUMNS))


def files_of(result: BuildResult, model: bytes | None = None) -> dict[str, bytes]:
    """The files of a build's result and its model: column -> content; without those that it lacks."""
    files = {
        "mesh_sha256": result.render_glb,
        "table_sha256": result.table,
        "bare_table_sha256": result.bare_table,
        "records_sha256": result.records,
        "compliance_sha256": result.compliance,
        "model_sha256": model,
    }
    return {column: content for column, content in files.items() if content}


def records_of(sessions: Sessions, table_sha256: str) -> str | None:
    """Hash of the records file of a table; None if there is none."""
    with sessions() as session:
        return session.scalars(
            select(Tree.records_sha256).where(
                Tree.table_sha256 == table_sha256, Tree.records_sha256.is_not(None)
            )
        ).first()


def compliance_of(sessions: Sessions, table_sha256: str) -> str | None:
    """Hash of the compliance file of a table's tree, in leaf or bare; None if there is none."""
    with sessions() as session:
        of_table = or_(Tree.table_sha256 == table_sha256, Tree.bare_table_sha256 == table_sha256)
        return session.scalars(
            select(Tree.compliance_sha256).where(of_table, Tree.compliance_sha256.is_not(None))
        ).first()

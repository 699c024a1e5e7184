"""The result of a build."""

from __future__ import annotations

import gzip
import zlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from galewood.table import decode, encode
from galewood.util import write_atomically


@dataclass(frozen=True)
class BuildResult:
    """The files of a tree, and a JSON-able report of all assumptions and measurements.

    They stay separate files (docs/design/0030-files-of-a-tree.md).
    """

    table: bytes
    records: bytes | None
    """The records file of the paper's state search; None: not computed, or not yet."""
    render_glb: bytes
    report: dict[str, Any]
    bare_table: bytes | None = None
    """The table of the same mesh without its leaves; None: not wanted, not computed yet, or no leaves."""
    compliance: bytes | None = None
    """The compliance file, for pulling the tree and for MuJoCo; None: unstable at rest, or too many nodes."""

    def whole_table(self) -> bytes:
        """The table file with the records inside, for use outside the service."""
        return encode(decode(self.table, self.records)) if self.records else self.table


def bare_path(table: Path) -> Path:
    """Where the bare table of a tree is kept: tree.bare.gwt beside tree.gwt."""
    return table.with_name(f"{table.stem}.bare{table.suffix}")


def compliance_path(table: Path) -> Path:
    """Where the compliance file of a tree is kept: tree.compliance.gz beside tree.gwt and tree.bare.gwt."""
    return table.with_name(f"{table.stem.removesuffix('.bare')}.compliance.gz")


def write_compliance(table: Path, compliance: bytes) -> None:
    """Write the compliance file of a tree beside its table."""
    write_atomically(compliance_path(table), gzip.compress(compliance, 9, mtime=0))


def read_compliance(table: Path) -> bytes | None:
    """The compliance file beside a table; None: there is none, or it is damaged."""
    try:
        return gzip.decompress(compliance_path(table).read_bytes())
    except (OSError, EOFError, zlib.error):
        return None

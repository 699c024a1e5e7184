"""Scanned trees as quantitative structure models; in: the bytes of a file; out: wood and leaves as meshes.

What recognises a file is cheap to import; what reads it is loaded when it is first used.
"""

from typing import TYPE_CHECKING

from galewood.formats.qsm.tables import has_cylinder_columns
from galewood.formats.qsm.treeqsm import HDF5_HEADER
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.formats.qsm.branches import Line
    from galewood.formats.qsm.reading import ScannedTree, read_qsm
    from galewood.formats.qsm.tubes import tube

__getattr__ = lazily(
    __name__,
    {
        "Line": "galewood.formats.qsm.branches",
        "ScannedTree": "galewood.formats.qsm.reading",
        "read_qsm": "galewood.formats.qsm.reading",
        "tube": "galewood.formats.qsm.tubes",
    },
)
__all__ = ["HDF5_HEADER", "Line", "ScannedTree", "has_cylinder_columns", "read_qsm", "tube"]

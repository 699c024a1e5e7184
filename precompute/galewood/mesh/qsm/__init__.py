"""Scanned trees as quantitative structure models; in: the bytes of a file; out: wood and leaves as meshes.

What recognises a file is cheap to import; what reads it is loaded when it is first used.
"""

from typing import TYPE_CHECKING

from galewood.mesh.qsm.tables import has_cylinder_columns
from galewood.mesh.qsm.treeqsm import HDF5_HEADER
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.mesh.qsm.branches import Line
    from galewood.mesh.qsm.reading import ScannedTree, read_qsm
    from galewood.mesh.qsm.tubes import tube

__getattr__ = lazily(
    __name__,
    {
        "Line": "galewood.mesh.qsm.branches",
        "ScannedTree": "galewood.mesh.qsm.reading",
        "read_qsm": "galewood.mesh.qsm.reading",
        "tube": "galewood.mesh.qsm.tubes",
    },
)
__all__ = ["HDF5_HEADER", "Line", "ScannedTree", "has_cylinder_columns", "read_qsm", "tube"]

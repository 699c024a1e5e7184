"""Scanned trees as quantitative structure models; in: the bytes of a file; out: wood and leaves as meshes.

What recognises a file is cheap to import; what reads it is loaded when it is first used.
"""

from typing import TYPE_CHECKING

from galewood.mesh.qsm.tables import has_cylinder_columns
from galewood.mesh.qsm.treeqsm import HDF5
from galewood.util import lazily

if TYPE_CHECKING:
    from galewood.mesh.qsm.reading import ScannedTree, read_qsm

__getattr__ = lazily(__name__, dict.fromkeys(("ScannedTree", "read_qsm"), "galewood.mesh.qsm.reading"))
__all__ = ["HDF5", "ScannedTree", "has_cylinder_columns", "read_qsm"]

"""Scanned trees as quantitative structure models; in: the bytes of a file; out: wood and leaves as meshes."""

from galewood.mesh.qsm.reading import ScannedTree, read_qsm
from galewood.mesh.qsm.tables import has_cylinder_columns
from galewood.mesh.qsm.treeqsm import HDF5

__all__ = ["HDF5", "ScannedTree", "has_cylinder_columns", "read_qsm"]

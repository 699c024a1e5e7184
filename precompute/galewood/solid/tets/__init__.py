"""Tetrahedral meshing; in: the wood surface of a TreeMesh; out: a connected TetMesh."""

from galewood.solid.tets.meshing import (
    MIN_RADIUS_SHARE,
    TetMesh,
    cached_tetrahedra_path,
    joined_surface,
    tetrahedralise,
)
from galewood.solid.tets.quality import FACES_OF_TET, boundary_faces, tet_volumes
from galewood.solid.tets.radius_ratio import scattered, scattered_weights

__all__ = [
    "FACES_OF_TET",
    "MIN_RADIUS_SHARE",
    "TetMesh",
    "boundary_faces",
    "cached_tetrahedra_path",
    "joined_surface",
    "scattered",
    "scattered_weights",
    "tet_volumes",
    "tetrahedralise",
]

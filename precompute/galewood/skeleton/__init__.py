"""Branch skeleton; in: a TetMesh; out: branches with radii, fibre direction of every tetrahedron."""

from galewood.skeleton.extraction import Skeleton, extract_skeleton, sampled_elements
from galewood.skeleton.radius_correction import with_corrected_radii
from galewood.skeleton.roots import CLAMPED_SHARE, root_vertices

__all__ = [
    "CLAMPED_SHARE",
    "Skeleton",
    "extract_skeleton",
    "root_vertices",
    "sampled_elements",
    "with_corrected_radii",
]

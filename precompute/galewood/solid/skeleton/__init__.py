"""Branch skeleton; in: a TetMesh, or just the surface of the wood; out: branches with radii, and the fibre
direction of every tetrahedron."""

from galewood.solid.skeleton.centre import branch_lines
from galewood.solid.skeleton.extraction import Skeleton, extract_skeleton, sampled_elements
from galewood.solid.skeleton.joined_limbs import is_chained, joined_outline
from galewood.solid.skeleton.outline import Outline, outline_of
from galewood.solid.skeleton.radius_correction import with_corrected_radii
from galewood.solid.skeleton.roots import CLAMPED_SHARE, root_vertices
from galewood.solid.skeleton.structure import structure_limited
from galewood.solid.skeleton.tree import branches as longest_branches

__all__ = [
    "CLAMPED_SHARE",
    "Outline",
    "Skeleton",
    "branch_lines",
    "extract_skeleton",
    "is_chained",
    "joined_outline",
    "longest_branches",
    "outline_of",
    "root_vertices",
    "sampled_elements",
    "structure_limited",
    "with_corrected_radii",
]

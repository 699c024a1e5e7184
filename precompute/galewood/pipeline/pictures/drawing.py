"""The pictures of a build, as functions that load Matplotlib only in the process that draws."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from galewood.solid.skeleton import Skeleton
from galewood.solid.tets import TetMesh
from galewood.util import Ints


def tetrahedra_png(mesh: TetMesh) -> bytes:
    """PNG of the wood's surface, with a close-up of the tetrahedra inside the first fork."""
    from galewood.pipeline.pictures import build_pictures

    return build_pictures.tetrahedra_png(mesh)


def skeleton_png(
    mesh: TetMesh, skeleton: Skeleton, sampled: Ints, added: NDArray[np.bool_] | None = None
) -> bytes:
    """PNG of the skeleton inside the wood from two sides, with the sampled elements."""
    from galewood.pipeline.pictures import build_pictures

    return build_pictures.skeleton_png(mesh, skeleton, sampled, added)

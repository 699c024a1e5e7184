"""Which parts of a tree are wood that was added and is not drawn."""

from __future__ import annotations

import numpy as np
from scipy.spatial import KDTree

from galewood.solid.skinning import edge_samples
from galewood.tree import TreeMesh
from galewood.util import Floats

SAMPLES_PER_HEIGHT = 200
"""The surfaces are sampled at this fraction of the height."""


def in_added_wood(tree: TreeMesh, points_m: Floats) -> np.ndarray:
    """(p,) whether points (p, 3) in the wood are nearer to added wood than to wood that is drawn."""
    added, drawn = tree.added_wood(), tree.drawn_wood()
    if added is None:
        return np.zeros(len(points_m), dtype=bool)
    if not len(drawn.faces):
        return np.ones(len(points_m), dtype=bool)
    near, far = (edge_samples(part, tree.height_m / SAMPLES_PER_HEIGHT).place_m for part in (added, drawn))
    return np.asarray(KDTree(near).query(points_m)[0] < KDTree(far).query(points_m)[0])

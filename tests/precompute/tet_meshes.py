"""Tetrahedral meshes of known shape without a mesher: a bar and a Y, cut from a grid of cubes; a drawn Y."""

import numpy as np
from galewood.solid.tets.meshing import TetMesh
from galewood.solid.tets.quality import largest_component
from galewood.tree.repair import Surface
from galewood.tree.types import TreeMesh

from tests.precompute import tree_meshes as make

# A cube as six tets around its diagonal (Kuhn); corners are numbered by the bits x, y, z.
KUHN = np.array([[0, 1, 3, 7], [0, 3, 2, 7], [0, 2, 6, 7], [0, 6, 4, 7], [0, 4, 5, 7], [0, 5, 1, 7]])


def grid_mesh(holds, low, high, cell) -> TetMesh:
    """The largest component of all tets of a cubic grid whose centre satisfies `holds` (k, 3) -> (k,)."""
    counts = np.round((np.array(high) - low) / cell).astype(int)
    corner = np.stack(np.meshgrid(*(np.arange(n + 1) for n in counts), indexing="ij"), axis=-1).reshape(-1, 3)
    base = np.stack(np.meshgrid(*(np.arange(n) for n in counts), indexing="ij"), axis=-1).reshape(-1, 3)
    bits = np.array([[i & 1, i >> 1 & 1, i >> 2 & 1] for i in range(8)])
    step = np.array([(counts[1] + 1) * (counts[2] + 1), counts[2] + 1, 1])
    tets = ((base[:, None] + bits) @ step)[:, KUHN].reshape(-1, 4)
    vertices = np.array(low) + corner * cell
    tets = tets[holds(vertices[tets].mean(axis=1))]
    vertices, tets, _ = largest_component(vertices.astype(float), tets)
    return TetMesh(vertices, tets.astype(np.int32), np.ones(len(tets)), {})


def near_segment(points, start, end, radius):
    start, along = np.array(start, float), np.array(end, float) - start
    share = np.clip((points - start) @ along / (along @ along), 0, 1)
    return np.linalg.norm(points - start - share[:, None] * along, axis=1) <= radius


Y_SEGMENTS = (
    ((0, 0, 0), (0, 3, 0), 0.22),
    ((0, 2.5, 0), (1.6, 4.1, 0), 0.15),
    ((0, 2.5, 0), (-1.2, 4.6, 0), 0.15),
)


def y_mesh(cell=0.07) -> TetMesh:
    """A Y of three round limbs along Y_SEGMENTS; the base of the trunk is cut flat at y = 0."""

    def holds(points):
        return (points[:, 1] > 0) & np.any([near_segment(points, *s) for s in Y_SEGMENTS], axis=0)

    return grid_mesh(holds, (-1.61, 0, -0.35), (1.89, 4.9, 0.35), cell)


def y_tree_mesh(leaves: Surface | None = None) -> TreeMesh:
    """A drawn tree around the Y, with leaves or without."""
    wood = make.joined(*(make.tube(a, b, r, r) for a, b, r in Y_SEGMENTS))
    return make.as_tree(wood, leaves)


def leaf_cards(count=60, seed=11) -> Surface:
    """Leaf cards at random places around the upper limbs of the Y."""
    random = np.random.default_rng(seed)
    return make.cards(random.uniform((-1, 3, -0.5), (1.5, 5, 0.5), (count, 3)), size=0.2)

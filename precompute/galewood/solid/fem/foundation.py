"""A root plate that yields: springs on the base instead of clamped nodes.

Every node of the base is held by a spring of the same stiffness in all directions. The springs are
distributed like the area of the base, with a slight correction so that their resistance to tilting is the
same about every horizontal axis. Their sum follows from the rotational stiffness about their centre,
k_θ = Σ k_i (y_i² + z_i²) = Σ k_i (y_i² + x_i²). Shifting the base is then stiffer than tilting the tree by
(height / radius of gyration of the base)², some 10⁴, so that the tree does not shift noticeably. For
k_θ → ∞ the base is clamped.
"""

from dataclasses import replace

import numpy as np
from scipy.optimize import nnls

from galewood.solid.fem.elements.quadratic import midside_parents
from galewood.solid.fem.model import FemModel
from galewood.util import Floats, Int32s

FACES = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))
EXACT_WEIGHT = 1e4
"""Weight of the conditions on the springs where some would have to be negative."""


def with_root_springs(model: FemModel, root_stiffness_nm_rad: float) -> FemModel:
    """The model on a root plate of this rotational stiffness, N·m/rad, instead of clamped nodes."""
    springs = np.zeros(len(model.nodes_m))
    springs[model.fixed] = base_springs(model, root_stiffness_nm_rad)
    return replace(model, fixed=np.zeros(0, np.int32), foundation_n_m=springs)


def with_ground_reaction(model: FemModel, u_m: Floats) -> Floats:
    """(N,3) N: weight and the constant force of the ground on a base whose springs are displaced by u (N,3).

    For a shape that is already loaded: there the springs have no displacement, yet support the tree.
    """
    if model.foundation_n_m is None:
        return model.gravity_n
    return model.gravity_n - model.foundation_n_m[:, None] * u_m


def base_springs(model: FemModel, root_stiffness_nm_rad: float) -> Floats:
    """(k,) N/m: the springs at the model's fixed nodes."""
    area = _areas(model)
    place = model.nodes_m[model.fixed]
    x, y, z = (place - area @ place / area.sum()).T
    share = area * _isotropic(area, x, z)
    centre = share @ y / share.sum()
    resistance = share @ ((x**2 + z**2) / 2 + (y - centre) ** 2)
    return share * (root_stiffness_nm_rad / resistance)


def _areas(model: FemModel) -> Floats:
    """(k,) horizontal area that belongs to each fixed node: of the faces between fixed nodes, projected.

    A midside node gets the mean of its two corners.
    """
    held = np.zeros(len(model.nodes_m), np.bool_)
    held[model.fixed] = True
    corners = model.elements[:, :4]
    faces = np.unique(np.sort(corners[:, FACES].reshape(-1, 3), axis=1), axis=0)
    faces = faces[held[faces].all(axis=1)]
    edges = model.nodes_m[faces[:, 1:]] - model.nodes_m[faces[:, :1]]
    projected = np.abs(np.cross(edges[:, 0], edges[:, 1])[:, 1]) / 2
    area = np.bincount(faces.ravel(), np.repeat(projected / 3, 3), len(held)).astype(np.float64)
    if model.elements.shape[1] == 10:
        parents: Int32s = midside_parents(model.vertex_count, model.elements)
        area[model.vertex_count :] = area[parents].mean(axis=1)
    found = area[model.fixed]
    return found if found.sum() > 0 else np.ones(len(found))


def _isotropic(area: Floats, x: Floats, z: Floats) -> Floats:
    """(k,) factors near 1, not negative, with Σ a f (x, z, x² − z², x z) = 0; x and z from the centroid."""
    size = np.sqrt(area @ (x**2 + z**2) / area.sum())
    conditions = np.stack([x / size, z / size, (x**2 - z**2) / size**2, x * z / size**2])
    weighted = conditions * area
    factors = 1 + conditions.T @ np.linalg.lstsq(weighted @ conditions.T, -weighted.sum(axis=1))[0]
    if factors.min() >= 0:
        return factors
    root = np.sqrt(area / area.sum())
    rows = np.concatenate([np.diag(root), EXACT_WEIGHT * weighted / area.sum()])
    return nnls(rows, np.concatenate([root, np.zeros(4)]))[0]

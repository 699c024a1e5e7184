"""Contribution of the rest-pose stress to the tangent: the moment of the weight caused by sway (P–Δ effect).

The corotational tangent keeps each element's rotation fixed and so omits it. For an element of mean stress σ,
it is V (∇λ_i · σ ∇λ_j) I for each pair of corners. Because the corner forces are f_j = V σ ∇λ_j, it equals
∇λ_i · f_j and needs no stress. The values are invariant under rotation of the element, so they are computed
once, in the rest pose.
"""

import numpy as np

from galewood.solid.fem.elements.elasticity import PAIRS
from galewood.solid.fem.elements.quadratic import EDGES
from galewood.solid.fem.model import FemModel
from galewood.util import Floats


def rest_prestress(model: FemModel) -> Floats:
    """(m,10) N/m for the corner pairs of each element, of the strain that the given shape has."""
    if model.strain_m is None:
        return np.zeros((len(model.elements), 10))
    away = _strained(model, model.strain_m)
    force = np.zeros_like(away)
    for p, (i, j) in enumerate(PAIRS):
        force[:, i] += np.einsum("eij,ej->ei", model.blocks[:, p], away[:, j])
        if i != j:
            force[:, j] += np.einsum("eji,ej->ei", model.blocks[:, p], away[:, i])
    return np.stack([np.einsum("ek,ek->e", model.grad[:, i], force[:, j]) for i, j in PAIRS], axis=1)


def _strained(model: FemModel, strain_m: Floats) -> Floats:
    """(m,4,3) displacements of the corners by the mean strain of each element.

    Those of a quadratic element's own corners would include the shear with which a linear one locks.
    """
    rest = model.nodes_m[model.elements[:, :4]]
    return np.einsum("eij,eaj->eai", _gradient(strain_m, model.grad), rest - rest[:, :1])


def strain_displacements(model: FemModel, u_m: Floats) -> Floats:
    """(m, 4|10, 3) displacements u (N,3) of each element's nodes, m, without its infinitesimal rotation."""
    nodes, moved = model.nodes_m[model.elements], u_m[model.elements]
    gradient = _gradient(moved, model.grad)
    spin = (gradient - gradient.transpose(0, 2, 1)) / 2
    return (moved - moved[:, :1]) - np.einsum("eij,eaj->eai", spin, nodes - nodes[:, :1])


def _gradient(u: Floats, grad: Floats) -> Floats:
    """(m,3,3) mean gradient of displacements u (m, 4|10, 3) of the nodes of each element."""
    if u.shape[1] == 4:
        return np.einsum("eai,eaj->eij", u, grad)
    # The mean gradient of a quadratic shape function is zero at a corner and, at a midside node, the sum
    # of those of its two corners.
    total = np.zeros((len(u), 3, 3))
    for k, (i, j) in enumerate(EDGES):
        total += np.einsum("ei,ej->eij", u[:, 4 + k], grad[:, i] + grad[:, j])
    return total

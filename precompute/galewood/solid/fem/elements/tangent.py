"""The part of the tangent that the corotational stiffness omits: elements turn with their stress.

Between nodes a and b of an element it is ∫ ∇N_a · σ ∇N_b dV I. For a linear element, whose shape functions
are the barycentric coordinates λ, this is the prestress of `prestress.py`, which the motion keeps from the
rest pose. Static solutions compute it for every pose, and for quadratic elements with the stress at four
points of each element, since their stress varies by more than its mean in a bent branch.
"""

from functools import cache
from typing import TYPE_CHECKING

import numba
import numpy as np
from numpy.typing import NDArray

from galewood.solid.fem.elements.quadratic import EDGES
from galewood.solid.fem.elements.rotation import Nine, nearest_rotation
from galewood.solid.fem.solver import JIT
from galewood.util import Floats, Int32s

if TYPE_CHECKING:
    from galewood.solid.fem.elements.assembly import ElementSystem


def stress_terms(system: "ElementSystem", u: Floats, w: Floats) -> Floats:
    """(m, pairs) N/m: ∫ ∇N_a · σ ∇N_b dV of each element's node pairs a ≤ b, at u and stressed also by w.

    u and w (N,3), m, are in internal order. Rotations are those at u; w stretches the elements linearly.
    """
    width = system.elements.shape[1]
    terms = np.zeros((len(system.elements), width * (width + 1) // 2))
    shape = (system.rest, system.elements, system.grad, system.blocks, system.strain)
    _stress_terms(shape_gradients(width), *shape, u, w, terms)
    return terms


def add_stress_terms(system: "ElementSystem", terms: Floats) -> None:
    """Add the terms (m, pairs) to the matrix that the system has assembled."""
    _add_terms(system.slots, terms, system.values)


@cache
def shape_gradients(width: int) -> Floats:
    """(points, width, 4): ∇N_a = Σ_i c_ai ∇λ_i at the integration points, which have equal weights.

    One point for linear elements, the four of the rule of degree 2 for quadratic ones.
    """
    if width == 4:
        return np.eye(4)[None]
    near, far = (5 + 3 * np.sqrt(5)) / 20, (5 - np.sqrt(5)) / 20
    gradients = np.zeros((4, 10, 4))
    for point, c in enumerate(gradients):
        place = np.full(4, far)
        place[point] = near
        c[range(4), range(4)] = 4 * place - 1
        for k, (i, j) in enumerate(EDGES):
            c[4 + k, i], c[4 + k, j] = 4 * place[j], 4 * place[i]
    return gradients


@numba.njit(**JIT)
def _rotation(elements: Int32s, grad: Floats, e: int, u: Floats) -> Nine:
    """Rotation of an element, as in `assembly.py`: from its four corners."""
    h = np.zeros((3, 3))
    for a in range(1, 4):
        for i in range(3):
            difference = u[elements[e, a], i] - u[elements[e, 0], i]
            for j in range(3):
                h[i, j] += difference * grad[e, a, j]
    return nearest_rotation((h[0, 0], h[0, 1], h[0, 2], h[1, 0], h[1, 1], h[1, 2], h[2, 0], h[2, 1], h[2, 2]))


@numba.njit(**JIT)
def _stretch(
    c: Floats, elements: Int32s, grad: Floats, e: int, r: Nine, u: Floats, w: Floats, h: Floats
) -> None:
    """h (3,3) ← Rᵀ (I + ∇u + ∇w) − I at a point with the shape gradients c (width, 4)."""
    g = np.eye(3)
    n0 = elements[e, 0]
    for a in range(elements.shape[1]):
        n = elements[e, a]
        for j in range(3):
            slope = 0.0
            for k in range(4):
                slope += c[a, k] * grad[e, k, j]
            for i in range(3):
                g[i, j] += (u[n, i] - u[n0, i] + w[n, i] - w[n0, i]) * slope
    for j in range(3):
        h[0, j] = r[0] * g[0, j] + r[3] * g[1, j] + r[6] * g[2, j]
        h[1, j] = r[1] * g[0, j] + r[4] * g[1, j] + r[7] * g[2, j]
        h[2, j] = r[2] * g[0, j] + r[5] * g[1, j] + r[8] * g[2, j]
        h[j, j] -= 1.0


@numba.njit(**JIT)
def _corner_terms(
    rest: Floats, elements: Int32s, grad: Floats, blocks: Floats, strain: Floats, e: int, h: Floats, t: Floats
) -> None:
    """t (4,4) ← V ∇λ_i · σ ∇λ_j under the displacement gradient h, from the forces on the corners."""
    d, f = np.zeros((4, 3)), np.zeros((4, 3))
    for a in range(1, 4):
        for i in range(3):
            d[a, i] = strain[e, a, i] - strain[e, 0, i]
            for j in range(3):
                d[a, i] += h[i, j] * (rest[elements[e, a], j] - rest[elements[e, 0], j])
    p = 0
    for a in range(4):
        for b in range(a, 4):
            for i in range(3):
                for j in range(3):
                    f[a, i] += blocks[e, p, 3 * i + j] * d[b, j]
                    if a != b:
                        f[b, j] += blocks[e, p, 3 * i + j] * d[a, i]
            p += 1
    for a in range(4):
        for b in range(4):
            t[a, b] = grad[e, a, 0] * f[b, 0] + grad[e, a, 1] * f[b, 1] + grad[e, a, 2] * f[b, 2]


@numba.njit(**JIT)
def _stress_terms(
    gradients: Floats,
    rest: Floats,
    elements: Int32s,
    grad: Floats,
    blocks: Floats,
    strain: Floats,
    u: Floats,
    w: Floats,
    terms: Floats,
) -> None:
    points, width = gradients.shape[0], gradients.shape[1]
    h, t, half = np.empty((3, 3)), np.empty((4, 4)), np.empty(4)
    for e in range(len(elements)):
        r = _rotation(elements, grad, e, u)
        for point in range(points):
            c = gradients[point]
            _stretch(c, elements, grad, e, r, u, w, h)
            _corner_terms(rest, elements, grad, blocks, strain, e, h, t)
            p = 0
            for a in range(width):
                for j in range(4):
                    half[j] = 0.0
                    for i in range(4):
                        half[j] += c[a, i] * t[i, j] / points
                for b in range(a, width):
                    for j in range(4):
                        terms[e, p] += half[j] * c[b, j]
                    p += 1


@numba.njit(**JIT)
def _add_terms(slots: NDArray[np.int32], terms: Floats, values: Floats) -> None:
    for e in range(len(slots)):
        for p in range(slots.shape[1]):
            values[slots[e, p], 0] += terms[e, p]
            values[slots[e, p], 4] += terms[e, p]
            values[slots[e, p], 8] += terms[e, p]

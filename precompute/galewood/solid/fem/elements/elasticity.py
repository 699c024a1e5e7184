"""Element stiffness of straight-sided tetrahedra of transversely isotropic wood.

The tangent of a linear tetrahedron is stored as its ten distinct 3 × 3 blocks K_ij, i ≤ j (in the order of
`PAIRS`), split into the *axial* part (strain along and across the fibre) and the *shear* part (shear between
fibre and cross-section, the energy of torsion). The blocks of a quadratic tetrahedron are constant
combinations of the same ten (`quadratic.py`), and the fitted linear element scales the two parts
(`calibration.py`).
"""

from typing import NamedTuple

import numpy as np

from galewood.util import Floats
from galewood.wood import Wood

PAIRS: tuple[tuple[int, int], ...] = tuple((i, j) for i in range(4) for j in range(i, 4))


class Moduli(NamedTuple):
    """Coefficients, Pa, of the five invariants of a transversely isotropic solid (Spencer 1984)."""

    lam: float
    mu_t: float
    mu_l: float
    alpha: float
    beta: float


def moduli(wood: Wood) -> Moduli:
    """Spencer's coefficients of a wood, from its engineering constants."""
    e_l, e_t = wood.young_longitudinal_pa, wood.young_transverse_pa
    nu_l, nu_t = wood.poisson_longitudinal, wood.poisson_transverse
    compliance = np.array(
        [
            [1 / e_t, -nu_t / e_t, -nu_l / e_l],
            [-nu_t / e_t, 1 / e_t, -nu_l / e_l],
            [-nu_l / e_l, -nu_l / e_l, 1 / e_l],
        ]
    )
    c = np.linalg.inv(compliance)
    mu_t, mu_l = wood.shear_transverse_pa, wood.shear_longitudinal_pa
    lam, alpha = float(c[0, 1]), float(c[0, 2] - c[0, 1])
    beta = float(c[2, 2]) - lam - 2 * alpha - 4 * mu_l + 2 * mu_t
    return Moduli(lam, mu_t, mu_l, alpha, beta)


def gradients(corners_m: Floats) -> tuple[Floats, Floats]:
    """Gradients of the barycentric coordinates (m,4,3), 1/m, and signed volumes (m,), m³, of tets (m,4,3)."""
    edges = corners_m[:, 1:] - corners_m[:, :1]
    volume: Floats = np.linalg.det(edges) / 6
    inner = np.asarray(np.linalg.inv(edges), np.float64).transpose(0, 2, 1)
    return np.concatenate([-inner.sum(axis=1, keepdims=True), inner], axis=1), volume


def stiffness_blocks(grad: Floats, volume_m3: Floats, fibre: Floats, m: Moduli) -> tuple[Floats, Floats]:
    """Axial and shear stiffness blocks, each (elements, 10, 3, 3) in N/m, of undeformed linear tets."""
    axial = np.empty((len(grad), 10, 3, 3))
    shear = np.empty_like(axial)
    for block, (i, j) in enumerate(PAIRS):
        axial[:, block], shear[:, block] = _pair_blocks(grad[:, i], grad[:, j], fibre, m)
    return axial * volume_m3[:, None, None, None], shear * volume_m3[:, None, None, None]


def _pair_blocks(gi: Floats, gj: Floats, a: Floats, m: Moduli) -> tuple[Floats, Floats]:
    """K_ij per unit volume, f_i = σ(sym(u_j ⊗ g_j)) g_i, split into axial and longitudinal-shear parts."""
    pi, pj = _dot(gi, a)[:, None, None], _dot(gj, a)[:, None, None]
    gg = _dot(gi, gj)[:, None, None]
    eye, aa = np.eye(3), _outer(a, a)
    fibre_strain = pi * pj * eye + pi * _outer(gj, a) + pj * _outer(a, gi) + gg * aa
    shear = m.mu_l * (fibre_strain - 4 * pi * pj * aa)
    whole = (
        m.lam * _outer(gi, gj)
        + m.mu_t * (gg * eye + _outer(gj, gi))
        + m.alpha * (pj * _outer(gi, a) + pi * _outer(a, gj))
        + m.beta * pi * pj * aa
        + (m.mu_l - m.mu_t) * fibre_strain
    )
    return whole - shear, shear


def _dot(a: Floats, b: Floats) -> Floats:
    return np.einsum("ek,ek->e", a, b)


def _outer(a: Floats, b: Floats) -> Floats:
    return a[:, :, None] * b[:, None, :]

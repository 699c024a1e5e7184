"""Linear tetrahedra fitted to quadratic ones on the same mesh.

Linear tets lock, by different factors in bending and torsion, and more so on coarser cross-sections. The fit
scales each element's axial and shear stiffness so that the linear mesh responds to static loads like the
quadratic one. The loads are the inertial loads of the quadratic mesh's lowest modes (for frequencies and
shapes), uniform wind, and couples at random positions (for the torsion of twigs). A mode is weighted by 1/ω,
its contribution to sway. The logarithms of the factors are optimised by L-BFGS with the exact gradient: with
K u = f and K λ = ∂J/∂u, ∂J/∂s_e = −λ · K_e u.

Alternative (docs/physics.md): scaling each element by the energy ratio of its patch, with one factor or two,
leaves torsion a quarter too stiff and diverges with further iterations.
"""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from scipy.optimize import minimize

from galewood.solid.fem import PAIRS, ElementSystem, tangent_modes
from galewood.util import Floats, Int32s

MIN_FACTOR, MAX_FACTOR = 0.02, 4.0
"""Bounds of the factors."""
START_FACTOR = 0.3
MODE_COUNT = 32
COUPLE_COUNT = 8
COUPLE_WEIGHT = 0.1
REGULARISATION_WEIGHT = 1e-4
"""Regularisation: weight of the mean squared distance of the logarithms from their start."""


class Target(NamedTuple):
    """Loads (n,3,L) N on the vertices, displacements (n,3,L) m of the quadratic mesh, weights (L,),
    frequencies.

    The frequencies (k,) of the quadratic mesh are in Hz.
    """

    load_n: Floats
    u_m: Floats
    weight: Floats
    frequencies_hz: Floats


class Fit(NamedTuple):
    """Factors (m,) of each element's axial and shear stiffness, and a report."""

    axial: Floats
    shear: Floats
    report: dict[str, Any]

    def apply(self, axial: Floats, shear: Floats) -> Floats:
        """The fitted stiffness blocks (m,10,3,3), N/m."""
        return self.axial[:, None, None, None] * axial + self.shear[:, None, None, None] * shear


def reference_target(
    reference: ElementSystem,
    node_mass_kg: Floats,
    vertex_mass_kg: Floats,
    drag_area_m2: Floats,
    *,
    seed: int = 0,
) -> Target:
    """The target of the fit, from the quadratic mesh.

    Takes the masses of the quadratic mesh's nodes (N,) and of the vertices (n,), kg, and drag areas (n,), m².
    """
    count = len(vertex_mass_kg)
    zero = np.zeros_like(reference.rest)
    modes = min(MODE_COUNT, 3 * reference.free // 2)
    omega, inner = tangent_modes(reference, zero, node_mass_kg[reference.order], modes)
    shapes = np.empty_like(inner)
    shapes[:, reference.order] = inner
    inertia = omega[:, None, None] ** 2 * vertex_mass_kg[:, None] * shapes[:, :count]
    area = drag_area_m2 if drag_area_m2.any() else vertex_mass_kg
    wind = np.eye(3)[[0, 2], None, :] * area[None, :, None]
    vertices = np.empty_like(reference.rest)
    vertices[reference.order] = reference.rest
    load = np.concatenate([inertia, wind, random_couples(vertices[:count], COUPLE_COUNT, seed)])
    weight = np.concatenate([omega[0] / omega, np.ones(2), np.full(COUPLE_COUNT, COUPLE_WEIGHT)])
    wide = np.zeros((len(vertices), 3, len(load)))
    wide[:count] = _last_axis(load)
    reference.assemble(zero, zero, 1.0, np.zeros(len(zero)), zero.copy())
    reference.solver.factorise(reference.values)
    u = solve_loads(reference, wide)[:count]
    return Target(wide[:count], u, weight / weight.sum(), omega / (2 * np.pi))


def fit_factors(
    system: ElementSystem,
    axial: Floats,
    shear: Floats,
    vertex_mass_kg: Floats,
    target: Target,
    *,
    evaluations: int = 48,
) -> Fit:
    """Fit the factors of a linear mesh's axial and shear stiffness blocks, (m,10,3,3) each, to the target."""
    problem = _Problem(system, axial, shear, vertex_mass_kg, target)
    start = np.full(2 * len(axial), np.log(START_FACTOR))
    found = minimize(
        problem.value_and_gradient,
        start,
        jac=True,
        method="L-BFGS-B",
        bounds=[(np.log(MIN_FACTOR), np.log(MAX_FACTOR))] * len(start),
        options={"maxfun": evaluations, "maxcor": 20},
    )
    factors = problem.factors(found.x)
    error = float(np.sqrt(problem.mismatch))
    return Fit(*factors, {"evaluations": int(found.nfev), "displacement_error_rms": error})


class _Problem:
    """The objective as a function of the factors' logarithms (axial first): value and gradient."""

    def __init__(
        self, system: ElementSystem, axial: Floats, shear: Floats, vertex_mass_kg: Floats, target: Target
    ) -> None:
        self.system, self.target = system, target
        self.parts = (axial, shear)
        self.tets = np.empty_like(system.elements)
        self.tets[:] = system.order[system.elements]
        size = np.einsum("n,nil->l", vertex_mass_kg, target.u_m**2)
        self.weight = vertex_mass_kg[:, None, None] * (target.weight / size)
        self.mismatch = np.inf

    def factors(self, x: Floats) -> tuple[Floats, Floats]:
        """Axial and shear factors, (m,) each, from their logarithms."""
        axial, shear = np.exp(x).reshape(2, -1)
        return axial, shear

    def value_and_gradient(self, x: Floats) -> tuple[float, Floats]:
        """Mean relative squared error of the displacements with regularisation, and its gradient."""
        factors = self.factors(x)
        blocks = sum(f[:, None, None, None] * k for f, k in zip(factors, self.parts, strict=True))
        self.system.set_blocks(np.asarray(blocks))
        zero = np.zeros_like(self.system.rest)
        self.system.assemble(zero, zero, 1.0, np.zeros(len(zero)), zero.copy())
        self.system.solver.factorise(self.system.values)
        u = solve_loads(self.system, self.target.load_n)
        off = self.weight * (u - self.target.u_m)
        self.mismatch = float(np.vdot(off, u - self.target.u_m))
        slope = -_gram(self.tets, solve_loads(self.system, 2 * off), u)
        log_gradient = [f * c for f, c in zip(factors, _contract(self.parts, slope), strict=True)]  # ∂/∂log
        offset = x - np.log(START_FACTOR)
        value = self.mismatch + REGULARISATION_WEIGHT * float(np.mean(offset**2))
        return value, np.concatenate(log_gradient) + 2 * REGULARISATION_WEIGHT / len(x) * offset


def _gram(tets: Int32s, a: Floats, b: Floats) -> Floats:
    """(m,4,3,4,3) sums over the loads of products of the elements' nodal values of a and b (n,3,L)."""
    left, right = (f[tets].reshape(len(tets), 12, -1) for f in (a, b))
    return (left @ right.transpose(0, 2, 1)).reshape(len(tets), 4, 3, 4, 3)


def _contract(parts: Sequence[Floats], gram: Floats) -> list[Floats]:
    """(m,) Σ K_ab : G_ab over all node pairs, from the upper blocks of each part."""
    totals = [np.zeros(len(gram)) for _ in parts]
    for p, (i, j) in enumerate(PAIRS):
        both = gram[:, i, :, j, :]
        if i != j:
            both = both + gram[:, j, :, i, :].transpose(0, 2, 1)
        for total, blocks in zip(totals, parts, strict=True):
            total += np.einsum("eij,eij->e", blocks[:, p], both)
    return totals


def random_couples(vertices_m: Floats, count: int, seed: int) -> Floats:
    """(count,n,3) forces that twist a random neighbourhood about a random axis; their resultant is zero."""
    rng = np.random.default_rng(seed)
    height = float(np.ptp(vertices_m[:, 1]))
    load = np.empty((count, *vertices_m.shape))
    for k in range(count):
        centre = vertices_m[rng.integers(len(vertices_m))]
        reach = height * rng.uniform(0.05, 0.3)
        weight = np.exp(-((vertices_m - centre) ** 2).sum(axis=1) / (2 * reach**2))
        centre = weight @ vertices_m / weight.sum()
        axis = rng.normal(size=3)
        load[k] = weight[:, None] * np.cross(axis / np.linalg.norm(axis), vertices_m - centre)
    return load


def solve_loads(system: ElementSystem, load: Floats) -> Floats:
    """Displacements (N,3,L) m under loads (N,3,L) N with the current factor, in mesh order."""
    inner = load[system.order]
    inner[system.free :] = 0
    system.solver.solve_all(inner)
    u = np.empty_like(inner)
    u[system.order] = inner
    return u


def _last_axis(of_loads: Floats) -> Floats:
    """(n,3,L) of (L,n,3)."""
    return np.ascontiguousarray(of_loads.transpose(1, 2, 0))

"""Exact and one-dimensional solutions for bars and poles."""

from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp
from scipy.linalg import eigh
from scipy.optimize import root_scalar

from galewood.solid.model import GRAVITY_M_S2
from galewood.util import Floats


def tip_deflection(force_n: float, length_m: float, young_pa: float, second_moment_m4: float) -> float:
    """Tip deflection of an Euler–Bernoulli cantilever under a force at its tip, m."""
    return force_n * length_m**3 / (3 * young_pa * second_moment_m4)


CLAMPED_NUMBER = 1.8751040687119611
"""First wave number of a clamped pole: cos λ cosh λ = −1."""


class Section(NamedTuple):
    """Stiffness of a uniform beam: bending E I, N m², stretching E A, N, and shear κ G A, N."""

    bending_n_m2: float
    stretching_n: float
    shear_n: float


def elastica_tip(force_n: float, length_m: float, section: Section) -> tuple[float, float]:
    """Tip of a standing cantilever under a horizontal dead force of any size: sway and height, m.

    The elastica with stretching and shear (Reissner 1972): the section at arc length s is turned by θ, with
    E I θ'' = −(V (1 + N / EA) − N V / GA), N = P sin θ, V = P cos θ, θ(0) = 0 and θ'(L) = 0. Shooting from
    the foot, accurate to about 1e-10.
    """

    def slopes(_: float, state: Floats) -> list[float]:
        angle, curvature = float(state[0]), float(state[1])
        sine, cosine = np.sin(angle), np.cos(angle)
        along, across = force_n * sine, force_n * cosine
        stretch, shear = 1 + along / section.stretching_n, across / section.shear_n
        bending = -(across * stretch - along * shear) / section.bending_n_m2
        return [curvature, bending, stretch * sine + shear * cosine, stretch * cosine - shear * sine]

    def tip(curvature: float) -> Floats:
        start = [0.0, curvature, 0.0, 0.0]
        return solve_ivp(slopes, (0, length_m), start, method="DOP853", rtol=1e-11, atol=1e-13).y[:, -1]

    def moment_at_tip(curvature: float) -> float:
        return float(tip(curvature)[1])

    bracket = (0.0, 1.01 * force_n * length_m / section.bending_n_m2)
    found = tip(root_scalar(moment_at_tip, bracket=bracket, xtol=1e-15, rtol=1e-14).root)
    return float(found[2]), float(found[3])


def sprung_pole_frequency(clamped_hz: float, stiffness_ratio: float) -> float:
    """First frequency, Hz, of a uniform pole that stands on a rotational spring.

    `clamped_hz` is that of the clamped pole and `stiffness_ratio` = k_θ L / E I. The wave number λ solves
    1 + cos λ cosh λ = (λ / ratio) (sin λ cosh λ − cos λ sinh λ) (Euler–Bernoulli; for a soft spring the pole
    turns about its foot, λ⁴ → 3 ratio).
    """

    def excess(number: float) -> float:
        sine, cosine = np.sin(number), np.cos(number)
        turning = sine * np.cosh(number) - cosine * np.sinh(number)
        return float(1 + cosine * np.cosh(number) - number / stiffness_ratio * turning)

    first = root_scalar(excess, bracket=(1e-6, CLAMPED_NUMBER + 1e-9), xtol=1e-14).root
    return clamped_hz * (first / CLAMPED_NUMBER) ** 2


def sag(weight_n_m: float, length_m: float, young_pa: float, second_moment_m4: float) -> float:
    """Tip deflection of a horizontal cantilever under its weight per length, m."""
    return weight_n_m * length_m**4 / (8 * young_pa * second_moment_m4)


def shear_tip(force_n: float, length_m: float, shear_pa: float, area_m2: float) -> float:
    """Shear contribution to the tip deflection of a rectangular cantilever (Timoshenko, factor 5/6), m."""
    return force_n * length_m / (5 / 6 * shear_pa * area_m2)


def pole_frequencies(
    length_m: float,
    young_pa: float,
    density_kg_m3: float,
    area_m2: float,
    second_moment_m4: float,
    tip_ratio: float = 1.0,
    elements: int = 60,
) -> Floats:
    """(2,) lowest bending frequencies, Hz, of a clamped pole that tapers linearly to `tip_ratio` of its
    radius.

    Hermite beam elements with four Gauss points. 60 of them agree with the closed form of the uniform pole
    (1.8751², 4.6941²) to six digits.
    """
    h = length_m / elements
    size = 2 * (elements + 1)
    stiffness, mass = np.zeros((size, size)), np.zeros((size, size))
    points, weights = np.polynomial.legendre.leggauss(4)
    for e in range(elements):
        dofs = np.arange(2 * e, 2 * e + 4)
        for s, w in zip((points + 1) / 2, weights / 2, strict=True):
            thin = 1 + (tip_ratio - 1) * (e + s) / elements
            n, _, c = _hermite(s, h)
            stiffness[np.ix_(dofs, dofs)] += w * h * young_pa * second_moment_m4 * thin**4 * np.outer(c, c)
            mass[np.ix_(dofs, dofs)] += w * h * density_kg_m3 * area_m2 * thin**2 * np.outer(n, n)
    squares = eigh(stiffness[2:, 2:], mass[2:, 2:], eigvals_only=True, subset_by_index=[0, 1])
    return np.sqrt(squares) / (2 * np.pi)


def _hermite(s: float, h: float) -> tuple[Floats, Floats, Floats]:
    """Shape functions (4,) of a beam element of length h, m, at the share s, their slopes and curvatures."""
    values = np.array(
        [1 - 3 * s**2 + 2 * s**3, h * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, h * (s**3 - s**2)]
    )
    slopes = np.array([-6 * s * (1 - s) / h, (1 - s) * (1 - 3 * s), 6 * s * (1 - s) / h, s * (3 * s - 2)])
    curvatures = np.array([-6 + 12 * s, h * (-4 + 6 * s), 6 - 12 * s, h * (6 * s - 2)]) / h**2
    return values, slopes, curvatures


class Laden(NamedTuple):
    """A standing pole with a mass on its top: load factor, and first frequencies with and without weight, Hz.

    The one with weight is zero beyond the buckling load.
    """

    load_factor: float
    frequency_hz: float
    weightless_hz: float


def laden_pole(length_m: float, bending_n_m2: float, mass_kg_m: float, top_kg: float) -> Laden:
    """A uniform clamped pole of the stiffness E I under its weight and that of a mass on its top.

    Hermite elements with their consistent masses and the geometric stiffness of the weight above each, which
    varies along them. 60 agree within 1e-4 with Greenhill's buckling load (7.8373 E I / L² for the weight of
    the pole, π²/4 E I / L² for that of the mass).
    """
    elements = 60
    h = length_m / elements
    size = 2 * (elements + 1)
    stiffness, mass, weight = np.zeros((3, size, size))
    points, weights = np.polynomial.legendre.leggauss(5)
    for e in range(elements):
        dofs = np.ix_(np.arange(2 * e, 2 * e + 4), np.arange(2 * e, 2 * e + 4))
        for s, w in zip((points + 1) / 2, weights * h / 2, strict=True):
            n, t, c = _hermite(s, h)
            above = top_kg + mass_kg_m * (length_m - h * (e + s))
            stiffness[dofs] += w * bending_n_m2 * np.outer(c, c)
            mass[dofs] += w * mass_kg_m * np.outer(n, n)
            weight[dofs] += w * GRAVITY_M_S2 * above * np.outer(t, t)
    mass[-2, -2] += top_kg
    k, m, g = stiffness[2:, 2:], mass[2:, 2:], weight[2:, 2:]
    load = float(eigh(g, k, eigvals_only=True)[-1])
    light, heavy = (
        1 / (2 * np.pi * np.sqrt(float(eigh(m, a, eigvals_only=True)[-1]))) if stands else 0.0
        for a, stands in ((k, True), (k - g, load < 1))
    )
    return Laden(load, heavy, light)


def softening(weight_n: float, length_m: float, young_pa: float, second_moment_m4: float) -> float:
    """First frequency of a standing pole over that of the weightless pole: √(1 − W / W_c).

    W_c = 7.837 E I / L² (Greenhill). Exact if the mode shape does not change; within 1 % up to half the
    buckling load.
    """
    return float(np.sqrt(1 - weight_n * length_m**2 / (7.8373 * young_pa * second_moment_m4)))

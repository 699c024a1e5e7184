"""The rotation nearest to a deformation gradient."""

import numba
import numpy as np

from galewood.solid.fem.solver import JIT

Nine = tuple[float, float, float, float, float, float, float, float, float]
"""A 3 × 3 matrix by rows, as passed between kernels (in registers)."""


@numba.njit(**JIT)
def nearest_rotation(h: Nine) -> Nine:
    """The rotation nearest to I + h, by Higham's Newton iteration."""
    r0, r1, r2, r3, r4, r5, r6, r7, r8 = h
    r0 += 1.0
    r4 += 1.0
    r8 += 1.0
    for _ in range(20):
        c0 = r4 * r8 - r5 * r7
        c1 = r5 * r6 - r3 * r8
        c2 = r3 * r7 - r4 * r6
        det = r0 * c0 + r1 * c1 + r2 * c2
        if not det > 1e-9:
            break
        f = 0.5 / det
        d0 = f * c0 - 0.5 * r0
        d1 = f * c1 - 0.5 * r1
        d2 = f * c2 - 0.5 * r2
        d3 = f * (r2 * r7 - r1 * r8) - 0.5 * r3
        d4 = f * (r0 * r8 - r2 * r6) - 0.5 * r4
        d5 = f * (r1 * r6 - r0 * r7) - 0.5 * r5
        d6 = f * (r1 * r5 - r2 * r4) - 0.5 * r6
        d7 = f * (r2 * r3 - r0 * r5) - 0.5 * r7
        d8 = f * (r0 * r4 - r1 * r3) - 0.5 * r8
        r0 += d0
        r1 += d1
        r2 += d2
        r3 += d3
        r4 += d4
        r5 += d5
        r6 += d6
        r7 += d7
        r8 += d8
        # Convergence is quadratic: a step of 3e-9 leaves an error below rounding.
        if d0 * d0 + d1 * d1 + d2 * d2 + d3 * d3 + d4 * d4 + d5 * d5 + d6 * d6 + d7 * d7 + d8 * d8 < 1e-17:
            return r0, r1, r2, r3, r4, r5, r6, r7, r8
    return gram_schmidt(r0, r1, r2, r3, r4, r5)


@numba.njit(**JIT)
def gram_schmidt(r0: float, r1: float, r2: float, r3: float, r4: float, r5: float) -> Nine:
    """A proper rotation from two rows, for a flat or inverted element."""
    a = 1.0 / (np.sqrt(r0 * r0 + r1 * r1 + r2 * r2) + 1e-300)
    r0, r1, r2 = a * r0, a * r1, a * r2
    d = r0 * r3 + r1 * r4 + r2 * r5
    r3, r4, r5 = r3 - d * r0, r4 - d * r1, r5 - d * r2
    a = 1.0 / (np.sqrt(r3 * r3 + r4 * r4 + r5 * r5) + 1e-300)
    r3, r4, r5 = a * r3, a * r4, a * r5
    return r0, r1, r2, r3, r4, r5, r1 * r5 - r2 * r4, r2 * r3 - r0 * r5, r0 * r4 - r1 * r3

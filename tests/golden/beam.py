"""A small nonlinear system for tiny but valid tables: a pole as lumped masses on a bending spring.

Strain energy W = e + ½ γ e² with e = ½ uᵀKu: conservative, stiffening, with a pose-dependent tangent. The
wind acts by its velocity relative to the masses, which shelter each other by half.
"""

from __future__ import annotations

import numpy as np
import scipy.linalg
from galewood.pipeline.reduction.oscillators import Exposure, Oscillators, in_gusts
from galewood.solid.fem import Drag
from galewood.util import Array


class Beam:
    """n masses along a vertical pole of ``height_m``, stepped by backward Euler (paper, Eq. 7)."""

    def __init__(
        self, n: int = 6, height_m: float = 4.0, dt_s: float = 1 / 15, stiffening: float = 0.02
    ) -> None:
        self.n, self.height_m, self.dt_s, self.stiffening = n, height_m, dt_s, 0.02
        self.streamlined_exponent = 1.64  # not that of most species, so that all languages must read it
        self.rest_m = np.stack([np.zeros(n), height_m * np.arange(1, n + 1) / n, np.zeros(n)], axis=1)
        self.mass_kg = np.linspace(3.0, 1.0, n)
        self.area_m2 = np.linspace(0.02, 0.3, n)
        self.stiffness = _bending(n, height_m / n)
        self.mass = np.repeat(self.mass_kg, 3)
        # The masses are light and their areas large: in air six times as fast, damping is that of a tree.
        self.drag = Drag(self.area_m2, 2 * self.area_m2, np.full(n, 6.0), self.streamlined_exponent)
        self.damping = 0.3 * np.diag(self.mass) + 0.01 * self.stiffness
        self.reset()

    def oscillators(self) -> Oscillators:
        """Natural modes about the rest pose."""
        wind = np.zeros((self.n, 3, 2))
        wind[:, 0, 0] = wind[:, 2, 1] = self.area_m2
        squared, modes = scipy.linalg.eigh(self.stiffness, np.diag(self.mass))
        shapes = modes.T
        parts = (self.drag.exposed_m2, self.drag.share, self.drag.profile)
        exposure = Exposure(*parts, self.streamlined_exponent, self.rest_m)
        load = shapes @ wind.reshape(-1, 2)
        damping = shapes @ self.damping @ modes
        return in_gusts(Oscillators(np.sqrt(squared), damping, shapes, load, exposure))

    @property
    def place_m(self) -> Array:
        """(n, 3) masses at rest, m."""
        return self.rest_m

    @property
    def first_hz(self) -> float:
        """First natural frequency."""
        return float(self.oscillators().omega[0]) / (2 * np.pi)

    def reset(self) -> None:
        self.u, self.v = np.zeros((self.n, 3)), np.zeros((self.n, 3))
        self._assemble()

    def _assemble(self) -> None:
        u = self.u.ravel()
        linear = self.stiffness @ u
        gain = 1.0 + self.stiffening * 0.5 * float(u @ linear)
        self._force = gain * linear
        self._tangent = gain * self.stiffness + self.stiffening * np.outer(linear, linear)

    def recorded_force(self, vertices: Array) -> Array:
        """(q, 3) internal force before the last step, N."""
        return self._force.reshape(-1, 3)[vertices]

    def recorded_stiffness(self, vertices: Array) -> Array:
        """(q, 3, 3) diagonal blocks of the tangent before the last step, N/m."""
        blocks = self._tangent.reshape(self.n, 3, self.n, 3)
        return np.stack([blocks[i, :, i, :] for i in vertices])

    def step(self, pressure_pa: Array) -> None:
        self._assemble()
        dt, v = self.dt_s, self.v.ravel()
        wind = self.drag.at(self.v, np.asarray(pressure_pa))
        of_drag = np.asarray(scipy.linalg.block_diag(*wind.damping.reshape(-1, 3, 3)))
        damping = np.asarray(self.damping) + of_drag
        matrix = np.diag(self.mass) + dt * damping + dt * dt * self._tangent
        pull = wind.force_n.ravel() - self._force - (dt * self._tangent + self.damping) @ v
        self.v = (v + np.linalg.solve(matrix, dt * pull)).reshape(-1, 3)
        self.u = self.u + dt * self.v


def _bending(n: int, spacing_m: float) -> Array:
    """Squared second differences, clamped: slightly stiffer along z, very stiff along the axis."""
    full = np.zeros((n + 2, n + 2))
    for i in range(n):
        curvature = np.zeros(n + 2)
        curvature[i : i + 3] = (1.0, -2.0, 1.0)
        full += np.outer(curvature, curvature) * 900.0 / spacing_m**3
    lateral = full[2:, 2:]
    bands = np.eye(n) * 2.0 - np.eye(n, k=1) - np.eye(n, k=-1)
    bands[-1, -1] = 1.0
    stiffness = np.zeros((n, 3, n, 3))
    for axis, block in ((0, lateral), (1, 2e5 * bands), (2, 1.2 * lateral)):
        stiffness[:, axis, :, axis] = block
    return stiffness.reshape(3 * n, 3 * n)

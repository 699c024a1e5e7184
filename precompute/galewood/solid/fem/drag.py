"""Aerodynamic drag from the velocity of the air relative to the nodes.

A node moves at v in air that moves at s U, where s is the wind profile (speed at the node's height over the
speed at the top). Its force is a p(U_c − v/s), with the pressure law p of `motion.wind` and the area a that
it exposes to air that moves among the leaves ("exposed"; s² included). A crown shelters itself: the air moves
slower inside it. U_c is the sheltered speed at which the steady force equals that of the crown's silhouette A
(also with s²): a p(U_c) = A p(U). In a steady wind the force is therefore A p(U), whatever a; in still air it
is a p(v). With a = A this is A p(U − v) (docs/physics.md).
"""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

import math
from typing import NamedTuple

import numba
import numpy as np

from galewood.motion.wind import pressure_per_speed, speed_of_pressure
from galewood.util import Floats


class DragLoads(NamedTuple):
    """Force (N,3) N of the wind on the nodes, and minus its derivative by their velocity (N,9), N·s/m."""

    force_n: Floats
    damping: Floats


class Drag:
    """The drag of a model's nodes; works in place on its own arrays.

    drag_area_m2, exposed_area_m2 (N,) with the wind profile squared; wind_profile (N,) in 0..1; exponent: the
    streamlined one of the tree.
    """

    def __init__(
        self,
        drag_area_m2: Floats,
        exposed_area_m2: Floats | None,
        wind_profile: Floats | None,
        exponent: float,
    ) -> None:
        sheltered = drag_area_m2
        self.exposed_m2 = sheltered if exposed_area_m2 is None else np.maximum(exposed_area_m2, sheltered)
        self.share = np.ones_like(sheltered)
        """(N,) drag area with shelter over that without."""
        np.divide(sheltered, self.exposed_m2, out=self.share, where=self.exposed_m2 > 0)
        self.profile = (
            np.ones_like(sheltered) if wind_profile is None else np.maximum(wind_profile, LEAST_PROFILE)
        )
        self._nodes = np.flatnonzero(self.exposed_m2 > 0).astype(np.int64)
        at = self._nodes
        self._parts = (self.exposed_m2[at], self.share[at], self.profile[at])
        self._exponent = float(exponent)
        self._loads = DragLoads(np.zeros((len(sheltered), 3)), np.zeros((len(sheltered), 9)))

    def at(self, velocity_m_s: Floats, pressure_pa: Floats) -> DragLoads:
        """Drag at the velocities (N,3), m/s, in a wind whose dynamic pressure is (p_x, p_z), Pa.

        ``pressure_pa`` is (2,), the same at all nodes, or (N,2). The arrays of the result are overwritten by
        the next call.
        """
        exposed, share, profile = self._parts
        pressure = np.ascontiguousarray(pressure_pa, np.float64).reshape(-1, 2)
        of_tree = (exposed, share, profile, self._exponent)
        _drag(self._nodes, of_tree, velocity_m_s, pressure, *self._loads)
        return self._loads


LEAST_PROFILE = 0.1
"""Lower limit of the wind profile, so that nodes near the ground are not divided by zero."""


@numba.njit(cache=True, nogil=True)
def _drag(nodes, of_tree, velocity, pressure, force, damping):  # pragma: no cover  (compiled)
    exposed, share, profile, exponent = of_tree
    everywhere = len(pressure) == 1
    for j in range(len(nodes)):
        i = nodes[j]
        px, pz = pressure[0 if everywhere else i]
        wind_pa = math.sqrt(px * px + pz * pz)
        x, z = (px / wind_pa, pz / wind_pa) if wind_pa > 0 else (0.0, 0.0)
        speed = speed_of_pressure(share[j] * wind_pa, exponent)
        wx = speed * x - velocity[i, 0] / profile[j]
        wy = -velocity[i, 1] / profile[j]
        wz = speed * z - velocity[i, 2] / profile[j]
        relative = math.sqrt(wx * wx + wy * wy + wz * wz)
        per_speed, growth = pressure_per_speed(relative, exponent)
        across = exposed[j] * per_speed
        force[i, 0], force[i, 1], force[i, 2] = across * wx, across * wy, across * wz
        # p(w) = per_speed w, and p grows with the power `growth` of the speed:
        # dp/dw = per_speed (I + (growth − 1) w wᵀ / |w|²)
        along = across * (growth - 1.0) / (relative * relative) if relative > 0 else 0.0
        c, s = across / profile[j], along / profile[j]
        damping[i, 0], damping[i, 1], damping[i, 2] = c + s * wx * wx, s * wx * wy, s * wx * wz
        damping[i, 3], damping[i, 4], damping[i, 5] = s * wy * wx, c + s * wy * wy, s * wy * wz
        damping[i, 6], damping[i, 7], damping[i, 8] = s * wz * wx, s * wz * wy, c + s * wz * wz

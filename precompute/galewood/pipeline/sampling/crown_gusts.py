"""The gusts within the crown during a run: a few numbers that give the wind at any place of the tree.

The field is that of `motion.wind.crown`, carried past the tree with a steady speed.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass

import numpy as np

from galewood.constants import CROWN_CELL_M, CROWN_CELLS
from galewood.motion.wind import crown_field, gust_pressures, write_gusts
from galewood.util import Array, Floats
from galewood.wood import BARE_EXPONENT

CROWN_FIELD_M = CROWN_CELLS * CROWN_CELL_M
"""Distance after which the field repeats."""
CROWN_SPEEDS_M_S = (4.0, 18.0)
"""The gusts of training winds pass at speeds between these."""


@dataclass(frozen=True)
class CrownGusts:
    """A crown field that moves over a tree at (x, z), m, towards a heading, from the start of a run."""

    seed: int
    x_m: float
    z_m: float
    heading_rad: float
    speed_m_s: float
    intensity: float
    """Standard deviation of each component over the speed of the wind; 0: there are no gusts."""
    exponent: float
    """The streamlined exponent of the tree."""

    @classmethod
    def of_array(cls, numbers: Array) -> CrownGusts:
        """From the numbers of ``array``."""
        seed, *others = np.asarray(numbers, np.float64).tolist()
        return cls(int(seed), *others)

    @property
    def array(self) -> Floats:
        """(7,) all numbers, to be stored with a run."""
        return np.array(astuple(self), np.float64)

    def relative(self, place_m: Floats, pressure_pa: Floats, dt_s: float) -> Floats:
        """(T, 2n) gusts of ``write_gusts`` at places (n, 3), m, in a wind (T, 2), Pa, of the tree's frame."""
        frames = len(pressure_pa)
        out, ones = np.zeros((frames, 2 * len(place_m))), np.ones(frames)
        c, s = np.cos(self.heading_rad), np.sin(self.heading_rad)
        # each frame is a tree that stands farther upwind
        passed_m = self.speed_m_s * dt_s * np.arange(frames)
        x_m, z_m = self.x_m - c * passed_m, self.z_m - s * passed_m
        pressure = np.ascontiguousarray(pressure_pa.T, np.float64)
        write_gusts(
            crown_field(self.seed), (c, s, 0.0, self.intensity), np.ascontiguousarray(place_m), (x_m, z_m),
            np.outer(ones, (1.0, 0.0)), ones, (pressure[0], pressure[1]), self.exponent, out,
        )  # fmt: skip
        return out

    def local_pa(self, place_m: Floats, pressure_pa: Array, dt_s: float) -> Floats:
        """(T, 2, n) pressures at places (n, 3) along x and z, Pa, in addition to those at the tree (T, 2)."""
        wind = np.asarray(pressure_pa, np.float64)
        return gust_pressures(self.relative(place_m, wind, dt_s), wind[:, 0], wind[:, 1])


NO_GUSTS = CrownGusts(0, 0.0, 0.0, 0.0, 0.0, 0.0, BARE_EXPONENT)
"""The same wind everywhere in the crown."""

"""Wind pressure at trees, brought into the range of their table: what a forest steps its trees with."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import numpy.typing as npt

from galewood.motion.wind.document import Wind
from galewood.motion.wind.field import WindField
from galewood.motion.wind.pressure import compress_pressure, dynamic_pressure, height_factor, limit_pressure
from galewood.util import Floats, joined_array

PRESSURE_ARRAYS = ("_x_m", "_z_m", "_height_m", "_most_pa", "_exponent", "x_pa", "z_pa", "ratio")
"""Attributes of ``TreePressure`` with a number for each tree that is not computed from others."""


class TreePressure:
    """The pressure at trees at given places.

    x_pa, z_pa (n,) Pa are those along world x and z at the last time; ratio (n,) is their strength before
    they were compressed over the strongest one of its table, and stays 0 where they are limited.
    """

    def __init__(
        self,
        x_m: npt.ArrayLike,
        z_m: npt.ArrayLike,
        height_m: npt.ArrayLike,
        most_pa: npt.ArrayLike,
        exponent: npt.ArrayLike,
        *,
        limited: bool,
    ) -> None:
        """Create it for trees at x, z (n,), m, of a height (n,), m.

        ``most_pa`` is the strongest pressure of their table, and ``exponent`` their streamlined exponent, of
        all or of each (n,).
        Stronger winds are compressed as a whole (``compress_pressure``); ``limited``: each pressure is
        clamped instead (``limit_pressure``).
        """
        self._x_m, self._z_m = np.array(x_m, np.float64), np.array(z_m, np.float64)
        self._height_m, self._limited = np.array(height_m, np.float64), limited
        count = len(self._x_m)
        self._most_pa = np.array(np.broadcast_to(most_pa, count), np.float64)
        self._exponent = np.array(np.broadcast_to(exponent, count), np.float64)
        self.x_pa, self.z_pa, self.ratio = np.zeros(count), np.zeros(count), np.zeros(count)
        self._factor, self._peak_pa = np.ones(count), np.zeros(count)
        self._strength: tuple[float, ...] | None = None

    @classmethod
    def joined(cls, parts: Sequence[TreePressure]) -> TreePressure:
        """The pressure at the trees of several tables, which are not limited, for one evaluation of the wind.

        The arrays of the parts become views of its own: when it is advanced, they are too.
        """
        whole = cls((), (), (), (), (), limited=False)
        for name in PRESSURE_ARRAYS:
            setattr(whole, name, joined_array(parts, name))
        whole._factor, whole._peak_pa = np.ones(len(whole.x_pa)), np.zeros(len(whole.x_pa))
        return whole

    def advance(self, field: WindField, time_s: float) -> None:
        """Evaluate the wind at a time, s."""
        self._set_strength(field.at(time_s).wind)
        field.pressure(self._x_m, self._z_m, time_s, self.x_pa, self.z_pa, self._exponent, self._factor)
        if self._limited:
            limit_pressure(self.x_pa, self.z_pa, float(self._most_pa.max(initial=0.0)))
        else:
            compress_pressure(self.x_pa, self.z_pa, self._peak_pa, self._most_pa, self.ratio)

    def wind_m_s(self, field: WindField, time_s: float) -> Floats:
        """(n, 2) velocity of the wind at the tops along x and z, at a time, s."""
        self._set_strength(field.at(time_s).wind)
        x, z = np.zeros(len(self._x_m)), np.zeros(len(self._x_m))
        field.velocity(self._x_m, self._z_m, time_s, x, z)
        return np.column_stack([x, z]) * self._factor[:, None]

    def _set_strength(self, wind: Wind) -> None:
        """Update the height factors and the pressures of the strongest gusts if the wind has changed."""
        strength = (
            wind.height_exponent, wind.reference_height_m, wind.mean_speed_m_s, wind.gustiness,
        )  # fmt: skip
        if self._strength == strength:
            return
        self._strength = strength
        height_exponent, reference_height_m, mean_m_s, gustiness = strength
        self._factor = height_factor(self._height_m, height_exponent, reference_height_m)
        gust_m_s = mean_m_s * (1.0 + gustiness) * self._factor
        self._peak_pa = dynamic_pressure(gust_m_s, self._exponent)

"""The linear modal model of a table: what a program computes per frame to move morph targets.

Each oscillator steps by its exact propagator under the pressure of the wind. Of the drag it keeps what
damps the oscillator itself (``_damping_area_m2_kg``). It leaves out the fitted polynomials, the gusts
within the crown, and the modes that follow the oscillators: their linear part changes the error by less
than 0.01 % of the height.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from galewood.constants import (
    HALF_AIR_DENSITY_KG_M3,
    ISOTROPIC_DRAG,
    MAX_STEPS_PER_ADVANCE,
    PRESSURE_COMPRESSION,
    STREAMLINING_SPEED_M_S,
)
from galewood.motion.modal import drag_inputs
from galewood.motion.wind import dynamic_pressure, speed_of_pressure
from galewood.table import Table
from galewood.util import Floats

REFERENCE_SPEED_M_S = 8.0
"""Of the wind for which the damping by the air is taken over from the drag points."""


@dataclass(frozen=True)
class LiveModel:
    """k oscillators whose coordinates are the weights of morph targets.

    Oscillator i steps under the pressure P (Pa) of the wind by e' = r00 e + r01 v + s0 f,
    v' = r10 e + r11 v + s1 f with f = load·P − κ c n, where n = ((r00 − 1) e + r01 v + s0 load·P) / dt and
    κ is the pressure over the speed of the wind, Pa·s/m.
    """

    dt_s: float
    step: Floats
    """(k, 6) r00 − 1, r01 (s), r10 (1/s), r11 − 1, s0 (s²), s1 (s)."""
    load: Floats
    """(k, 2) acceleration of the weight per pressure along x and z, 1/(s²·Pa)."""
    drag: Floats
    """(k,) c: damping of the weight per κ, m²/kg."""
    exponent: float
    """With which the pressure grows above 5 m/s."""
    most_pa: float
    """Pressure above which it is compressed, Pa."""

    def pressure(self, wind_m_s: npt.ArrayLike) -> tuple[Floats, float]:
        """(2,) pressure along x and z, Pa, and κ, Pa·s/m, of a wind (x, z) at the tree's height."""
        wind = np.asarray(wind_m_s, np.float64)
        speed = float(np.hypot(*wind))
        slow, over = min(speed, STREAMLINING_SPEED_M_S), max(speed / STREAMLINING_SPEED_M_S, 1.0)
        per_speed = HALF_AIR_DENSITY_KG_M3 * slow * over ** (self.exponent - 1.0)
        ratio = max(per_speed * speed / self.most_pa, 1.0)
        scale = (1.0 + PRESSURE_COMPRESSION * np.log(1.0 + (ratio - 1.0) / PRESSURE_COMPRESSION)) / ratio
        return scale * per_speed * wind, per_speed

    def played(self, wind_m_s: Floats, frame_s: float) -> Floats:
        """(T, k) weights shown at the ends of frames of ``frame_s`` in the winds (T, 2), from rest."""
        r00, r01, r10, r11, s0, s1 = self.step.T
        e, v, before, phase = *np.zeros((3, len(self.drag))), 0.0
        shown = np.empty((len(wind_m_s), len(self.drag)))
        for frame, wind in enumerate(wind_m_s):
            pressure_pa, per_speed = self.pressure(wind)
            phase = phase % 1.0 + frame_s / self.dt_s
            for _ in range(min(int(phase), MAX_STEPS_PER_ADVANCE)):
                force = self.load @ pressure_pa
                moved = r00 * e + r01 * v + s0 * force
                force = force - per_speed * self.drag / self.dt_s * moved
                before = e
                e, v = e + r00 * e + r01 * v + s0 * force, v + r10 * e + r11 * v + s1 * force
            shown[frame] = before + phase % 1.0 * (e - before)
        return shown


def live_model(table: Table, modes: npt.NDArray[np.int64], scale_m: Floats) -> LiveModel:
    """The model of those ``modes`` (k,) of a table, less than d, whose weights are q / ``scale_m`` (k,)."""
    unit = (table.modal_shown[modes] / scale_m).astype(np.float64)
    return LiveModel(
        float(table.metadata["dt_s"]),
        table.modal_step[modes].astype(np.float64),
        table.modal_load[modes].astype(np.float64) * unit[:, None],
        _damping_area_m2_kg(table)[modes],
        table.streamlined_exponent,
        float(table.modal_limits[2]),
    )


def _damping_area_m2_kg(table: Table) -> Floats:
    """(d,) damping of each oscillator by the air, per pressure over speed of the wind at the tree.

    The table's law (spec/formats/table.md) made linear in the speeds of the points about a steady wind of
    REFERENCE_SPEED_M_S: a point resists along the wind with the slope of the pressure, n times what it
    resists with across, so with (1 + n) / 2 of it on average over the directions of the wind. Couplings of
    oscillators by the air are left out.
    """
    area_m2, share = table.modal_drag_point.astype(np.float64).T
    d = len(table.modal_step)
    if not len(area_m2):
        return np.zeros(d)
    pressure_pa = float(dynamic_pressure(REFERENCE_SPEED_M_S, table.streamlined_exponent))
    felt_pa = np.maximum(share, 1e-9) * pressure_pa
    speed_m_s = np.array([speed_of_pressure(one, table.streamlined_exponent) for one in felt_pa])
    slope = np.where(speed_m_s <= STREAMLINING_SPEED_M_S, 2.0, table.streamlined_exponent)
    relative = felt_pa / speed_m_s / (pressure_pa / REFERENCE_SPEED_M_S)
    shape = table.modal_drag_shape.astype(np.float64) ** 2
    shape[:, :, drag_inputs(d) :] = 0.0
    across = area_m2 * relative
    own = (across * (1.0 + slope) / 2.0) @ (shape[0] + shape[2]) + across @ shape[1]
    mean = float(across.sum() / area_m2.sum())
    return own + ISOTROPIC_DRAG * mean * table.modal_drag_rest.astype(np.float64)

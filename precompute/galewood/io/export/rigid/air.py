"""The air among the leaves at the bodies of an exported tree, in the gusts of a wind."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from galewood.constants import HALF_AIR_DENSITY_KG_M3
from galewood.io.export.rigid.drag import exposed_areas
from galewood.motion.wind import Wind, WindField
from galewood.solid.fem import Place, point_pressures
from galewood.table import Table
from galewood.util import Floats


def air_at_bodies(table: Table, wind: Wind, places_m: npt.ArrayLike, times_s: npt.ArrayLike) -> Floats:
    """(T, b, 3) velocities of the air among the leaves, m/s, z up, for bodies of quadratic drag.

    The pressure at each place is that at the tree with the gusts within the crown; the air there has the
    share of it that the crown's shelter leaves (``sheltered_speed``).

    Args:
        table: The table.
        wind: The wind.
        places_m: (b, 3) places of the bodies at rest, z up.
        times_s: (T,) times of the wind.
    """
    x, y, z = np.asarray(places_m, np.float64).reshape(-1, 3).T
    own = np.stack([x, z, -y], axis=1)
    total, sheltered = exposed_areas(table)
    height_m, most_pa = float(table.metadata["height_m"]), float(table.modal_limits[2])
    times = np.asarray(times_s, np.float64).ravel()
    found = np.zeros((len(times), len(own), 3))
    pressures = point_pressures(
        own,
        table.streamlined_exponent,
        WindField(wind).state,
        Place(),
        times,
        height_m=height_m,
        most_pa=most_pa,
    )
    for row, moment in zip(found, pressures, strict=True):
        strength_pa = np.linalg.norm(moment.node_pa, axis=1)
        per_pa = np.sqrt(sheltered / total / HALF_AIR_DENSITY_KG_M3 / np.maximum(strength_pa, 1e-30))
        row[:, 0], row[:, 1] = per_pa * moment.node_pa[:, 0], -per_pa * moment.node_pa[:, 1]
    return found

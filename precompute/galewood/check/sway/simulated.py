"""The sway of a table's tree in the wind of a record, as a record of its own."""

from __future__ import annotations

import numpy as np

from galewood.measurements import MotionRecord
from galewood.motion.wind import check_direction, dynamic_pressure, limit_pressure
from galewood.player import ModalForest
from galewood.table import Table
from galewood.util import Floats

SETTLING_S = 30.0
"""The tree starts at rest; the beginning of the wind is played backwards before, and not counted."""
LIMITED_SHARE = 0.001
"""Share of winds beyond the table's range from which a note says so."""


def simulated_motion(table: Table, record: MotionRecord, direction_deg: float = 0.0) -> MotionRecord:
    """The motion of the top in the record's wind, which is taken as that at the top and over the whole crown.

    Displacements (n, 2) along x and z, m, at the times of the record; accelerations if it has those. Winds
    beyond the range of the table count as its strongest one. ``direction_deg``: the wind blows towards
    (cos θ, 0, sin θ) of the tree. Raises ValueError if the record has no wind.
    """
    if record.wind_m_s is None:
        raise ValueError("the record has no wind in which the tree could be simulated")
    check_direction(direction_deg)
    dt_s, count = float(table.metadata["dt_s"]), len(record.values)
    late_s = np.arange(count) / record.rate_hz
    frames = int(np.ceil((late_s[-1] + SETTLING_S) / dt_s)) + 2
    time_s = dt_s * np.arange(frames) - SETTLING_S
    speed = np.interp(np.abs(time_s), late_s, record.wind_m_s)
    pressure_pa = dynamic_pressure(speed, table.streamlined_exponent)
    angle = np.deg2rad(direction_deg)
    x_pa, z_pa = np.cos(angle) * pressure_pa, np.sin(angle) * pressure_pa
    most_pa = float(table.modal_limits[2])
    limit_pressure(x_pa, z_pa, most_pa)
    moved = _top_m(table, x_pa, z_pa, dt_s)
    if record.quantity == "acceleration":
        moved = np.gradient(np.gradient(moved, dt_s, axis=0), dt_s, axis=0)
    # a displayed pose right after a step is that of the end of the step before
    values = np.column_stack([np.interp(late_s, time_s - dt_s, axis) for axis in moved.T])
    share = float(np.mean(pressure_pa > most_pa))
    notes = (
        (f"{share:.1%} of the wind is stronger than the table was made for, and counts as its strongest.",)
        if share > LIMITED_SHARE
        else ()
    )
    of_acceleration = record.quantity == "acceleration"
    return MotionRecord(
        record.rate_hz, values, "acceleration" if of_acceleration else "sway",
        "m/s²" if of_acceleration else "m", record.wind_m_s, row_count=count, notes=notes,
    )  # fmt: skip


def _top_m(table: Table, x_pa: Floats, z_pa: Floats, dt_s: float) -> Floats:
    """(T, 2) displacement of the highest node along x and z after each step, m."""
    tree = ModalForest(table.modal, dt_s, table.mode_scale, 1)
    top = table.node_basis[int(np.argmax(table.node_rest_m[:, 1]))][[0, 2]].astype(np.float64)
    found = np.empty((len(x_pa), 2))
    for frame in range(len(found)):
        tree.advance(dt_s, x_pa[frame : frame + 1], z_pa[frame : frame + 1])
        found[frame] = top @ tree.q[0]
    return found

"""The sway of a modal model in units of its own: what two trees of a species have in common.

A sway of 1 is the largest that was sampled, time counts in radians of the first sway, and a pressure of 1
would hold the tree at a sway of 1 if it were linear.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.pipeline.reduction import Oscillators
from galewood.table import Table
from galewood.util import Floats


@dataclass(frozen=True)
class Sway:
    """The two sway coordinates of a model of d oscillators, and its units.

    ``rows`` (2, d) are those of ``ModalTensors.sway``; ``turn`` (2, 2) gives them from directions along x and
    z; ``omega`` is the angular frequency of the sway, 1/s, and ``unit_pa`` the pressure of 1.
    """

    rows: Floats
    turn: Floats
    omega: float
    unit_pa: float

    @property
    def spread(self) -> Floats:
        """(d, 2) the oscillators' least motion that has these sway coordinates."""
        return np.asarray(np.linalg.pinv(self.rows), np.float64)


def _sway(rows: Floats, omega: Floats, load: Floats) -> Sway:
    """From the rows, the angular frequencies (d,), 1/s, and the load (d, 2) per Pa."""
    spread = np.linalg.pinv(rows)
    share = np.square(spread).sum(axis=1)
    mean = float(np.sqrt(share @ omega**2 / share.sum()))
    left, size, right = np.linalg.svd(rows @ load / mean**2)
    return Sway(rows, left @ right, mean, 1.0 / float(size.mean()))


def sway_of_table(table: Table) -> Sway:
    """The sway of a fitted table."""
    return _sway(table.modal_sway.astype(np.float64), omega_of(table), table.modal_load.astype(np.float64))


def sway_of_oscillators(own: Oscillators, largest_m: float) -> Sway:
    """The sway of oscillators: their response to winds along x and z, 1 where it moves a vertex so far."""
    reach = np.sqrt((own.shapes.reshape(len(own.omega), -1, 3) ** 2).sum(axis=2).max(axis=1))
    still = own.load * (reach / own.omega**2)[:, None]
    directions = np.linalg.svd(still, full_matrices=False)[0].T
    return _sway(directions * reach / largest_m, own.omega, own.load)


def largest_sway_m(table: Table) -> float:
    """Displacement of the farthest node at a sway of 1, m."""
    d = len(table.modal_step)
    moved = np.linalg.norm(table.node_basis[:, :, :d].astype(np.float64), axis=1).max(axis=0)
    rows = table.modal_sway / (moved * table.modal_shown)
    return float(1.0 / np.linalg.norm(rows, axis=1).mean())


def omega_of(table: Table) -> Floats:
    """(d,) angular frequencies of the oscillators of a table, 1/s, from their steps."""
    step = table.modal_step.astype(np.float64)
    r00, r11 = 1.0 + step[:, 0], 1.0 + step[:, 3]
    dt_s, product = float(table.metadata["dt_s"]), r00 * r11 - step[:, 1] * step[:, 2]
    decay = -np.log(product) / (2 * dt_s)
    turn = np.arccos(np.clip((r00 + r11) / (2 * np.sqrt(product)), -1.0, 1.0)) / dt_s
    return np.hypot(turn, decay)

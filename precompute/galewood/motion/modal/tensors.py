"""Tensors of the modal reduced-order model, and the number of terms of its polynomials."""
# pyright: reportMissingParameterType=false
# (compiled kernels take their types from the call)

from __future__ import annotations

from dataclasses import dataclass

import numba
import numpy as np

from galewood.util import Floats, Singles


@dataclass(frozen=True)
class ModalTensors:
    """Tensors of the model: d dynamic coordinates, c coupled ones, r ≥ d output modes, F = 44 + 6c force
    terms, m drag points, G places of the crown.

    An oscillator steps under a force f by e' = r00 e + r01 v + s0 f, v' = r10 e + r11 v + s1 f.
    """

    step: Singles  # (d, 6) r00 − 1, r01, r10, r11 − 1, s0, s1
    load: Singles  # (d, 2) modal force per Pa along x and z
    sway: Singles  # (2, d) sway coordinates, 1 at the edge of the sampled range
    force: Singles  # (F, d) modal force per unit of each term
    shown: Singles  # (d,) m of q_k per unit of e_k
    pose: Singles  # (d + 2 + 7 + 2c, r − d) m of the other q per unit of each term
    limits: Singles  # (3 + 2c,) sampled range: sway, its speed 1/s, pressure Pa; coupled coordinates, speeds
    drag_point: Singles  # (m, 2) of each drag point: area, m², and share of the wind's pressure at shelter
    drag_shape: Singles  # (3, m, d) velocity x, y, z of each point per unit of the oscillators' speeds, 1/√kg
    drag_rest: Singles  # (d,) area of the motion within the points, m²/kg
    drag_place: Singles  # (m, G) gust at each drag point per unit of those at the places
    place: Singles  # (G, 3) places of the crown whose gusts drive the model, tree frame, m
    place_load: Singles  # (d, 2, G) modal force per Pa along x and z of the gust at each place
    streamlined_exponent: float  # of the pressure over the wind speed, above 5 m/s

    @property
    def coupled(self) -> int:
        """c: coordinates 2 to 2 + c whose products with sway and pressure are terms of the model."""
        return coupled_of(self.limits)

    @property
    def modes(self) -> int:
        """r: output modes."""
        return len(self.shown) + self.pose.shape[1]

    @property
    def mean_gust(self) -> Floats:
        """(G,) weights of the places in the mean gust over the crown (``mean_gust``)."""
        return mean_gust(self.drag_point, self.drag_place)


def mean_gust(drag_point: Singles, drag_place: Singles) -> Floats:
    """(G,) weights of the places in the mean gust over the crown: that of the drag points by sheltered area.

    ``drag_point`` (m, 2) and ``drag_place`` (m, G) as in ``ModalTensors``.
    """
    sheltered = np.prod(np.asarray(drag_point, np.float64), axis=1)
    share = sheltered / max(float(sheltered.sum()), 1e-30)
    return share @ np.asarray(drag_place, np.float64)


@numba.njit(cache=True, nogil=True)
def coupled_of(limits):  # pragma: no cover  (compiled)
    """c, from the sampled range (3 + 2c,)."""
    return (len(limits) - 3) // 2


def shape_terms(coupled: int) -> int:
    """Number of terms in the pose alone."""
    return 7 + 2 * coupled


def force_terms(coupled: int) -> int:
    """F: number of terms of the force."""
    return shape_terms(coupled) + 37 + 4 * coupled

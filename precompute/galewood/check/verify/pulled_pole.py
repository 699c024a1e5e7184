"""The elastica of a standing, tapered pole that is pulled sideways, under its own weight."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp
from scipy.optimize import root_scalar

from galewood.util import Floats

PROFILE_POINTS = 400


@dataclass(frozen=True, kw_only=True)
class PulledPole:
    """A pole clamped at its foot and pulled at arc length ``pulled_at_m`` by a horizontal dead force.

    height_m (k,) is the arc length, m, bending_n_m2 (k,) E I, N m², and weight_n (k,) the weight above, N.
    """

    height_m: Floats
    bending_n_m2: Floats
    weight_n: Floats
    pulled_at_m: float

    def sway_m(self, force_n: float, *, linear: bool = False) -> float:
        """Sway of the pulled point, m; ``linear``: in the limit of small angles, the weight included.

        With the tilt θ from the vertical, E I θ' = M and M' = −(F cos θ + W sin θ), F only below the pulled
        point; θ(0) = 0 and M(L) = 0. Shooting from the foot.
        """
        length_m = float(self.height_m[-1])

        def slopes(at_m: float, state: Floats) -> list[float]:
            tilt, moment = float(state[0]), float(state[1])
            sine, cosine = (tilt, 1.0) if linear else (float(np.sin(tilt)), float(np.cos(tilt)))
            force = force_n if at_m < self.pulled_at_m else 0.0
            bending = float(np.interp(at_m, self.height_m, self.bending_n_m2))
            weight = float(np.interp(at_m, self.height_m, self.weight_n))
            return [moment / bending, -(force * cosine + weight * sine), sine]

        def path(moment_nm: float) -> tuple[Floats, Floats]:
            below = _solved(slopes, (0.0, self.pulled_at_m), np.array([0.0, moment_nm, 0.0]))
            return below, _solved(slopes, (self.pulled_at_m, length_m), below)

        def moment_at_tip(moment_nm: float) -> float:
            return float(path(moment_nm)[1][1])

        most = 2.0 * force_n * self.pulled_at_m
        found = root_scalar(moment_at_tip, bracket=(0.0, most), xtol=1e-9, rtol=1e-12).root
        return float(path(found)[0][2])


def _solved(
    slopes: Callable[[float, Floats], list[float]], span_m: tuple[float, float], start: Floats
) -> Floats:
    return solve_ivp(slopes, span_m, start, method="DOP853", rtol=1e-9, atol=1e-11, max_step=0.2).y[:, -1]

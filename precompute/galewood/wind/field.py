"""The wind field of a forest: velocity and pressure at many positions and any time, for every model."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from galewood.util import Floats
from galewood.wind.document import Wind
from galewood.wind.fronts import add_fronts
from galewood.wind.models.cosine import CosineGusts
from galewood.wind.models.eddy_gusts import EddyGusts
from galewood.wind.models.perlin import PerlinGusts
from galewood.wind.models.recorded import RecordedGusts
from galewood.wind.models.spectral import SpectralGusts
from galewood.wind.pressure import pressure_of_velocity
from galewood.wind.transition import Moment, WindState, at, change_wind, gust_key, steady

TIMED = ("cosine", "recorded")
"""Models that depend on the time rather than on the distance travelled."""
KEPT_GUSTS = 2
"""A transition evaluates two gust fields at once."""
KEPT_BUFFERS = 24
"""Three for each species in a forest."""


class Gusts(Protocol):
    """The gusts of one model and seed.

    ``carried`` is the distance travelled in length scales; TIMED models use the time, s, instead.
    """

    def velocity(
        self, wind: Wind, carried: float, x_m: Floats, z_m: Floats, out_x: Floats, out_z: Floats, /
    ) -> None:
        """Write the velocity (m/s, world x and z) at each position (m)."""
        ...


def gusts_of(wind: Wind) -> Gusts:
    """The gust generator of a wind document."""
    if wind.model == "perlin":
        return PerlinGusts(wind.seed)
    if wind.model == "spectral":
        return SpectralGusts(wind.seed, wind.beta)
    if wind.model == "navier-stokes":
        return EddyGusts(wind.seed)
    if wind.model == "recorded":
        return RecordedGusts(wind.recording)
    return CosineGusts(wind)


class WindField:
    """The wind of a forest. Not thread-safe: the Navier–Stokes eddies are advanced as time goes on."""

    def __init__(self, wind: Wind | WindState) -> None:
        """Create the field from a document (travel starts at time 0) or from a shared state."""
        self.state = steady(wind) if isinstance(wind, Wind) else wind
        self._gusts: dict[tuple[Any, ...], Gusts] = {}
        self._buffers: dict[tuple[str, int], Floats] = {}

    def change(self, wind: Wind, time_s: float) -> None:
        """Start a transition to another document at this time, s."""
        self.state = change_wind(self.state, wind, time_s)

    def at(self, time_s: float) -> Moment:
        """The interpolated wind parameters at a time, s, including any transition in progress."""
        return at(self.state, time_s)

    def velocity(self, x_m: Floats, z_m: Floats, time_s: float, out_x: Floats, out_z: Floats) -> None:
        """Write the velocity (m/s, world x and z) at each position (m), at the reference height."""
        moment = at(self.state, time_s)
        self._write(moment.wind, moment, x_m, z_m, out_x, out_z)
        if moment.share < 1.0:
            other = self._buffer("other", len(x_m))
            self._write(moment.before, moment, x_m, z_m, other[0], other[1])
            out_x += (1.0 - moment.share) * (other[0] - out_x)
            out_z += (1.0 - moment.share) * (other[1] - out_z)
        add_fronts(self.state.fronts, x_m, z_m, time_s, out_x, out_z)

    def pressure(
        self,
        x_m: npt.ArrayLike,
        z_m: npt.ArrayLike,
        time_s: float,
        out_x_pa: npt.NDArray[Any],
        out_z_pa: npt.NDArray[Any],
        height_factor: Floats | None = None,
    ) -> None:
        """Write the pressure (Pa, world x and z) at each position (m); exactly 0 in still air.

        ``height_factor`` is the result of ``pressure.height_factor`` (default: 1 everywhere).
        """
        x, z = np.ascontiguousarray(x_m, np.float64), np.ascontiguousarray(z_m, np.float64)
        velocity_x, velocity_z = self._buffer("work", len(x))
        self.velocity(x, z, time_s, velocity_x, velocity_z)
        factor = self._buffer("ones", len(x))[0] if height_factor is None else height_factor
        pressure_of_velocity(velocity_x, velocity_z, factor)
        out_x_pa[:] = velocity_x
        out_z_pa[:] = velocity_z

    def _buffer(self, use: str, count: int) -> Floats:
        """A (2, count) buffer reused between frames; "ones" is never written to."""
        key = (use, count)
        if key not in self._buffers:
            if len(self._buffers) >= KEPT_BUFFERS:
                self._buffers.clear()
            self._buffers[key] = np.ones((2, count))
        return self._buffers[key]

    def _write(self, wind: Wind, moment: Moment, x: Floats, z: Floats, out_x: Floats, out_z: Floats) -> None:
        carried = moment.time_s if wind.model in TIMED else moment.travel
        self._gusts_for(wind).velocity(wind, carried, x, z, out_x, out_z)

    def _gusts_for(self, wind: Wind) -> Gusts:
        key = gust_key(wind)
        if key not in self._gusts:
            while len(self._gusts) >= KEPT_GUSTS:
                del self._gusts[next(iter(self._gusts))]
            self._gusts[key] = gusts_of(wind)
        return self._gusts[key]

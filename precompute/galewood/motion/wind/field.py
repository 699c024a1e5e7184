"""The wind field of a forest: velocity and pressure at many positions and any time, for every model."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

from galewood.constants import TIMED_MODELS
from galewood.motion.wind.crown import crown_field
from galewood.motion.wind.document import Wind
from galewood.motion.wind.fronts import add_fronts
from galewood.motion.wind.models.cosine import CosineGusts
from galewood.motion.wind.models.eddy_gusts import EddyGusts
from galewood.motion.wind.models.perlin import PerlinGusts
from galewood.motion.wind.models.recorded import RecordedGusts
from galewood.motion.wind.models.spectral import SpectralGusts
from galewood.motion.wind.pressure import pressure_of_velocity
from galewood.motion.wind.transition import Moment, WindState, at, change_wind, gust_key, steady
from galewood.util import Floats

KEPT_BUFFERS = 24
"""Three for each species in a forest."""


class Gusts(Protocol):
    """The gusts of one model and seed.

    ``carried`` is the distance travelled in length scales; TIMED_MODELS use the time, s, instead.
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


GustKey = tuple[object, ...]
PREPARED_GUSTS = 4
"""Those of a state, which holds up to three documents, and one more."""


def _carried(wind: Wind, moment: Moment) -> float:
    return moment.time_s if wind.model in TIMED_MODELS else moment.travel


class WindField:
    """The wind of a forest. Not thread-safe: the Navier–Stokes eddies are advanced as time goes on."""

    def __init__(self, wind: Wind | WindState) -> None:
        """Create the field from a document (travel starts at time 0) or from a shared state."""
        self.state = steady(wind) if isinstance(wind, Wind) else wind
        self._gusts: dict[GustKey, Gusts] = {}
        self._prepared: dict[GustKey, Gusts] = {}
        self._buffers: dict[tuple[str, int], Floats] = {}

    def change(self, wind: Wind, time_s: float) -> None:
        """Start a transition to another document at this time, s."""
        self.state = change_wind(self.state, wind, time_s)

    def has(self, wind: Wind) -> bool:
        """Whether the gusts of a wind exist, so that it can be evaluated without delay. Thread-safe."""
        return gust_key(wind) in self._gusts or gust_key(wind) in self._prepared

    def prepare(self, state: WindState, time_s: float) -> None:
        """Create the gusts of a state that are missing, ready for this time, s, and later ones. Thread-safe.

        Creates their fields, advances Navier–Stokes eddies to the time, and compiles what the evaluation
        calls: up to half a second, or a few seconds where nothing is compiled yet.
        """
        moment, place, created = at(state, time_s), np.zeros((4, 2)), dict[GustKey, Gusts]()
        for wind in filter(None, (state.before, state.wind, state.next)):
            if not self.has(wind) and gust_key(wind) not in created:
                gusts = created[gust_key(wind)] = gusts_of(wind)
                gusts.velocity(wind, _carried(wind, moment), *place)
            crown_field(wind.seed)
        kept = {**self._prepared, **created}
        self._prepared = {key: kept[key] for key in list(kept)[-PREPARED_GUSTS:]}

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
        exponent: float | Floats,
        height_factor: Floats | None = None,
    ) -> None:
        """Write the pressure (Pa, world x and z) at each position (m); exactly 0 in still air.

        ``exponent`` is the streamlined exponent of all trees or of each (``dynamic_pressure``),
        ``height_factor`` the result of ``pressure.height_factor`` (default: 1 everywhere).
        """
        x, z = np.ascontiguousarray(x_m, np.float64), np.ascontiguousarray(z_m, np.float64)
        velocity_x, velocity_z = self._buffer("work", len(x))
        self.velocity(x, z, time_s, velocity_x, velocity_z)
        factor = self._buffer("ones", len(x))[0] if height_factor is None else height_factor
        own = np.full(len(x), exponent) if isinstance(exponent, float) else exponent
        pressure_of_velocity(velocity_x, velocity_z, factor, own)
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
        self._gusts_for(wind, moment).velocity(wind, _carried(wind, moment), x, z, out_x, out_z)

    def _gusts_for(self, wind: Wind, moment: Moment) -> Gusts:
        key, needed = gust_key(wind), (gust_key(moment.before), gust_key(moment.wind))
        if key not in self._gusts:
            for old in [one for one in self._gusts if one not in needed]:
                del self._gusts[old]
            self._gusts[key] = self._prepared.pop(key, None) or gusts_of(wind)
        return self._gusts[key]

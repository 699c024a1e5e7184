"""Strain of a tree in a series of gusts, with its own motion, beside its strain in steady winds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from galewood.constants import WIND_FIELDS
from galewood.measurements import MotionRecord
from galewood.motion.wind import Wind, WindState, height_factor, speed_of_pressure
from galewood.solid.beams import NoEquilibrium, bent
from galewood.solid.fem import Place, point_pressures
from galewood.solid.strain.gust_motion import SwayingRods
from galewood.solid.strain.sections import (
    CAUTION_TEXT,
    Part,
    RodSections,
    Section,
    TreeStrain,
    strain_in_wind,
)
from galewood.solid.strain.tree_rods import WindRods
from galewood.util import Floats

FRAME_S = 1 / 30
FINEST_PHASE_RAD = 0.12
"""Largest phase of the first mode in a step: Newmark's method lowers its frequency by at most 0.12 %."""
LONGEST_LOOK_S, LOOKS_PER_PERIOD = 0.1, 12
"""The strain is computed this often: less than 2 % of a peak lie between, on average 1 %."""
SETTLING_S = 20.0
"""The tree starts at rest in the mean wind; what it does until it has swung in is not counted."""
SHORTEST_S, LONGEST_S = 1.0, 3600.0


class GustPeak(NamedTuple):
    """The largest strain of a part in the gusts: where, when, and beside steady winds.

    over_mean and over_gust: over the largest strain of the part in a steady wind of the mean speed, and of
    the strongest gust (None: the tree has no equilibrium in it). rms: of the fluctuation there.
    """

    section: Section
    time_s: float
    rms: float
    over_mean: float
    over_gust: float | None


@dataclass(frozen=True)
class GustStrain:
    """Bending strain of a tree in gusts; t times, s sections, those of ``in_mean``.

    time_s (t,); wind_m_s (t,) at the top of the tree; strain (t, s) at the outermost fibre, rms (s,) of its
    fluctuation about the mean bending; breast_height_strain (t,) along the mean wind, positive on its
    side that the wind pulls (None: the stem is lower than 1.3 m). in_mean and in_gust: strain in steady winds
    of the mean speed and of the strongest gust of the series (None: no equilibrium).
    """

    time_s: Floats
    wind_m_s: Floats
    strain: npt.NDArray[np.float32] = field(repr=False)
    rms: Floats
    breast_height_strain: Floats | None
    in_mean: TreeStrain
    in_gust: TreeStrain | None
    frequency_hz: float
    """First natural frequency in the mean wind."""
    rupture_strain: float
    """Of green wood, without knots: where the series exceeds it, the tree would have broken."""

    @property
    def mean_m_s(self) -> float:
        """Mean wind at the top."""
        return self.in_mean.wind_m_s

    @property
    def gust_m_s(self) -> float:
        """Strongest gust at the top."""
        return float(self.wind_m_s.max())

    @property
    def breast_height_factor(self) -> float | None:
        """Largest strain at 1.3 m over that in a steady wind of the mean speed: the gust response factor."""
        steady_strain = self.in_mean.breast_height_strain
        if self.breast_height_strain is None or not steady_strain:
            return None
        return float(np.abs(self.breast_height_strain).max()) / steady_strain

    def peak(self, part: Part = "stem") -> GustPeak | None:
        """The largest strain of a part in the series; None: the tree has no boughs of 4 cm."""
        still = self.in_mean.largest(part)
        if still is None:
            return None
        own = np.flatnonzero(self.in_mean.stem if part == "stem" else self.in_mean.bough)
        when, at = np.unravel_index(int(np.argmax(self.strain[:, own])), (len(self.strain), len(own)))
        at = own[at]
        in_gust = self.in_gust and self.in_gust.largest(part)
        largest = float(self.strain[when, at])
        return GustPeak(
            self.in_mean.section(int(at), largest),
            float(self.time_s[when]),
            float(self.rms[at]),
            largest / still.strain if still.strain > 0 else np.nan,
            largest / in_gust.strain if in_gust and in_gust.strain > 0 else None,
        )

    def breast_height_record(self) -> MotionRecord:
        """The strain at 1.3 m with the wind, for ``galewood.analyse_motion``. ValueError: no stem there."""
        if self.breast_height_strain is None:
            raise ValueError("the tree is lower than 1.3 m")
        rate_hz = 1 / float(self.time_s[1] - self.time_s[0])
        return MotionRecord(rate_hz, self.breast_height_strain[:, None], "strain", "1", self.wind_m_s)

    def figures(self) -> dict[str, Any]:
        """Peaks, ratios and the steady strains; JSON-able."""
        peaks: dict[str, Any] = {}
        for part in ("stem", "boughs"):
            found = self.peak(part)
            peaks[part] = found and {**found._asdict(), "section": vars(found.section)}
        breast = self.breast_height_strain
        return {
            "mean_m_s": self.mean_m_s,
            "gust_m_s": self.gust_m_s,
            "seconds": float(self.time_s[-1] - self.time_s[0]),
            "frequency_hz": self.frequency_hz,
            "rupture_strain": self.rupture_strain,
            "peaks": peaks,
            "breast_height": None
            if breast is None
            else {
                "largest": float(np.abs(breast).max()),
                "mean": float(breast.mean()),
                "rms": float(breast.std()),
                "over_mean": self.breast_height_factor,
            },
            "in_mean": self.in_mean.figures(),
            "in_gust": self.in_gust and self.in_gust.figures(),
            "caution": CAUTION_TEXT,
        }


def wind_at_top(wind: Wind, height_m: float) -> float:
    """Mean speed of a wind at the top of a tree, m/s."""
    return wind.mean_speed_m_s * float(height_factor(height_m, wind.height_exponent, wind.reference_height_m))


def with_top_speed(wind: Wind, height_m: float, speed_m_s: float) -> Wind:
    """A wind made stronger or weaker, until its mean speed at the top of a tree is this one.

    Its gusts travel faster in proportion. WindError if the wind cannot be that strong.
    """
    factor = speed_m_s / max(wind_at_top(wind, height_m), 1e-9)
    slowest, fastest = (float(WIND_FIELDS["convection_speed_m_s"][end]) for end in ("low", "high"))
    return replace(
        wind,
        mean_speed_m_s=factor * wind.mean_speed_m_s,
        convection_speed_m_s=min(max(factor * wind.convection_speed_m_s, slowest), fastest),
    )


def strain_in_gusts(
    rods: WindRods,
    wind: Wind,
    seconds: float = 600.0,
    on_progress: Callable[[float], None] = lambda share: None,
) -> GustStrain:
    """Strain in the gusts of a wind, whose mean speed holds at its reference height.

    The tree stands at the origin of the wind; the first 20 s, in which it swings in, are left out. Raises
    ValueError for still air or a length of time out of range, NoEquilibrium if the tree gives way.
    """
    if not SHORTEST_S <= seconds <= LONGEST_S:
        raise ValueError(f"a series must have {SHORTEST_S:g} to {LONGEST_S:g} s")
    speed_m_s = wind_at_top(wind, rods.height_m)
    if speed_m_s <= 0:
        raise ValueError("gusts need a mean wind above 0 m/s")
    _, pose = strain_in_wind(rods, speed_m_s, wind.direction_deg)
    swaying = SwayingRods(rods, rods.wind_load_n(speed_m_s, wind.direction_deg), pose)
    first_hz = float(swaying.modes.frequencies_hz[0])
    dt_s = FRAME_S / np.ceil(2 * np.pi * first_hz * FRAME_S / FINEST_PHASE_RAD)
    every = max(1, int(min(LONGEST_LOOK_S, 1 / (LOOKS_PER_PERIOD * first_hz)) / dt_s + 1e-9))
    steps = dt_s * np.arange(1, int(np.ceil((SETTLING_S + seconds) / dt_s)) + 1)
    speeds: list[float] = []

    def pressures() -> Any:
        winds = point_pressures(
            rods.points_m,
            rods.streamlined_exponent,
            WindState(wind, wind),
            Place(),
            steps,
            height_m=rods.height_m,
        )
        for found in winds:
            speeds.append(float(speed_of_pressure(np.hypot(*found.tree_pa), rods.streamlined_exponent)))
            yield found.node_pa

    series = _Series(rods, wind.direction_deg)
    for load in swaying.loads(pressures(), dt_s, every):
        try:
            pose = bent(rods.rods, load.force_n, pose)
        except NoEquilibrium:
            raise NoEquilibrium(
                f"the tree has no equilibrium {load.time_s - SETTLING_S:.1f} s after the start, in a wind of "
                f"{speeds[-1]:.1f} m/s: it gives way"
            ) from None
        if load.time_s > SETTLING_S:
            series.add(load.time_s - SETTLING_S, speeds[-1], pose)
            on_progress(min((load.time_s - SETTLING_S) / seconds, 1.0))
    return series.found(rods, wind.direction_deg, first_hz)


class _Series:
    """Collects the strain of the sections over time."""

    def __init__(self, rods: WindRods, direction_deg: float) -> None:
        self._sections = RodSections(rods)
        angle = np.deg2rad(direction_deg)
        self._along = np.cross([0.0, 1.0, 0.0], [np.cos(angle), 0.0, np.sin(angle)])
        self._rows: list[tuple[float, float]] = []
        self._strains: list[npt.NDArray[np.float32]] = []
        self._breast: list[float] = []
        count = len(self._sections.radius_m)
        self._sum, self._square = np.zeros((count, 3)), np.zeros(count)

    def add(self, time_s: float, wind_m_s: float, pose: Any) -> None:
        """One pose."""
        moment = self._sections.moments_nm(pose)
        self._rows.append((time_s, wind_m_s))
        self._strains.append(self._sections.strain(np.linalg.norm(moment, axis=1)).astype(np.float32))
        self._sum += moment
        self._square += (moment**2).sum(axis=1)
        breast = self._sections.breast_height_strain(moment)
        if breast is not None:
            self._breast.append(float(breast @ self._along))

    def found(self, rods: WindRods, direction_deg: float, frequency_hz: float) -> GustStrain:
        """The series, and the strain in steady winds."""
        time_s, wind_m_s = np.array(self._rows).T
        count = len(time_s)
        variance = self._square / count - ((self._sum / count) ** 2).sum(axis=1)
        in_mean, pose = strain_in_wind(rods, float(wind_m_s.mean()), direction_deg)
        try:
            in_gust = strain_in_wind(rods, float(wind_m_s.max()), direction_deg, pose)[0]
        except NoEquilibrium:
            in_gust = None
        return GustStrain(
            time_s,
            wind_m_s,
            np.array(self._strains),
            self._sections.strain(np.sqrt(np.maximum(variance, 0.0))),
            np.array(self._breast) if self._breast else None,
            in_mean,
            in_gust,
            frequency_hz,
            rods.wood.rupture_strain,
        )

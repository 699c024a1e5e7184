"""Largest horizontal reach of a tree in gusts, by height and direction, from many places of a gust field."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from galewood.check.envelope.hours import WindClass
from galewood.motion.wind import PRESETS, Wind, WindField
from galewood.player import WindDrivenTrees
from galewood.solid.skinning import drawn_tracks
from galewood.table import Table
from galewood.util import Floats, Int64s

REACH_DIRECTIONS = 16
BAND_COUNT = 8
OUTERMOST_VERTICES = 10
"""Vertices of each band that reach farthest at rest, in each direction, are followed."""
SETTLING_S = 20.0
"""The trees start at rest; what they do until they have swung in is not counted."""
LOOK_INTERVAL_S = 0.1
WIND_HEIGHT_M = 10.0
"""Height of the mean winds, as weather stations measure them."""
APART_M = 200.0
"""Between the trees, across the wind: farther than gusts are wide."""
REPORTED_QUANTILES = (0.5, 0.9)


@dataclass(frozen=True)
class SwayEnvelope:
    """Reach from the axis of the trunk's base, m, by bands of height (b,) and directions (d,).

    Directions are angles from x (east) to z (south), degrees. rest_m (b, d) at rest; reach_m (k, b, d): the
    largest in each of k samples of gusts, and over all classes of wind. height_m (b + 1,): edges of the
    bands, by the heights at rest.
    """

    height_m: Floats
    direction_deg: Floats
    rest_m: Floats
    reach_m: Floats
    seconds: float
    classes: tuple[WindClass, ...]

    def quantile_m(self, share: float) -> Floats:
        """(b, d) reach that a share of the samples do not exceed."""
        return np.quantile(self.reach_m, share, axis=0)

    def figures(self) -> dict[str, Any]:
        """Reach at rest, median and 90 %; JSON-able."""
        return {
            "height_m": self.height_m.tolist(),
            "direction_deg": self.direction_deg.tolist(),
            "rest_m": self.rest_m.tolist(),
            "reach_m": {f"{share:.0%}": self.quantile_m(share).tolist() for share in REPORTED_QUANTILES},
            "samples": len(self.reach_m),
            "seconds": self.seconds,
            "winds": [vars(one) for one in self.classes],
        }


def sway_envelope(
    table: Table,
    rest_m: Floats,
    classes: Sequence[WindClass],
    *,
    sample_count: int = 16,
    seconds: float = 120.0,
    seed: int = 1,
    on_progress: Callable[[float], None] = lambda share: None,
) -> SwayEnvelope:
    """The envelope of a tree whose render vertices rest at ``rest_m`` (v, 3), over classes of wind.

    In each class ``sample_count`` trees stand far apart in one field of gusts for some seconds. Raises
    ValueError for no classes or samples.
    """
    if not classes or sample_count < 1 or seconds <= 0:
        raise ValueError("an envelope needs a wind, at least one sample, and a time above 0 s")
    outline = _Outline(table, rest_m)
    found = np.tile(outline.rest(), (sample_count, 1, 1))
    for k, one in enumerate(classes):
        found = np.maximum(found, _in_class(table, outline, one, sample_count, seconds, seed + k))
        on_progress((k + 1) / len(classes))
    return SwayEnvelope(
        outline.height_m, outline.direction_deg, outline.rest(), found, seconds, tuple(classes)
    )


def gusts_in_class(one: WindClass, seed: int) -> Wind:
    """The gusts of a class of wind."""
    return replace(
        PRESETS["autumn-gusts"],
        mean_speed_m_s=one.speed_m_s,
        reference_height_m=WIND_HEIGHT_M,
        convection_speed_m_s=max(one.speed_m_s, 2.0),
        direction_deg=one.direction_deg,
        seed=seed,
    )


def places_in_class(one: WindClass, count: int) -> Floats:
    """(count, 4) x, z (m), yaw and scale of the trees in a class of wind."""
    angle = np.radians(one.direction_deg)
    place = APART_M * (np.arange(count) - count / 2)[:, None] * np.array([-np.sin(angle), np.cos(angle)])
    return np.asarray(np.column_stack([place, np.zeros(count), np.ones(count)]), np.float64)


def _in_class(
    table: Table, outline: _Outline, one: WindClass, count: int, seconds: float, seed: int
) -> Floats:
    """(count, b, d) largest reach of each tree."""
    forest = WindDrivenTrees(table, places_in_class(one, count))
    field = WindField(gusts_in_class(one, seed))
    dt_s = float(table.metadata["dt_s"])
    every = max(1, round(LOOK_INTERVAL_S / dt_s))
    largest = np.full((count, *outline.rest().shape), -np.inf)
    for frame in range(1, round((SETTLING_S + seconds) / dt_s) + 1):
        forest.step(field, frame * dt_s, dt_s)
        if frame * dt_s > SETTLING_S and frame % every == 0:
            np.maximum(largest, outline.reach(forest.q.astype(np.float64)), out=largest)
    return largest


class _Outline:
    """The outermost vertices of a tree by bands of height."""

    def __init__(self, table: Table, rest_m: Floats) -> None:
        angle = 2 * np.pi * np.arange(REACH_DIRECTIONS) / REACH_DIRECTIONS
        self.direction_deg: Floats = np.degrees(angle)
        self._toward = np.stack([np.cos(angle), np.sin(angle)])
        low, high = float(rest_m[:, 1].min()), float(rest_m[:, 1].max())
        self.height_m: Floats = np.linspace(low, high, BAND_COUNT + 1)
        band = np.clip(np.searchsorted(self.height_m, rest_m[:, 1]) - 1, 0, BAND_COUNT - 1)
        chosen = _outermost(rest_m, band, self._toward)
        self._rest, self._modes = rest_m[chosen], len(table.mode_scale)
        self._skin = replace(table, vertex_joint=table.vertex_joint[chosen])
        self._filled, self._starts = np.unique(band[chosen], return_index=True)

    def rest(self) -> Floats:
        """(b, d) reach at rest; 0 where there is no wood or leaf."""
        return self.reach(np.zeros((1, self._modes)))[0]

    def reach(self, q: Floats) -> Floats:
        """(n, b, d) reach of the vertices as they are drawn in the poses q (n, r)."""
        moved = drawn_tracks(self._skin, self._rest, q)[:, :, [0, 2]]
        own = np.maximum.reduceat(moved @ self._toward, self._starts, axis=1)
        found = np.zeros((len(q), BAND_COUNT, REACH_DIRECTIONS))
        found[:, self._filled] = own
        return found


def _outermost(rest_m: Floats, band: Int64s, toward: Floats) -> Int64s:
    """Vertices, band by band, among which are those that reach farthest in every direction."""
    chosen: list[Int64s] = []
    extent = rest_m[:, [0, 2]] @ toward
    for k in range(BAND_COUNT):
        inside = np.flatnonzero(band == k)
        if len(inside):
            farthest = np.argsort(-extent[inside], axis=0)[:OUTERMOST_VERTICES]
            chosen.append(inside[np.unique(farthest)])
    return np.concatenate(chosen)

"""How far a tree of a table reaches in gusts."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from galewood.check.envelope import SwayEnvelope, WindClass, wind_classes
from galewood.check.envelope import sway_envelope as envelope_of
from galewood.io.api.expected import expect
from galewood.io.api.tables import MotionTable


def sway_envelope(
    table: MotionTable,
    *,
    wind_m_s: float | None = None,
    direction_deg: float = 0.0,
    winds: str | Path | None = None,
    sample_count: int = 16,
    seconds: float = 120.0,
    seed: int = 1,
    on_progress: Callable[[float], None] | None = None,
) -> SwayEnvelope:
    """The largest horizontal reach of a tree in gusts, by height and direction.

    Args:
        table: Its motion table, with the mesh that it moves.
        wind_m_s: Mean speed at 10 m. Give either this or ``winds``.
        direction_deg: The wind blows towards (cos θ, 0, sin θ).
        winds: Table of hourly (or other) winds of a week or a year: the envelope is that of all its classes.
        sample_count: Trees that stand far apart in the gusts of each class.
        seconds: How long each of them is followed.
        seed: Seed of the gusts.
        on_progress: Receives the fraction done; whatever it raises ends the calculation.

    Raises:
        ValueError: The table has no mesh, or the options are wrong.
        TypeError: ``table`` is something else.
        MeasurementError: The winds cannot be read (a ValueError).
    """
    expect("table", table, MotionTable)
    if (wind_m_s is None) == (winds is None):
        raise ValueError("give either wind_m_s or winds")
    classes = wind_classes(winds) if winds is not None else (WindClass(wind_m_s or 0.0, direction_deg, 1),)
    return envelope_of(
        table.table,
        table.rest_vertices_m,
        classes,
        sample_count=sample_count,
        seconds=seconds,
        seed=seed,
        on_progress=on_progress or (lambda share: None),
    )

"""The error of a motion table against the finite-element reference solution."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

import tempfile
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from galewood.check.evaluation import GustCase, evaluate_in_gusts, evaluate_table, source_of
from galewood.io.api.cache import default_cache_dir
from galewood.io.api.expected import expect
from galewood.io.api.models import pressure_at_origin
from galewood.io.api.tables import MotionTable
from galewood.motion.wind import Wind
from galewood.options import EVALUATION_SEED, EvaluationOptions
from galewood.util import Floats


def evaluate(
    table: MotionTable,
    winds: Mapping[str, Wind] | None = None,
    *,
    duration_s: float = 20.0,
    sway: float | None = None,
    seed: int = EVALUATION_SEED,
    cache_dir: Path | None = None,
    on_progress: Callable[[float, str], None] | None = None,
) -> dict[str, Any]:
    """Compare a table with the model that it was built from, on winds that it was not built from.

    First in gusts that differ within the crown, as a forest plays them; then in winds that are the same over
    the whole crown.

    Args:
        table: A table built on this machine: its model is in the cache.
        winds: Names and winds; by default gusts of two speeds and two sways, and seven uniform winds.
        duration_s: Length of each run.
        sway: Scale each wind until the reference sways by this share of the height; None: as they are.
        seed: Seed of the default winds, and of the place and yaw of the tree in gusts.
        cache_dir: The folder that the table was built with.
        on_progress: Receives the fraction done and a message.

    Returns:
        "gusts" and "uniform": per wind and method ("modal", "paper", and baselines) the ``max_error`` over
        the height and others (spec/formats/evaluation.md).

    Raises:
        TypeError: ``table`` or a wind is something else.
        SourceError: The table's model or mesh is not available.
    """
    expect("table", table, MotionTable)
    for name, wind in (winds or {}).items():
        expect(f"winds[{name!r}]", wind, Wind)
    report = on_progress or _no_progress
    cache = cache_dir or default_cache_dir()
    dt_s = float(table.metadata["dt_s"])
    frames = max(60, round(duration_s / dt_s))
    given, cases = None, None
    if winds is not None:
        time_s: Floats = dt_s * np.arange(1, frames + 1, dtype=np.float64)
        exponent = table.table.streamlined_exponent
        given = {
            name: pressure_at_origin(wind, table.height_m, time_s, exponent) for name, wind in winds.items()
        }
        cases = {name: GustCase(wind, sway) for name, wind in winds.items()}
    with tempfile.TemporaryDirectory(prefix="galewood-") as folder:
        mesh = Path(folder, "tree.glb")
        if table.render_glb is None:
            raise ValueError("this table has no mesh: load it with galewood.load(path, mesh=...)")
        mesh.write_bytes(table.render_glb)
        source = source_of(table.table, mesh, cache, lambda f, m: report(0.2 * f, m))
    options = EvaluationOptions(frames=frames, sway=sway, seed=seed)
    in_gusts = evaluate_in_gusts(
        table.table, source, options, cache, lambda f, m: report(0.2 + 0.4 * f, m), cases=cases
    )
    uniform = evaluate_table(
        table.table, source, options, cache, lambda f, m: report(0.6 + 0.4 * f, m), winds=given
    )
    return {"gusts": in_gusts, "uniform": uniform}


def _no_progress(fraction: float, message: str) -> None:
    pass

"""Models beside the recorded motion of the real tree."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import get_args

from galewood.check.sway import Calibration, SwayAnalysis, analyse_motion, calibrated
from galewood.check.sway import simulated_motion as motion_of_table
from galewood.io.api.expected import expect
from galewood.io.api.models import Model
from galewood.io.api.tables import MotionTable
from galewood.io.api.trees import Tree
from galewood.measurements import MotionRecord, read_motion
from galewood.options import USUAL_TETS
from galewood.solid.fem import FemModel, FemSettings
from galewood.table import Foliage
from galewood.wood import Wood, wood_of_species


def calibrate(
    tree: Tree,
    motion: SwayAnalysis | MotionRecord | str | Path,
    *,
    wood: Wood | None = None,
    foliage: Foliage = "leaf",
    target_tets: int = USUAL_TETS,
    settings: FemSettings | None = None,
    on_progress: Callable[[float], None] | None = None,
    cache_dir: Path | None = None,
) -> Calibration:
    """Fit the modulus and the damping of a tree's wood to a record of its own motion.

    The calibrated ``wood`` can be given to ``build``, ``Model``, ``strain`` and ``critical_wind``.

    Args:
        tree: The tree (``galewood.read``).
        motion: Its record: a file, a record (``galewood.read_motion``) or the analysis of one
            (``galewood.analyse_motion``). The damping by drag is subtracted if the record has a wind.
        wood: Where to start; by default the wood of the tree's species.
        foliage: "bare" for a record of the leafless tree.
        target_tets: Number of tetrahedra to aim at.
        settings: Elements, foundation and time step of the model.
        on_progress: Receives the fraction done; whatever it raises ends the calibration.
        cache_dir: Folder for meshes; by default the user's cache folder.

    Raises:
        MeshError: The wood cannot be meshed.
        MeasurementError: The file cannot be read (a ValueError).
        TypeError: ``tree`` is something else.
        ValueError: The record has no resonance.
    """
    expect("tree", tree, Tree)
    if foliage not in get_args(Foliage):
        raise ValueError(f"foliage must be one of {', '.join(get_args(Foliage))}, not {foliage!r}")
    analysis = motion if isinstance(motion, SwayAnalysis) else analyse_motion(motion)

    def model_of(one: Wood) -> FemModel:
        return Model(
            tree, wood=one, foliage=foliage, target_tets=target_tets, settings=settings, cache_dir=cache_dir
        ).fem

    if wood is not None:
        expect("wood", wood, Wood)
    start = wood or wood_of_species(tree.species or "default")
    return calibrated(analysis, start, model_of, on_progress or (lambda share: None))


def simulated_motion(
    table: MotionTable, record: MotionRecord | str | Path, *, direction_deg: float = 0.0
) -> MotionRecord:
    """The sway of a table's tree in the wind of a record, to be analysed like it (``analyse_motion``).

    Args:
        table: The motion table of the tree.
        record: A record with a wind, or its file. The wind is taken as that at the top of the tree, and over
            its whole crown.
        direction_deg: The wind blows towards (cos θ, 0, sin θ) of the tree.

    Returns:
        Displacements of the top along x and z at the times of the record; accelerations if it has those.

    Raises:
        MeasurementError: The file cannot be read (a ValueError).
        TypeError: ``table`` is something else.
        ValueError: The record has no wind.
    """
    expect("table", table, MotionTable)
    measured = record if isinstance(record, MotionRecord) else read_motion(record)
    return motion_of_table(table.table, measured, direction_deg)

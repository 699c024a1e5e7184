"""Checks of the shipped tables: each tree is built again, and both tables play unseen winds."""

from __future__ import annotations

import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from galewood.check.evaluation import Source, evaluate_table, source_of
from galewood.check.verify.checks import Check, absolute, skipped
from galewood.options import EvaluationOptions
from galewood.pipeline.results import BUILTIN_OPTIONS, SHIPPED_FOLDER, ShippedTree, read_shipped
from galewood.pipeline.stages import BuiltinMesh, build_table, builtin_meshes
from galewood.pipeline.tables import BuildOptions
from galewood.table import Table, decode

FRAME_COUNT = 300
WIND_SEED = 77_003
SAME_MESH, OTHER_MESH = 1e-6, 0.05
"""Limits of the worst of ten frequencies: same tetrahedra, and meshed again (meshes scatter by 3 %)."""
SAME_ERRORS = 1.05
"""The errors of the shipped table may be this much larger than those of the rebuilt one."""
ORDINARY_ERROR = 0.005
"""Limit of the largest vertex error in ordinary winds, relative to the height."""


def checks(species_dir: Path) -> Iterator[Check]:
    """Checks of all built-in trees of a folder."""
    for mesh in builtin_meshes(species_dir):
        shipped = read_shipped(species_dir / SHIPPED_FOLDER, mesh.name, mesh.key)
        if shipped is None:
            reason = "no shipped files for this mesh and version: run `galewood ship`"
            yield absolute(f"{mesh.name}, shipped: files missing or outdated", 1.0, 0.0, reason)
            continue
        yield from of_tree(mesh, shipped)


def of_tree(mesh: BuiltinMesh, shipped: ShippedTree) -> Iterator[Check]:
    """Checks of one shipped tree."""
    with tempfile.TemporaryDirectory() as folder:
        cache = Path(folder)
        shipped.keep_tetrahedra(cache)
        rebuilt, glb = _built(mesh, cache)
        table = decode(shipped.result.table, shipped.result.records)
        yield _frequencies(f"{mesh.name}, shipped: frequencies, same tetrahedra", table, rebuilt, SAME_MESH)
        yield from _errors(mesh.name, table, rebuilt, glb, cache)
    with tempfile.TemporaryDirectory() as folder:
        again, _ = _built(mesh, Path(folder))
        yield _frequencies(f"{mesh.name}, shipped: frequencies, meshed again", table, again, OTHER_MESH)


def _built(mesh: BuiltinMesh, cache: Path) -> tuple[Table, Path]:
    options = BuildOptions.model_validate(
        {**BUILTIN_OPTIONS, **mesh.options, "paper": False, "bare_table": False}
    )
    source, name = mesh.path.read_bytes(), mesh.path.name
    result = build_table(source, name, options, cache_dir=cache)
    glb = cache / f"{mesh.name}.glb"
    glb.write_bytes(result.render_glb)
    return decode(result.table), glb


def _frequencies(name: str, table: Table, other: Table, limit: float) -> Check:
    own, found = (np.array(one.metadata["frequencies_hz"]) for one in (table, other))
    return absolute(name, float(np.abs(own / found - 1).max()), limit)


def _errors(name: str, table: Table, rebuilt: Table, glb: Path, cache: Path) -> Iterator[Check]:
    """Largest errors in unseen winds, of the shipped table and of the rebuilt one."""
    own, other = (_largest_error(one, source_of(rebuilt, glb, cache), cache) for one in (table, rebuilt))
    title = f"{name}, shipped: largest error in unseen winds"
    yield absolute(f"{title}, of the height", own, ORDINARY_ERROR)
    if other > 0:
        yield absolute(f"{title}, over that of the rebuilt table, less 1", own / other - 1, SAME_ERRORS - 1)
    else:
        yield skipped(title, "the rebuilt table has no error")


def _largest_error(table: Table, source: Source, cache: Path) -> float:
    options = EvaluationOptions(frames=FRAME_COUNT, seed=WIND_SEED)
    found = evaluate_table(table, source, options, cache, lambda fraction, message: None)
    return max(float(methods["modal"]["max_error"]) for methods in found.values())

"""The parts of ``galewood bench``: speed and memory."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from galewood.check.bench.fem import bench_fem
from galewood.check.bench.samples import bench_samples, prepared
from galewood.check.bench.tables import OnProgress, bench_build, bench_forest, bench_search
from galewood.check.bench.waiting import bench_upload
from galewood.check.bench.wind import bench_wind
from galewood.pipeline.tables import BuildOptions
from galewood.table import decode
from galewood.wood import SPECIES

__all__ = ["PARTS", "chosen_parts", "run_bench"]

PARTS = {
    "fem": "a finite-element step, and the same step with other sparse direct solvers",
    "samples": "the 6,480 samples of a table with the fast and with the reference elements",
    "upload": "reading an upload and its first motion, in times of trimesh reading the same file",
    "build": "a build by stage: wall and CPU seconds, memory; the table's size",
    "lookup": "the paper's state search with 35 and with 435 sampled elements",
    "modal": "a step of 10,000 trees with the modal model and with the paper's state search",
    "wind": "the pressure at 10,000 trees, for each wind model",
}
FEM_STEPS, QUICK_FEM_STEPS = 60, 15
RECORDED_POINTS = 140


class Bench:
    """One run of the bench: the parts share a tree, a cache and, once built, a table."""

    def __init__(self, mesh: Path, cache_dir: Path, *, quick: bool, table: Path | None) -> None:
        self._mesh, self._cache_dir, self._quick = mesh, cache_dir, quick
        species = mesh.stem if mesh.stem in SPECIES else None
        self._options = BuildOptions(species=species, height_m=12.0, accept=True, stiffness="as drawn")
        self._table = table.read_bytes() if table else None

    def fem(self, on_progress: OnProgress) -> Any:
        on_progress(0.0, "Preparing the tree")
        model, _, _ = prepared(self._mesh, self._options, self._cache_dir)
        on_progress(0.5, "Timing the finite-element step")
        points = np.linspace(0, model.vertex_count - 1, RECORDED_POINTS).astype(np.int32)
        return bench_fem(model, points, steps=QUICK_FEM_STEPS if self._quick else FEM_STEPS)

    def samples(self, on_progress: OnProgress) -> Any:
        return bench_samples(
            self._mesh, self._options, self._cache_dir, quick=self._quick, on_progress=on_progress
        )

    def upload(self, on_progress: OnProgress) -> Any:
        on_progress(0.0, "Reading the mesh")
        return bench_upload(self._mesh)

    def build(self, on_progress: OnProgress) -> Any:
        # In an empty folder, so that no stage is skipped because of cached results.
        with tempfile.TemporaryDirectory(dir=self._cache_dir) as folder:
            figures, self._table = bench_build(self._mesh, self._options, Path(folder), on_progress)
        return figures

    def lookup(self, on_progress: OnProgress) -> Any:
        return bench_search(
            self._mesh, self._options, self._cache_dir, quick=self._quick, on_progress=on_progress
        )

    def modal(self, on_progress: OnProgress) -> Any:
        if self._table is None:
            _, self._table = bench_build(self._mesh, self._options, self._cache_dir, on_progress)
        on_progress(0.9, "Timing a step of 10,000 trees")
        return bench_forest(decode(self._table))

    def wind(self, on_progress: OnProgress) -> Any:
        on_progress(0.0, "Timing the wind at 10,000 trees")
        return bench_wind()


def run_bench(
    mesh: Path,
    parts: Sequence[str] = (),
    *,
    quick: bool = False,
    table: Path | None = None,
    on_progress: OnProgress,
) -> dict[str, Any]:
    """JSON-able results of the requested parts (none given: all), by part name.

    With a ``table`` file, the part ``modal`` does not have to build one. Raises ValueError for an unknown
    part.
    """
    chosen = chosen_parts(parts)
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(mesh, Path(folder), quick=quick, table=table)
        return {
            part: getattr(bench, part)(_share(on_progress, k, len(chosen))) for k, part in enumerate(chosen)
        }


def chosen_parts(names: Sequence[str]) -> list[str]:
    """The requested parts (none given: all) in the order they run. Raises ValueError for an unknown part."""
    unknown = sorted(set(names) - set(PARTS))
    if unknown:
        raise ValueError(f"unknown part {unknown[0]!r}; choose from {', '.join(PARTS)}")
    return [part for part in PARTS if part in names or not names]


def _share(on_progress: OnProgress, k: int, count: int) -> Callable[[float, str], None]:
    return lambda fraction, message: on_progress((k + fraction) / count, message)

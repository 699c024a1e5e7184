"""Speed and memory: what ``galewood bench`` measures, part by part."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from galewood.bench.fem import bench_fem
from galewood.bench.samples import bench_samples, prepared
from galewood.bench.tables import OnProgress, bench_build, bench_forest, bench_search
from galewood.bench.wind import bench_wind
from galewood.mesh import ImportOptions
from galewood.pipeline import BuildOptions
from galewood.table import decode

__all__ = ["PARTS", "run_bench"]

PARTS = {
    "fem": "a step of the finite elements, beside the same with scipy's general sparse solver",
    "samples": "the 6,480 samples of a table by the fast elements, beside the reference",
    "build": "a build by stages: wall and CPU seconds, memory; the table's bytes",
    "lookup": "the paper's search with 35 and with 435 sampled elements",
    "modal": "a step of 10,000 trees by the drift-free method and by the paper's search",
    "wind": "the wind at 10,000 trees, for each model",
}
RECORDED_POINTS = 140


class Bench:
    """The parts of one run, with what they have in common: a tree, a cache, a table."""

    def __init__(self, mesh: Path, cache_dir: Path, *, quick: bool, table: Path | None) -> None:
        self._mesh, self._cache_dir, self._quick = mesh, cache_dir, quick
        self._options = BuildOptions(mesh_import=ImportOptions(species=mesh.stem, height_m=12.0))
        self._table = table.read_bytes() if table else None

    def fem(self, on_progress: OnProgress) -> Any:
        on_progress(0.0, "Preparing the tree")
        model, _, _ = prepared(self._mesh, self._options, self._cache_dir)
        on_progress(0.5, "Stepping the finite elements")
        return bench_fem(model, np.linspace(0, model.vertex_count - 1, RECORDED_POINTS).astype(np.int32))

    def samples(self, on_progress: OnProgress) -> Any:
        return bench_samples(
            self._mesh, self._options, self._cache_dir, quick=self._quick, on_progress=on_progress
        )

    def build(self, on_progress: OnProgress) -> Any:
        # In a folder of its own: nothing may be there already.
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
        on_progress(0.9, "Stepping 10,000 trees")
        return bench_forest(decode(self._table))

    def wind(self, on_progress: OnProgress) -> Any:
        on_progress(0.0, "Blowing at 10,000 trees")
        return bench_wind()


def run_bench(
    mesh: Path,
    parts: Sequence[str] = (),
    *,
    quick: bool = False,
    table: Path | None = None,
    on_progress: OnProgress,
) -> dict[str, Any]:
    """The figures of the parts asked for (none: all). A ``table`` at hand saves ``tangent`` a build."""
    chosen = [part for part in PARTS if part in parts or not parts]
    with tempfile.TemporaryDirectory() as folder:
        bench = Bench(mesh, Path(folder), quick=quick, table=table)
        return {
            part: getattr(bench, part)(_share(on_progress, k, len(chosen))) for k, part in enumerate(chosen)
        }


def _share(on_progress: OnProgress, k: int, count: int) -> Callable[[float, str], None]:
    return lambda fraction, message: on_progress((k + fraction) / count, message)

"""The extent of ``galewood paper`` and its cache, which lets an interrupted run continue.

The cache holds results that the same code and plan always reproduce: simulated runs, tables and their
errors. It never holds timings; they depend on the machine and are measured in every run.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from galewood.options import USUAL_TETS
from galewood.pipeline.stages import BuiltinMesh, build_table, builtin_meshes
from galewood.pipeline.tables import BuildOptions
from galewood.table import Table, decode, encode
from galewood.util import write_atomically

OnProgress = Callable[[float, str], None]

PAPER_VERSION = 2
UNRELATED_SOURCES = (
    "check/bench/",
    "check/evaluation/plot.py",
    "check/paper/pictures.py",
    "check/paper/text.py",
    "check/verify/",
    "io/",
    "pipeline/pictures/",
)
"""Sources that cannot change a cached result."""


PAPER_SPECIES = ("poplar", "maple", "apricot")
"""The built-in species that the paper shows."""


@dataclass(frozen=True)
class Plan:
    """The extent of every experiment, and the built-in trees that it covers."""

    meshes: tuple[BuiltinMesh, ...]
    cache_dir: Path
    target_tets: int = USUAL_TETS
    record_frames: int = 180
    frames: int = 600
    elements: tuple[int, ...] = (35, 135, 235, 335, 435)
    element_frames: int = 180
    trees: tuple[int, ...] = (20, 30, 40, 50, 200, 1000, 10_000)
    steps: int = 150
    queries: int = 20_000
    seed: int = 40_401
    workers: int = 2
    quick: bool = False

    def options(self, mesh: BuiltinMesh) -> BuildOptions:
        """Build options of a tree's table."""
        return BuildOptions(
            **mesh.options,
            stiffness="as drawn",
            target_tets=self.target_tets,
            sampled_elements=self.elements[0],
            frames=self.record_frames,
            all_cosine_winds=True,
        )


def full_plan(meshes: Path, cache_dir: Path, workers: int = 2) -> Plan:
    """The experiments at the extent of the paper, on the trees of its species in the folder ``meshes``."""
    own = (mesh for mesh in builtin_meshes(meshes) if mesh.options["species"] in PAPER_SPECIES)
    return Plan(tuple(own), cache_dir, workers=workers)


def quick_plan(mesh: BuiltinMesh, cache_dir: Path) -> Plan:
    """The smallest extent that still runs every experiment, on one tree."""
    return Plan(
        (mesh,), cache_dir, target_tets=800, record_frames=60, frames=60, elements=(6, 12),
        element_frames=20, trees=(20, 50), steps=10, queries=200, workers=1, quick=True,
    )  # fmt: skip


@dataclass
class Notes:
    """Cache of reproducible results, keyed by the code, the plan and what else they depend on.

    Never pass a timing through it: a cached timing would be that of another run.
    """

    plan: Plan
    code: str = field(default_factory=lambda: code_hash())

    def kept(self, name: str, depends: str, make: Callable[[], Any]) -> Any:
        """Return the JSON-able result of ``make``, cached while code, plan and ``depends`` stay the same."""
        path = self._path(f"{name}-", depends, ".json")
        if not path.exists():
            write_atomically(path, json.dumps(make(), default=float).encode())
        return json.loads(path.read_text())

    def table(self, name: str, depends: str, make: Callable[[], Table]) -> Table:
        """Return the table that ``make`` builds, cached like the results of ``kept``."""
        path = self._path(f"{name}-", depends, ".gwt")
        if not path.exists():
            write_atomically(path, encode(make()))
        return decode(path.read_bytes())

    def _path(self, prefix: str, depends: str, suffix: str) -> Path:
        digest = hashlib.sha256(f"{PAPER_VERSION} {self.code} {self.plan} {depends}".encode()).hexdigest()
        return self.plan.cache_dir / "paper" / f"{prefix}{digest[:24]}{suffix}"


def code_hash() -> str:
    """SHA-256 of the sources of all galewood modules that can change a cached result."""
    root = Path(__file__).parents[2]
    digest = hashlib.sha256()
    for path in sorted(root.rglob("*.py")):
        name = path.relative_to(root).as_posix()
        if not name.startswith(UNRELATED_SOURCES):
            digest.update(name.encode() + path.read_bytes())
    return digest.hexdigest()


def built(plan: Plan, notes: Notes, mesh: BuiltinMesh, on_progress: OnProgress) -> tuple[Table, Path, Path]:
    """Build a tree's table unless it is cached; return it, its file and the render mesh beside it."""
    source, options = mesh.path.read_bytes(), plan.options(mesh)
    key = hashlib.sha256(f"{notes.code} {options}".encode() + source).hexdigest()[:24]
    path = plan.cache_dir / "paper" / f"{mesh.name}-{key}.gwt"
    if not path.exists():
        result = build_table(
            source,
            mesh.path.name,
            options,
            progress=lambda p: on_progress(p.fraction, f"{mesh.name}: {p.message}"),
            cache_dir=plan.cache_dir,
        )
        write_atomically(path.with_suffix(".glb"), result.render_glb)
        write_atomically(path, result.whole_table())
    return decode(path.read_bytes()), path, path.with_suffix(".glb")

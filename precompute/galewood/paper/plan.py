"""What ``galewood paper`` measures, and what it keeps so that a stopped run goes on."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from galewood.mesh import ImportOptions
from galewood.pipeline import BuildOptions, build_table
from galewood.table import Table, decode
from galewood.util import write_whole

OnProgress = Callable[[float, str], None]

PAPER_VERSION = 1
SPECIES = ("poplar", "maple", "apricot")


@dataclass(frozen=True)
class Plan:
    """The extent of every experiment."""

    meshes: dict[str, Path]
    cache_dir: Path
    height_m: float | None = None
    target_tets: int = 5500
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

    def options(self, species: str) -> BuildOptions:
        """How a species' table is built."""
        return BuildOptions(
            mesh_import=ImportOptions(species=species, height_m=self.height_m),
            target_tets=self.target_tets,
            sampled_elements=self.elements[0],
            frames=self.record_frames,
        )


def full_plan(meshes: Path, cache_dir: Path, workers: int = 2) -> Plan:
    """The paper's experiments as the paper has them."""
    return Plan({name: meshes / f"{name}.glb" for name in SPECIES}, cache_dir, workers=workers)


def quick_plan(meshes: dict[str, Path], cache_dir: Path) -> Plan:
    """The same at the smallest extent that still goes through everything."""
    return Plan(
        meshes, cache_dir, target_tets=800, record_frames=60, frames=60, elements=(6, 12),
        element_frames=20, trees=(20, 50), steps=10, queries=200, workers=1, quick=True,
    )  # fmt: skip


@dataclass
class Notes:
    """Figures of one run, kept by what they depend on."""

    plan: Plan
    code: str = field(default_factory=lambda: code_hash())

    def kept(self, name: str, depends: str, make: Callable[[], Any]) -> Any:
        """The JSON-able result of ``make``, from the cache if code, plan and ``depends`` are the same."""
        digest = hashlib.sha256(f"{PAPER_VERSION} {self.code} {self.plan} {depends}".encode()).hexdigest()
        path = self.plan.cache_dir / "paper" / f"{name}-{digest[:24]}.json"
        if not path.exists():
            write_whole(path, json.dumps(make(), default=float).encode())
        return json.loads(path.read_text())


def code_hash() -> str:
    """Hash of every module that can change a figure."""
    here = Path(__file__).parent
    digest = hashlib.sha256()
    for path in sorted(here.rglob("*.py")):
        if not path.name.startswith(
            ("paper_text", "paper_pictures", "evaluate_plot", "cli", "bench", "verify")
        ):
            digest.update(path.name.encode() + path.read_bytes())
    return digest.hexdigest()


def built(plan: Plan, notes: Notes, species: str, on_progress: OnProgress) -> tuple[Table, Path, Path]:
    """A species' table, its file, and the render mesh beside it; built unless it is there."""
    source, options = plan.meshes[species].read_bytes(), plan.options(species)
    key = hashlib.sha256(f"{notes.code} {options}".encode() + source).hexdigest()[:24]
    path = plan.cache_dir / "paper" / f"{species}-{key}.gwt"
    if not path.exists():
        result = build_table(
            source,
            plan.meshes[species].name,
            options,
            progress=lambda p: on_progress(p.fraction, f"{species}: {p.message}"),
            cache_dir=plan.cache_dir,
        )
        write_whole(path.with_suffix(".glb"), result.render_glb)
        write_whole(path, result.table)
    return decode(path.read_bytes()), path, path.with_suffix(".glb")

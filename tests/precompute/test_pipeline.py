"""The build pipeline on a small tree: from a mesh file to a table, artefacts, cancellation and resumption."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from galewood.mesh.types import ImportOptions
from galewood.pipeline.build import build_table
from galewood.pipeline.options import BuildOptions, BuildResult, Progress
from galewood.player.paper_search import PaperForest
from galewood.sampling.runner import SampleTask, run_task
from galewood.table.format import decode
from galewood.util import Cancelled, MeshError

from tests.precompute.shared_tets import TARGET_TETS, cache_with_tets, small_tree_glb

OPTIONS = BuildOptions(
    mesh_import=ImportOptions(species="maple"),
    target_tets=TARGET_TETS,
    sampled_elements=8,
    design_speed_m_s=20.0,
    frames=12,
    reference_frames=12,
)


@dataclass
class Built:
    """A build with all its progress reports and artefacts."""

    cache: Path
    progress: list[Progress] = field(default_factory=list[Progress])
    out: dict[str, bytes] = field(default_factory=dict[str, bytes])
    left_at_preliminary: int = 0
    result: BuildResult | None = None

    def sampled(self, tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        for count, task in enumerate(tasks, 1):
            run_task(task)
            done(count)
            if "preliminary.table" not in self.out:
                self.left_at_preliminary = len(tasks) - count
        return [task.path for task in tasks]


@pytest.fixture(scope="module")
def mesh() -> bytes:
    return small_tree_glb()


@pytest.fixture(scope="module")
def built(mesh: bytes, tmp_path_factory: pytest.TempPathFactory) -> Built:
    build = Built(cache_with_tets(tmp_path_factory.mktemp("built") / "cache", tmp_path_factory))
    publish = build.out.__setitem__
    build.result = build_table(
        mesh, "tree.glb", OPTIONS, build.sampled, build.progress.append, build.cache, publish
    )
    return build


def in_this_process(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
    paths = [run_task(task) for task in tasks]
    done(len(tasks))
    return paths


def test_a_mesh_becomes_a_table_that_moves(built: Built) -> None:
    assert built.result
    table, reports = decode(built.result.table), built.progress
    assert reports[0].stage == "import"
    assert reports[-1].stage == "done"
    assert reports[-1].fraction == 1.0
    assert all(a.fraction <= b.fraction + 1e-9 for a, b in pairwise(reports))
    assert table.metadata["species"] == "maple"
    assert sum(p["vertices"] for p in table.metadata["primitives"]) == len(table.vertex_node)
    forest = PaperForest(table, 1)
    for _ in range(40):
        forest.advance(1 / 30, [20.0], [0.0])
    assert 0 < np.abs(forest.q).max() < 5.0


def test_the_report_covers_every_stage_and_the_reference_model(built: Built) -> None:
    assert built.result
    report = built.result.report
    assert set(report["seconds"]) >= {"import", "meshing", "sampling", "table"}
    assert set(report["cpu_seconds"]) == set(report["seconds"])
    reference = report["model"]["reference"]
    assert reference["frames"] == 12
    assert len(reference["frequency_ratio"]) == 10
    assert reference["trajectory_error"] < 0.2


def test_pictures_and_a_preliminary_table_are_published_during_the_build(built: Built) -> None:
    assert set(built.out) >= {"tetrahedra.png", "skeleton.png", "preliminary.table"}
    for name in ("tetrahedra.png", "skeleton.png"):
        assert built.out[name].startswith(b"\x89PNG")
        assert len(built.out[name]) <= 200_000
    assert built.result
    preliminary, whole = decode(built.out["preliminary.table"]), decode(built.result.table)
    assert built.left_at_preliminary > 30
    assert preliminary.metadata["provenance"]["preliminary"] is True
    assert "preliminary" not in whole.metadata["provenance"]
    assert 0 < len(preliminary.dq) < len(whole.dq) / 2
    assert preliminary.metadata["mesh_sha256"] == whole.metadata["mesh_sha256"]


def test_an_interrupted_build_continues_from_the_cache(mesh: bytes, built: Built) -> None:
    """One cached run is truncated and one is missing: only these two are simulated."""
    simulated: list[str] = []

    def run(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        simulated.extend(task.wind.name for task in tasks if not task.path.exists())
        return in_this_process(tasks, done)

    runs = sorted((built.cache / "trajectories").glob("*.npz"))
    runs[3].unlink()
    runs[7].write_bytes(runs[7].read_bytes()[:-100])
    again = build_table(mesh, "tree.glb", OPTIONS, run, cache_dir=built.cache)
    assert len(simulated) == 2
    assert built.result
    assert again.table == built.result.table


@pytest.mark.parametrize("stage", ["skeleton", "table"])
def test_an_exception_in_the_progress_cancels_the_build(mesh: bytes, built: Built, stage: str) -> None:
    def stop(progress: Progress) -> None:
        if progress.stage == stage:
            raise Cancelled

    with pytest.raises(Cancelled):
        build_table(mesh, "tree.glb", OPTIONS, in_this_process, stop, built.cache)


def test_a_file_that_is_not_a_mesh_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MeshError):
        build_table(b"not a mesh at all", "tree.glb", OPTIONS, in_this_process, cache_dir=tmp_path)

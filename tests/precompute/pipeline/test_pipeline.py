"""The build pipeline on a small tree: from a mesh file to a table, artefacts, cancellation and resumption."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from galewood.check.evaluation.model_file import tets_of
from galewood.pipeline.reduction import linear_motion, oscillators_of
from galewood.pipeline.results import BuildResult
from galewood.pipeline.sampling.recording import SampleWind
from galewood.pipeline.sampling.runner import SampleTask, run_task
from galewood.pipeline.stages.build import build_table
from galewood.pipeline.stages.stage import Progress, Stage
from galewood.pipeline.tables.options import BuildOptions
from galewood.player.modal_forest import ModalForest
from galewood.player.paper_search import PaperForest
from galewood.solid.fem import load_model
from galewood.solid.skinning import points_embedding
from galewood.table.format import decode
from galewood.util import Cancelled, MeshError

from tests.precompute.fixtures.shared_tets import TARGET_TETS, cache_with_tets, small_tree_glb

OPTIONS = BuildOptions(
    species="maple",
    target_tets=TARGET_TETS,
    sampled_elements=8,
    design_speed_m_s=20.0,
    frames=12,
    reference_frames=12,
    stiffness="as drawn",
)
UNCOMPARED = OPTIONS.model_copy(update={"reference_frames": 0})
"""For the builds whose report is not looked at."""

pytestmark = pytest.mark.usefixtures("one_worker")


@dataclass
class Built:
    """A build with all its progress reports and artefacts."""

    cache: Path
    progress: list[Progress] = field(default_factory=list[Progress])
    out: dict[str, bytes] = field(default_factory=dict[str, bytes])
    default: BuildResult | None = None
    result: BuildResult | None = None

    def sampled(self, tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        for count, task in enumerate(tasks, 1):
            run_task(task)
            done(count)
        return [task.path for task in tasks]

    def complete(self, default: BuildResult) -> None:
        self.default = default
        assert self.progress[-1].stage == "table"


@pytest.fixture(scope="module")
def mesh() -> bytes:
    return small_tree_glb()


@pytest.fixture(scope="module")
def built(mesh: bytes, tmp_path_factory: pytest.TempPathFactory) -> Built:
    build = Built(cache_with_tets(tmp_path_factory.mktemp("built") / "cache", tmp_path_factory))
    publish = build.out.__setitem__
    build.result = build_table(
        mesh, "tree.glb", OPTIONS, build.sampled, build.progress.append, build.cache, publish, build.complete
    )
    return build


def in_this_process(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
    paths = [run_task(task) for task in tasks]
    done(len(tasks))
    return paths


def test_a_mesh_becomes_a_table_that_moves(built: Built) -> None:
    assert built.result
    table, reports = decode(built.result.whole_table()), built.progress
    assert reports[0].stage == "import"
    assert reports[-1].stage == "done"
    assert reports[-1].fraction == 1.0
    for own in ([p for p in reports if (p.stage == "records") == paper] for paper in (False, True)):
        assert all(a.fraction <= b.fraction + 1e-9 for a, b in pairwise(own))
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


def test_pictures_are_published_during_the_build(built: Built) -> None:
    for name in ("tetrahedra.png", "skeleton.png"):
        assert built.out[name].startswith(b"\x89PNG")
        assert len(built.out[name]) <= 200_000


def test_a_first_table_precedes_the_complete_one(built: Built) -> None:
    assert built.result and built.default
    first, complete = decode(built.out["beams.table"]), decode(built.default.table)
    assert [name for name in built.out if name.endswith(".table")] == ["beams.table"]
    for table, stage in ((first, "beams"), (complete, "complete")):
        assert table.metadata["provenance"]["stage"] == stage
        assert table.metadata["mesh_sha256"] == complete.metadata["mesh_sha256"]
        assert table.paper is None
    assert first.metadata["provenance"]["preliminary"] is True and first.metadata["provenance"]["left_out"]
    assert "preliminary" not in complete.metadata["provenance"]


def test_the_stages_follow_in_the_order_of_their_list(built: Built) -> None:
    assert built.result
    entered = list(dict.fromkeys(report.stage for report in built.progress))
    assert entered == [stage for stage in Stage if stage is not Stage.BARE]
    assert list(built.result.report["seconds"]) == entered[:-1]


def test_the_natural_modes_alone_are_exact_for_small_sway(built: Built) -> None:
    """In a light wind the linear model, as in the table of beams, moves like the one fitted to the runs."""
    assert built.default
    table = decode(built.default.table)
    model = load_model(built.cache / "models" / f"{table.metadata['provenance']['model_sha256']}.npz")
    wind_pa = np.tile([0.0, 0.3], (120, 1))
    wind_pa[:40, 0] = 0.5
    mass_kg = model.mass_kg[: model.vertex_count]
    wind = SampleWind("light", 0.0, wind_pa)
    linear = linear_motion(oscillators_of(model), mass_kg, [wind], model.settings)
    nodes = points_embedding(table.node_rest_m, tets_of(model))
    vertices, _, r = linear.subspace.basis.shape
    top = int(np.argmax(table.node_rest_m[:, 1]))
    linear_basis = (nodes[top] @ linear.subspace.basis.reshape(vertices, 3 * r)).reshape(3, r)
    crowns: list[np.ndarray] = []
    for modal, basis in (
        (linear.modal, linear_basis),
        (table.modal, table.node_basis[top]),
    ):
        forest = ModalForest(modal, model.settings.dt_s, np.ones(modal.modes, np.float32), 1)
        track: list[np.ndarray] = []
        for x_pa, z_pa in wind_pa:
            forest.advance(model.settings.dt_s, [x_pa], [z_pa])
            track.append(basis.astype(np.float64) @ forest.q[0])
        crowns.append(np.array(track))
    largest_m = np.abs(crowns[1]).max()
    assert largest_m > 0
    assert np.abs(crowns[0] - crowns[1]).max() < 0.05 * largest_m


def test_the_records_follow_in_a_file_of_their_own(built: Built) -> None:
    assert built.result and built.default
    assert built.default.records is None
    assert built.result.table == built.default.table
    assert built.result.records
    records = decode(built.result.table, built.result.records).records
    assert len(records.dq) == sum(records.metadata["frames"])
    assert decode(built.result.whole_table()).paper is not None


def test_the_records_can_be_left_out(mesh: bytes, built: Built) -> None:
    options = UNCOMPARED.model_copy(update={"paper": False})
    alone = build_table(mesh, "tree.glb", options, in_this_process, cache_dir=built.cache)
    assert built.result
    assert alone.records is None
    assert alone.table == built.result.table == alone.whole_table()


def test_an_interrupted_build_continues_from_the_cache(mesh: bytes, built: Built) -> None:
    """One cached run is truncated and one is missing: only these two are simulated."""
    simulated: list[str] = []

    def run(tasks: Sequence[SampleTask], done: Callable[[int], None]) -> list[Path]:
        simulated.extend(task.wind.name for task in tasks if not task.path.exists())
        return in_this_process(tasks, done)

    runs = sorted((built.cache / "trajectories").glob("*.npz"))
    runs[3].unlink()
    runs[7].write_bytes(runs[7].read_bytes()[:-100])
    again = build_table(mesh, "tree.glb", UNCOMPARED, run, cache_dir=built.cache)
    assert len(simulated) == 2
    assert built.result
    assert again.table == built.result.table


@pytest.mark.parametrize("stage", ["skeleton", "table"])
def test_an_exception_in_the_progress_cancels_the_build(mesh: bytes, built: Built, stage: str) -> None:
    def stop(progress: Progress) -> None:
        if progress.stage == stage:
            raise Cancelled

    with pytest.raises(Cancelled):
        build_table(mesh, "tree.glb", UNCOMPARED, in_this_process, stop, built.cache)


def test_a_file_that_is_not_a_mesh_is_refused(tmp_path: Path) -> None:
    with pytest.raises(MeshError):
        build_table(b"not a mesh at all", "tree.glb", OPTIONS, in_this_process, cache_dir=tmp_path)


def test_a_tree_also_gets_a_table_without_its_leaves(mesh: bytes, built: Built) -> None:
    """It is that of a build with the leaves left out, and the other table is the same as without it."""
    assert built.result and built.default
    out: dict[str, bytes] = {}
    complete: list[BuildResult] = []
    both = build_table(
        mesh, "tree.glb", UNCOMPARED.model_copy(update={"bare_table": True}), in_this_process,
        cache_dir=built.cache, publish=out.__setitem__, on_table=complete.append,
    )  # fmt: skip
    alone = build_table(
        mesh, "tree.glb", UNCOMPARED.model_copy(update={"foliage": "bare", "paper": False}), in_this_process,
        cache_dir=built.cache,
    )  # fmt: skip
    assert both.bare_table == alone.table == out["bare.table"]
    assert (both.table, both.records) == (built.result.table, built.result.records)
    assert alone.bare_table is None and built.result.bare_table is None
    assert [result.records for result in complete] == [None, both.records], "records do not wait for it"
    leaf, bare = decode(both.table), decode(alone.table)
    assert (leaf.foliage, bare.foliage) == ("leaf", "bare")
    assert (leaf.streamlined_exponent, bare.streamlined_exponent) == (1.3, 2.0)
    assert bare.metadata["mesh_sha256"] == leaf.metadata["mesh_sha256"]
    assert bare.metadata["primitives"] == leaf.metadata["primitives"]
    assert len(bare.vertex_node) == len(leaf.vertex_node)
    # The leaves of the stub weigh little and the stiffness is fitted anew: the frequency may fall a little.
    assert bare.metadata["frequencies_hz"][0] > 0.99 * leaf.metadata["frequencies_hz"][0]
    leaves_kg = both.report["foliage"]["leaf_mass_kg"]
    assert leaves_kg > 0 == alone.report["foliage"]["leaf_mass_kg"]
    for part in ("foliage", "model", "design_wind", "table"):
        assert both.report["bare_table"][part] == alone.report[part]
    mass_kg = both.report["model"]["mass_kg"] - leaves_kg
    assert alone.report["model"]["mass_kg"] == pytest.approx(mass_kg)


def test_an_evergreen_is_never_bare(mesh: bytes, built: Built) -> None:
    options = UNCOMPARED.model_copy(update={"bare_table": True, "paper": False, "species": "spruce"})
    spruce = build_table(mesh, "tree.glb", options, in_this_process, cache_dir=built.cache)
    assert spruce.bare_table is None
    assert decode(spruce.table).foliage == "leaf"
    assert decode(spruce.table).streamlined_exponent == 1.49


def test_the_table_of_a_mesh_without_leaves_is_bare(built: Built) -> None:
    options = UNCOMPARED.model_copy(update={"bare_table": True, "paper": False})
    wooden = build_table(
        small_tree_glb(leafy=False), "tree.glb", options, in_this_process, cache_dir=built.cache
    )
    assert decode(wooden.table).foliage == "bare" and wooden.bare_table is None
    assert decode(wooden.table).streamlined_exponent == 2.0

"""The first table: before any worker, and the same whoever makes it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.options import AFTER_BEAMS
from galewood.pipeline.stages.artefacts import ArtefactPublisher
from galewood.pipeline.stages.context import BuildContext
from galewood.pipeline.stages.solid import ImportedTree, MeshFile, import_tree
from galewood.pipeline.stages.stage import StageProgress
from galewood.pipeline.tables import BuildOptions, beam_table
from galewood.tree import read_tree, render_glb
from galewood.util import WorkerPool

from tests.precompute.fixtures.tree_meshes import cards, glb_bytes, y_tree

MESH = glb_bytes(y_tree(), cards([(1.6, 4.6, 0)]))
CHANGED: dict[str, Any] = {
    "target_tets": 900, "sampled_elements": 5, "frames": 20, "paper": False, "bare_table": True,
    "all_cosine_winds": True, "accept": True,
}  # fmt: skip


@pytest.fixture(scope="module")
def imported() -> ImportedTree:
    tree = read_tree(MESH, "tree.glb")
    return ImportedTree(tree, render_glb(tree))


def published(source: ImportedTree, monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """What the stage "import" publishes, without any worker."""
    names: list[str] = []

    def refuse(*_: object) -> None:
        raise AssertionError("a worker was asked for")

    monkeypatch.setattr(WorkerPool, "start", refuse)
    with WorkerPool(1) as pool:
        artefacts = ArtefactPublisher(pool, lambda name, content: names.append(name))
        context = BuildContext(
            BuildOptions(), StageProgress(lambda progress: None), Path(), pool, lambda tasks, done: [],
            artefacts, lambda tree: None, lambda result: None,
        )  # fmt: skip
        import_tree(MeshFile(source, "tree.glb"), context)
        artefacts.wait()
    return names


def test_a_build_publishes_its_first_table_without_workers(
    imported: ImportedTree, monkeypatch: pytest.MonkeyPatch
) -> None:
    assert published(imported, monkeypatch) == ["render.glb", "beams.table"]
    moving = ImportedTree(imported.tree, imported.render_glb, moving=True)
    assert published(moving, monkeypatch) == ["render.glb"], "its import has made the first table"


def test_the_first_table_does_not_depend_on_what_later_stages_read(imported: ImportedTree) -> None:
    assert CHANGED.keys() == AFTER_BEAMS
    plain, other = (
        beam_table(imported.tree, options, imported.render_glb)
        for options in (BuildOptions(), BuildOptions.model_validate(CHANGED))
    )
    for name, array in vars(plain).items():
        if isinstance(array, np.ndarray):
            assert (array == getattr(other, name)).all(), name
    assert {**plain.metadata, "provenance": 0} == {**other.metadata, "provenance": 0}

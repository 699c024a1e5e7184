"""An upload is read once: its build goes on from there, unless something has changed."""

from __future__ import annotations

import hashlib
from pathlib import Path

import anyio
import pytest
from galewood.options import ImportRequest
from galewood.pipeline.stages import import_key, kept_tree, reading
from galewood.pipeline.stages.reading import ReadUpload, read_in_child, read_upload
from galewood.pipeline.tables.options import BuildOptions
from galewood.table import read_metadata
from galewood.tree.importer import read_tree, render_glb
from galewood_server.jobs.build_job import imported_tree, read_build_inputs
from galewood_server.storage import Tree
from galewood_server.storage.stores import Stores

from tests.precompute.fixtures import tree_meshes as make
from tests.server.support.in_process import application

MESH = make.glb_bytes(make.y_tree(), make.cards([(1.6, 4.6, 0)]))
OPTIONS = ImportRequest(accept=True, height_m=5.0)


def read_here(data: bytes, filename: str, options: ImportRequest) -> ReadUpload:
    """What the service reads, in this process."""
    return read_upload(read_in_child, data, filename, options, moving=True)


@pytest.fixture(scope="module")
def read() -> ReadUpload:
    return read_here(MESH, "tree.glb", OPTIONS)


def key(options: ImportRequest = OPTIONS, data: bytes = MESH, filename: str = "tree.glb") -> str:
    return import_key(hashlib.sha256(data).hexdigest(), filename, options)


def test_the_kept_tree_is_the_one_that_was_read(read: ReadUpload) -> None:
    direct, kept = read_tree(MESH, "tree.glb", OPTIONS), kept_tree(read.tree, key())
    assert kept
    assert render_glb(kept) == render_glb(direct) == read.render_glb
    assert (kept.wood_vertices_m == direct.wood_vertices_m).all()
    assert (kept.wood_faces == direct.wood_faces).all()
    assert {**kept.report, "expected": None} == {**direct.report, "expected": None}
    assert (kept.height_m, kept.species) == (read.height_m, read.species) == (direct.height_m, direct.species)
    assert read.beams and read_metadata(read.beams)["provenance"]["stage"] == "beams"


def test_it_is_not_used_with_other_options_or_another_importer(
    read: ReadUpload, monkeypatch: pytest.MonkeyPatch
) -> None:
    build = BuildOptions(accept=True, height_m=5.0, target_tets=900)
    assert key(build) == key(), "a build has further options"
    others = [key(ImportRequest(accept=True)), key(data=MESH + b" "), key(filename="oak.glb")]
    monkeypatch.setattr(reading, "sources_hash", lambda: "another version")
    assert [kept_tree(read.tree, other) for other in (*others, key())] == [None] * 4


class Counted:
    """An importer that counts what it reads."""

    def __init__(self) -> None:
        self.files: list[str] = []

    def __call__(self, data: bytes, filename: str, options: ImportRequest) -> ReadUpload:
        self.files.append(filename)
        return read_here(data, filename, options)


def test_an_upload_is_read_once_and_moves_before_its_job_runs(tmp_path: Path) -> None:
    importer = Counted()

    async def run() -> None:
        async with application(tmp_path, importer) as (app, api):
            answer = await api.post(
                "/api/trees", params={"build": True}, files={"file": ("tree.glb", MESH)},
                data={"accept": "true", "height_m": "5"},
            )  # fmt: skip
            tree, service = answer.json(), app.state.service
            assert (answer.status_code, tree["state"]) == (201, "preliminary"), tree
            metadata = read_metadata(service.stores.tables.get(tree["table_sha256"]))
            assert metadata["provenance"]["stage"] == "beams"
            assert metadata["mesh_sha256"] == tree["mesh_sha256"]
            inputs = read_build_inputs(service.sessions, service.stores, tree["job_id"])
            assert not isinstance(inputs.source, bytes) and inputs.source.moving
            assert importer.files == ["tree.glb"]

    anyio.run(run)


def test_the_file_is_read_again_if_what_was_read_is_lost_damaged_or_of_other_options(
    tmp_path: Path, read: ReadUpload
) -> None:
    stores, options = Stores(tmp_path), BuildOptions(accept=True, height_m=5.0)
    tree = Tree(
        id="t", name="t", filename="tree.glb", source_sha256=stores.sources.put(MESH),
        mesh_sha256=stores.meshes.put(read.render_glb), import_sha256=stores.imports.put(read.tree),
    )  # fmt: skip
    found = imported_tree(stores, tree, options)
    assert found and not found.moving, "no table moves it yet"
    assert imported_tree(stores, tree, options.model_copy(update={"height_m": 6.0})) is None
    path = stores.imports.path(str(tree.import_sha256))
    path.write_bytes(read.tree[:-9])
    assert imported_tree(stores, tree, options) is None
    path.unlink()
    assert imported_tree(stores, tree, options) is None
    tree.import_sha256 = stores.imports.put(b"no archive of arrays")
    assert imported_tree(stores, tree, options) is None

"""Bombs and contradictions in compressed files: refused with their own error before much is allocated."""

import io
import json
import resource
import zipfile

import numpy as np
import pytest
from galewood.formats import archive
from galewood.tree.importer import read_tree
from galewood.tree.sandboxed import import_mesh_sandboxed
from galewood.util import MeshError
from PIL import Image

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.gltf_files import GltfFile, ktx2, leaf_image
from tests.precompute.fixtures.hostile_files import (
    CASES,
    KTX2,
    OBJ,
    TREE,
    draco_bomb,
    encrypted,
    huge_ktx2,
    textured,
    zipped,
)


@pytest.mark.parametrize(("name", "data_of", "reason", "code"), CASES, ids=[case[0] for case in CASES])
def test_each_bomb_has_its_own_error(name, data_of, reason, code):
    data = data_of()
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    with pytest.raises(MeshError) as caught:
        read_tree(data, "a.bin")
    assert (caught.value.reason, caught.value.code) == (reason, code)
    assert caught.value.hint
    grown_mb = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before) / 1024
    assert grown_mb < 400  # a million nodes as JSON take the most


def test_a_bomb_leaves_nothing_behind(tmp_path, monkeypatch):
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr("tempfile.tempdir", str(tmp_path))
    for data in (draco_bomb(1), encrypted(), textured(huge_ktx2(), *KTX2)):
        with pytest.raises(MeshError):
            import_mesh_sandboxed(data, "a.bin")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("seed", range(4))
def test_damaged_compressed_files_raise_only_mesh_errors(seed):
    """In a child process: a decoder may crash, but the caller gets a MeshError."""
    random = np.random.default_rng(seed)
    print("seed", seed)
    file = GltfFile()
    file.node(mesh=file.mesh(file.draco(TREE) if seed % 2 else file.meshopt(TREE)))
    data = bytearray(file.bytes())
    start = data.index(b"BIN\0") + 4
    for at in random.integers(start, len(data), 12):
        data[at] = random.integers(256)
    try:
        import_mesh_sandboxed(bytes(data), "a.glb")
    except MeshError as error:
        assert error.title and error.hint


def test_a_damaged_texture_is_dropped_and_reported():
    for content, mime, extension in (
        (ktx2((1, 2, 3, 255))[:100], *KTX2),
        (leaf_image("WEBP")[:20], "image/webp", "EXT_texture_webp"),
    ):
        tree = read_tree(textured(content, mime, extension), "a.glb")
        assert any("'crown'" in words for words in tree.report["warnings"])


def test_a_large_texture_is_reduced(monkeypatch):
    monkeypatch.setattr("galewood.formats.textures.MAX_SIDE", 8)
    tree = read_tree(textured(leaf_image("PNG", side=16), "image/png"), "a.glb")
    leaves = next(p for p in tree.primitives if p.kind == "leaves")
    assert leaves.material is not None
    ((content, _),) = leaves.material.images.values()
    assert Image.open(io.BytesIO(content)).size == (8, 8)
    assert any("reduced from 16 × 16" in words for words in tree.report["warnings"])


def test_files_beside_the_process_are_never_opened(tmp_path, monkeypatch):
    (tmp_path / "secret.bin").write_bytes(TREE.vertices.astype("<f4").tobytes())
    monkeypatch.chdir(tmp_path)
    for uri in (
        "secret.bin",
        str(tmp_path / "secret.bin"),
        (tmp_path / "secret.bin").as_uri(),
        "../secret.bin",
    ):
        document = make.gltf_document(TREE, uri)
        for data in (json.dumps(document).encode(), zipped({"a.gltf": json.dumps(document).encode()})):
            with pytest.raises(MeshError) as caught:
                read_tree(data, "a.gltf")
            assert caught.value.code == "external-buffers"


def test_all_files_of_an_archive_together_are_limited(monkeypatch):
    monkeypatch.setattr(archive, "MAX_BYTES", len(OBJ) + 100)
    data = zipped({"a.obj": b"mtllib a.mtl\n" + OBJ, "a.mtl": bytes(200)}, zipfile.ZIP_STORED)
    with pytest.raises(MeshError) as caught:
        read_tree(data, "a.zip")
    assert caught.value.code == "zip-size"


def test_the_preferred_format_of_several_is_read_and_the_others_are_reported():
    tree = read_tree(zipped({"a.obj": OBJ, "a.glb": make.glb_bytes(TREE), "b.7z": b"x"}), "a.zip")
    assert tree.report["file"]["format"] == "glb"
    warnings = " ".join(tree.report["warnings"])
    assert "'a.obj'" in warnings and "'b.7z'" in warnings

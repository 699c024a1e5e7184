"""Damaged and hostile files raise a MeshError with the right reason; no other file is opened."""

import builtins
import io
import json
import struct
import zipfile

import numpy as np
import pytest
from galewood.options import ImportRequest
from galewood.tree.importer import read_tree
from galewood.tree.repair import Surface
from galewood.util import MeshError

from tests.precompute.fixtures import tree_meshes as make


def zipped() -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as archive:
        archive.writestr("../../evil.obj", "v 0 0 0")
    return stream.getvalue()


def with_nan() -> bytes:
    surface = make.y_tree()
    surface.vertices[3, 1], surface.vertices[9, 0] = np.nan, np.inf
    return make.obj_bytes(surface)


def deeply_nested(levels=5000) -> bytes:
    document = make.gltf_document(make.y_tree())
    document["nodes"] = [{"children": [i + 1]} for i in range(levels)] + [{"mesh": 0}]
    return make.gltf_bytes(document)


def extension(name: str) -> bytes:
    return make.gltf_bytes(make.gltf_document(make.y_tree()) | {"extensionsRequired": [name]})


def modified_gltf(**change) -> bytes:
    document = make.gltf_document(make.y_tree())
    document["accessors"][0] |= change
    return make.gltf_bytes(document)


def random_bytes() -> bytes:
    vertices = np.random.default_rng(3).random((1200, 3)) * 8
    return make.stl_bytes(Surface(vertices, np.arange(1200).reshape(-1, 3).astype(np.int32)))


GLB = make.glb_bytes(make.y_tree())
CASES = [
    ("empty.obj", b"", "malformed", "empty-file"),
    ("blank.glb", b" \n", "malformed", "empty-file"),
    ("half.glb", GLB[: len(GLB) // 2], "malformed", "truncated"),
    ("header.glb", GLB[:10], "malformed", "truncated"),
    ("version.glb", b"glTF" + struct.pack("<II", 7, len(GLB)) + GLB[12:], "malformed", "gltf-version"),
    ("count.ply", make.ply_bytes(make.y_tree(), vertices=4_000_000_000), "malformed", "wrong-count"),
    ("count.stl", b"x" * 80 + struct.pack("<I", 2**32 - 1) + b"\0" * 50, "malformed", "wrong-count"),
    ("nan.obj", with_nan(), "unsuitable", "non-finite"),
    ("triangle.obj", b"v 0 0 0\nv 1 0 0\nv 0 0 5\nf 1 2 3", "unsuitable", "no-volume"),
    ("points.obj", b"v 0 0 0\nv 1 0 0\nv 0 0 5\n", "unsuitable", "no-faces"),
    ("plane.obj", make.obj_bytes(make.cards([(0, 0, 0)], size=5.0)), "unsuitable", "no-volume"),
    ("soup.stl", random_bytes(), "unsuitable", "no-wood"),
    (
        "passwd.gltf",
        make.gltf_bytes(make.gltf_document(make.y_tree(), "../../etc/passwd")),
        "malformed",
        "external-buffers",
    ),
    (
        "remote.gltf",
        make.gltf_bytes(make.gltf_document(make.y_tree(), "http://x/y.bin")),
        "malformed",
        "external-buffers",
    ),
    ("zip.obj", zipped(), "unsupported", "zip-names"),
    ("page.obj", b"<!doctype html><html>", "unsupported", "unsupported-type"),
    ("noise.bin", bytes(range(7, 200)), "unsupported", "unsupported-type"),
    ("deep.gltf", deeply_nested(), "unsuitable", "nested-too-deep"),
    ("other.gltf", extension("VENDOR_secret"), "unsuitable", "gltf-extension"),
    ("past_end.gltf", modified_gltf(count=10**9), "malformed", "truncated"),
    ("negative.gltf", modified_gltf(bufferView=-1), "malformed", "gltf-structure"),
    ("type.gltf", modified_gltf(componentType=99), "malformed", "gltf-structure"),
    ("json.gltf", b'{"nodes": [', "malformed", "gltf-json"),
    ("nested.gltf", b'{"a":' + b"[" * 200_000, "malformed", "gltf-json"),
    ("face.obj", b"v 0 0 0\nf 1 2 9\n", "malformed", "obj-syntax"),
]


@pytest.mark.parametrize(("name", "data", "reason", "code"), CASES, ids=[c[0] for c in CASES])
def test_each_bad_file_has_its_own_error_code(name, data, reason, code):
    with pytest.raises(MeshError) as caught:
        read_tree(data, name)
    assert (caught.value.reason, caught.value.code) == (reason, code)
    assert caught.value.title
    assert caught.value.hint


def test_cyclic_nodes_are_rejected():
    document = make.gltf_document(make.y_tree())
    document["nodes"] = [{"children": [1, 1]}, {"children": [0, 0]}]
    with pytest.raises(MeshError, match="cycle"):
        read_tree(json.dumps(document).encode(), "a.gltf")


@pytest.mark.parametrize("seed", range(3))
def test_damaged_bytes_raise_only_mesh_errors(seed):
    random = np.random.default_rng(seed)
    sources = [GLB, make.ply_bytes(make.y_tree()), make.obj_bytes(make.y_tree())[:4000]]
    for _ in range(25):
        data = bytearray(sources[random.integers(len(sources))])
        for at in random.integers(0, min(len(data), 2500), 6):
            data[at] = random.integers(256)
        try:
            read_tree(bytes(data), "a.bin")
        except MeshError as error:
            assert error.reason in ("malformed", "too-large", "unsupported", "unsuitable"), f"seed {seed}"


def test_file_names_in_the_data_are_not_opened(monkeypatch):
    def forbidden(*arguments, **_):
        raise AssertionError(f"opened {arguments}")

    data = make.obj_bytes(make.y_tree(), head="mtllib ../../../../etc/passwd\nusemtl x")
    monkeypatch.setattr(builtins, "open", forbidden)
    monkeypatch.setattr(io, "open", forbidden)
    assert read_tree(data, "a.obj").height_m > 4


def test_latin_1_names_and_quads_with_continuation_are_read():
    assert read_tree("# érable\n".encode("latin-1") + make.obj_bytes(make.y_tree()), "a.obj").height_m > 4
    box = b"".join(b"v %d %d %d\r\n" % (x, 8 * y, z) for y in (0, 1) for z in (0, 1) for x in (0, 1))
    faces = b"f 1 3 \\\r\n 4 2\r\nf 5 6 8 7\r\nf 1 2 6 5\r\nf 3 7 8 4\r\nf 1 5 7 3\r\nf 2 4 8 6\r\n"
    assert len(read_tree(box + faces, "box.obj", ImportRequest(up_axis="y")).wood_faces) == 12


def test_wood_that_is_not_in_the_file_is_rejected():
    with pytest.raises(MeshError) as caught:
        read_tree(GLB, "a.glb", ImportRequest(wood_parts=["nothing"]))
    assert caught.value.reason == "unsuitable"

"""Archives, materials and textures beside a mesh, vertex colours and FBX give the tree of the plain file."""

import base64
import io
import json
import zipfile

import numpy as np
import pytest
from galewood.formats.beside import mesh_with_companions
from galewood.formats.colours import linear_from_srgb
from galewood.options import ImportRequest
from galewood.tree.importer import read_tree
from galewood.tree.repair import Surface
from PIL import Image

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.fbx_files import fbx_bytes
from tests.precompute.fixtures.gltf_files import SQUARE_UV, GltfFile, leaf_image
from tests.precompute.fixtures.plain_tree import HEIGHT_M, TREE, assert_same_tree, wood_of


def zipped(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, content in files.items():
            archive.writestr(name, content)
    return stream.getvalue()


def test_a_zip_of_a_gltf_with_its_buffer_and_textures():
    file = GltfFile()
    leaf = file.material("crown", leaf_image("PNG"), "image/png")
    file.json["images"] = [{"uri": "textures/leaf%201.png"}]
    primitive = file.plain(make.cards([(1.2, 4.0, 0)]), material=leaf)
    primitive["attributes"]["TEXCOORD_0"] = file.accessor(SQUARE_UV.astype("<f4"))
    file.node(mesh=file.mesh(file.plain(TREE)))
    file.node(mesh=file.mesh(primitive))
    file.json["buffers"] = [{"byteLength": len(file.binary), "uri": "scene.bin"}]
    data = zipped(
        {
            "download/scene.gltf": json.dumps(file.json).encode(),
            "download/scene.bin": bytes(file.binary),
            "download/textures/leaf 1.png": leaf_image("PNG"),
            "download/license.txt": b"CC0",
            "__MACOSX/download/._scene.gltf": b"rubbish",
        }
    )
    tree = read_tree(data, "download.zip")
    assert tree.report["file"]["format"] == "gltf" and tree.report["warnings"] == []
    leaves = next(p for p in tree.primitives if p.kind == "leaves")
    assert leaves.material is not None and len(leaves.material.images) == 1


MTL = """newmtl bark
Kd 0.4 0.3 0.2
newmtl crown
Kd 0 0 0
map_Kd -s 1 1 1 -clamp on C:\\work\\leaf one.png
map_d mask.png
newmtl unused
map_Kd missing.png
"""


def obj_with_materials() -> bytes:
    card = make.cards([(1.2, 4.0, 0)])
    lines = ["mtllib tree.mtl", "usemtl bark"]
    lines += ["v " + " ".join(f"{c:.9g}" for c in v) for v in np.vstack([TREE.vertices, card.vertices])]
    lines += ["f " + " ".join(str(i + 1) for i in f) for f in TREE.faces]
    lines += [f"vt {u} {1 - v}" for u, v in SQUARE_UV]
    first = len(TREE.vertices)
    lines += ["usemtl crown"] + ["f " + " ".join(f"{first + i + 1}/{i + 1}" for i in f) for f in card.faces]
    return "\n".join(lines).encode()


def test_a_zip_of_an_obj_with_its_materials_and_textures():
    colour = Image.new("RGB", (8, 8), (30, 160, 20))
    mask = Image.new("L", (8, 8), 0)
    mask.paste(255, (2, 2, 6, 6))
    images = {}
    for name, image in (("leaf one.png", colour), ("mask.png", mask)):
        stream = io.BytesIO()
        image.save(stream, "PNG")
        images[name] = stream.getvalue()
    data = zipped({"tree.obj": obj_with_materials(), "tree.mtl": MTL.encode(), **images})
    tree = read_tree(data, "tree.zip", ImportRequest(up_axis="y"))
    wood = next(p for p in tree.primitives if p.kind == "wood")
    leaves = next(p for p in tree.primitives if p.kind == "leaves")
    assert wood.material is not None and leaves.material is not None
    factor = wood.material.json["pbrMetallicRoughness"]["baseColorFactor"]
    assert np.allclose(factor[:3], linear_from_srgb(np.array([0.4, 0.3, 0.2])))
    assert leaves.material.json["alphaMode"] == "MASK"
    shown = np.asarray(Image.open(io.BytesIO(leaves.material.images["base"][0])))
    assert np.array_equal(shown[:, :, 3], np.asarray(mask)) and (shown[:, :, :3] == (30, 160, 20)).all()
    assert tree.report["warnings"] == []


def test_materials_that_were_not_uploaded_are_reported():
    warnings = read_tree(obj_with_materials(), "tree.obj", ImportRequest(up_axis="y")).report["warnings"]
    assert any("tree.mtl" in words and "ZIP" in words for words in warnings)
    data = zipped({"tree.obj": obj_with_materials(), "tree.mtl": MTL.encode()})
    warnings = read_tree(data, "tree.zip", ImportRequest(up_axis="y")).report["warnings"]
    assert any("leaf one.png" in words for words in warnings)
    assert not any("missing.png" in words for words in warnings)  # its material is not used


SRGB = np.array([[0.0, 0.5, 1.0], [0.2, 0.4, 0.6]])


def test_vertex_colours_of_an_obj_become_linear():
    colours = SRGB[np.arange(len(TREE.vertices)) % 2]
    lines = [
        "v " + " ".join(f"{c:.9g}" for c in (*v, *c)) for v, c in zip(TREE.vertices, colours, strict=True)
    ]
    data = "\n".join(lines + ["f " + " ".join(str(i + 1) for i in f) for f in TREE.faces]).encode()
    _, wood = wood_of(data, "a.obj", ImportRequest(up_axis="y"))
    assert wood.colours is not None and wood.material is not None
    # IEC 61966-2-1 at its known points: 0 and 1 stay, 0.5 becomes 0.2140
    assert sorted({round(float(c), 4) for c in wood.colours[:, 1]}) == [
        round(((0.4 + 0.055) / 1.055) ** 2.4, 4), 0.214
    ]  # fmt: skip


@pytest.mark.parametrize("of", ["vertex", "face"])
def test_colours_of_a_ply_become_linear(of):
    colour = np.zeros(len(TREE.vertices if of == "vertex" else TREE.faces), dtype=[("c", "u1", 3)])
    colour["c"] = (255, 128, 0)
    paint = "property uchar red\nproperty uchar green\nproperty uchar blue\n"
    vertex = np.zeros(
        len(TREE.vertices), dtype=[("p", "<f4", 3)] + ([("c", "u1", 3)] if of == "vertex" else [])
    )
    face = np.zeros(
        len(TREE.faces), dtype=[("n", "u1"), ("i", "<i4", 3)] + ([("c", "u1", 3)] if of == "face" else [])
    )
    vertex["p"], face["n"], face["i"] = TREE.vertices, 3, TREE.faces
    (vertex if of == "vertex" else face)["c"] = colour["c"]
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(vertex)}\n"
        f"property float x\nproperty float y\nproperty float z\n{paint if of == 'vertex' else ''}"
        f"element face {len(face)}\nproperty list uchar int vertex_indices\n{paint if of == 'face' else ''}"
        "end_header\n"
    )
    _, wood = wood_of(head.encode() + vertex.tobytes() + face.tobytes(), "a.ply", ImportRequest(up_axis="y"))
    assert wood.colours is not None
    linear = ((128 / 255 + 0.055) / 1.055) ** 2.4
    assert np.allclose(wood.colours[:, :3], (1.0, linear, 0.0), atol=1e-6)
    assert len(wood.faces) == len(TREE.faces)


@pytest.mark.parametrize("up", ["y", "z"])
def test_fbx_is_read_upright_with_its_materials(up):
    turn = np.eye(3) if up == "y" else np.array([[1.0, 0, 0], [0, 0, -1], [0, 1, 0]])
    surface = Surface(TREE.vertices @ turn.T, TREE.faces)
    cards = make.cards([(1.2, 4.0, 0)])
    leaves = Surface(cards.vertices @ turn.T, cards.faces)
    data = fbx_bytes({"bark": (surface, (0.4, 0.3, 0.2)), "leaf": (leaves, (0.1, 0.6, 0.1))}, up)
    tree = read_tree(data, "a.fbx")
    assert tree.report["file"]["format"] == "fbx" and tree.height_m == pytest.approx(HEIGHT_M, rel=1e-4)
    assert [(p.kind, len(p.faces)) for p in tree.primitives] == [("wood", len(TREE.faces)), ("leaves", 2)]
    assert_same_tree(next(p for p in tree.primitives if p.kind == "wood"), tolerance_m=1e-4)


def test_files_beside_a_mesh_are_taken_from_its_folder_only(tmp_path):
    folder = tmp_path / "model"
    (folder / "textures").mkdir(parents=True)
    (folder / "tree.obj").write_bytes(obj_with_materials())
    (folder / "tree.mtl").write_text(MTL.replace("mask.png", "../secret.png"))
    (folder / "textures" / "leaf one.png").write_bytes(leaf_image("PNG"))
    (folder / "other.png").write_bytes(leaf_image("PNG"))
    (tmp_path / "secret.png").write_bytes(leaf_image("PNG"))
    (folder / "secret.png").symlink_to(tmp_path / "secret.png")
    packed = mesh_with_companions(folder / "tree.obj")
    assert zipfile.ZipFile(io.BytesIO(packed)).namelist() == ["tree.obj", "textures/leaf one.png", "tree.mtl"]
    assert packed == mesh_with_companions(folder / "tree.obj")
    tree = read_tree(packed, "tree.obj", ImportRequest(up_axis="y"))
    leaves = next(p for p in tree.primitives if p.kind == "leaves")
    assert leaves.material is not None and list(leaves.material.images) == ["base"]


@pytest.mark.parametrize("uri", ["tree.bin", "data/tree.bin", "../tree.bin", "absolute"])
def test_a_gltf_finds_its_buffer_in_its_folder_only(tmp_path, uri):
    folder = tmp_path / "model"
    (folder / "data").mkdir(parents=True)
    document = make.gltf_document(TREE)
    content = base64.b64decode(document["buffers"][0]["uri"].partition(",")[2])
    target = tmp_path / "tree.bin" if uri in ("../tree.bin", "absolute") else folder / uri
    target.write_bytes(content)
    document["buffers"][0]["uri"] = str(target) if uri == "absolute" else uri
    (folder / "tree.gltf").write_text(json.dumps(document))
    packed = mesh_with_companions(folder / "tree.gltf")
    if target.is_relative_to(folder):
        assert read_tree(packed, "tree.gltf").height_m == pytest.approx(HEIGHT_M, rel=1e-5)
    else:
        assert packed == (folder / "tree.gltf").read_bytes()


def test_a_mesh_without_other_files_stays_as_it_is(tmp_path):
    (tmp_path / "a.obj").write_bytes(make.obj_bytes(TREE))
    assert mesh_with_companions(tmp_path / "a.obj") == make.obj_bytes(TREE)

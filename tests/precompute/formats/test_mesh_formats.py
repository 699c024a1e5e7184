"""Compressed, quantised, skinned and instanced glTF gives the tree of the plain file."""

import io
import json

import meshopt
import numpy as np
import pytest
from galewood.options import ImportRequest
from galewood.tree.importer import read_tree, render_glb
from galewood.tree.repair import Surface
from galewood.tree.sandboxed import import_mesh_sandboxed
from PIL import Image

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.fbx_files import fbx_bytes
from tests.precompute.fixtures.gltf_files import SQUARE_UV, GltfFile, aligned, ktx2, leaf_image
from tests.precompute.fixtures.plain_tree import HEIGHT_M, TREE, assert_same_tree, wood_of


def glb_of(primitive_of, **node) -> bytes:
    file = GltfFile()
    file.node(mesh=file.mesh(primitive_of(file)), **node)
    return file.bytes()


def test_draco_gives_the_plain_tree_within_its_quantisation():
    tree, wood = wood_of(glb_of(lambda file: file.draco(TREE, bits=14)))
    assert_same_tree(wood, tolerance_m=HEIGHT_M / 2**13)
    assert tree.report["warnings"] == []


def test_meshopt_gives_the_plain_tree_within_its_quantisation():
    tree, wood = wood_of(glb_of(lambda file: file.meshopt(TREE)))
    assert_same_tree(wood, tolerance_m=HEIGHT_M / 2**13)
    assert tree.report["warnings"] == []


def test_the_newer_meshopt_extension_and_plain_index_sequences_are_read():
    file = GltfFile()
    primitive = file.meshopt(TREE)
    indices = TREE.faces.reshape(-1).astype("<u4")
    packed = meshopt.encode_gltf_buffer(indices, "INDICES")
    view = file.meshopt_view(packed, len(indices), 4, "INDICES")
    primitive["indices"] = file.accessor(indices[:, None], view)
    file.node(mesh=file.mesh(primitive))
    data = file.bytes().replace(b"EXT_meshopt_compression", b"KHR_meshopt_compression")
    assert_same_tree(wood_of(data)[1], tolerance_m=HEIGHT_M / 2**13)


@pytest.mark.parametrize("kind", ["i1", "u1", "i2", "u2"])
@pytest.mark.parametrize("normalised", [True, False])
def test_quantised_positions_of_every_type(kind, normalised):
    top = np.iinfo(kind).max
    low, scale = TREE.vertices.min(axis=0), float(np.ptp(TREE.vertices, axis=0).max())
    rows = np.round((TREE.vertices - low) / scale * top).astype(f"<{kind}")
    file = GltfFile()
    file.use("KHR_mesh_quantization")
    content, stride = aligned(rows)
    more = {"normalized": True} if normalised else {}
    positions = file.accessor(rows, file.view(content, byteStride=stride), **more)
    primitive = {"attributes": {"POSITION": positions}, "indices": file.indices(TREE.faces)}
    size = scale if normalised else scale / top
    file.node(mesh=file.mesh(primitive), scale=[size] * 3, translation=low.tolist())
    # one-byte positions are coarse: faces may vanish, but none may be far from the tree
    _, wood = wood_of(file.bytes())
    (plain,) = read_tree(make.glb_bytes(TREE), "a.glb").primitives
    distance = np.linalg.norm(wood.positions_m[:, None] - plain.positions_m[None], axis=2).min(axis=1)
    assert float(distance.max()) <= 2.0 * scale / top


def test_a_sparse_accessor_replaces_rows():
    file = GltfFile()
    rows = TREE.vertices.astype("<f4")
    wrong = rows.copy()
    wrong[[2, 5]] += 3.0
    primitive = {"attributes": {"POSITION": file.accessor(wrong)}, "indices": file.indices(TREE.faces)}
    file.json["accessors"][0]["sparse"] = {
        "count": 2,
        "indices": {"bufferView": file.view(np.array([2, 5], dtype="<u2").tobytes()), "componentType": 5123},
        "values": {"bufferView": file.view(rows[[2, 5]].tobytes())},
    }
    file.node(mesh=file.mesh(primitive))
    assert_same_tree(wood_of(file.bytes())[1], tolerance_m=1e-5)


def test_a_skinned_tree_stands_as_its_joints_hold_it():
    """The mesh lies on its side in a scaled node; its joint turns it upright. Two joints share the top."""
    lying = TREE.vertices @ np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]]).T  # y up becomes -x
    file = GltfFile()
    primitive = file.plain(Surface(lying, TREE.faces))
    count = len(lying)
    upper = (TREE.vertices[:, 1] > 2.0).astype(float)
    primitive["attributes"]["JOINTS_0"] = file.accessor(np.tile(np.array([[0, 1, 0, 0]], "<u1"), (count, 1)))
    weights = np.column_stack([1 - 0.5 * upper, 0.5 * upper, 0 * upper, 0 * upper]).astype("<f4")
    primitive["attributes"]["WEIGHTS_0"] = file.accessor(weights)
    half = float(np.sqrt(0.5))
    root = file.node(name="hips", rotation=[0, 0, -half, half], children=[1])  # turns -x into +y
    file.node(root=False, name="spine", translation=[0.0, 1.0, 0.0])
    inverse = np.eye(4)[None].repeat(2, axis=0).transpose(0, 2, 1)
    inverse[1, 3, :3] = (0.0, -1.0, 0.0)  # column-major: undoes the translation of the second joint
    matrices = file.accessor(inverse.reshape(2, 16).astype("<f4"))
    file.json["skins"] = [{"joints": [root, 1], "inverseBindMatrices": matrices}]
    file.json["animations"] = [{"channels": [], "samplers": []}]
    file.node(mesh=file.mesh(primitive), skin=0, scale=[100.0] * 3, translation=[7.0, 0, 0])
    tree, wood = wood_of(file.bytes())
    assert_same_tree(wood, tolerance_m=1e-5)
    assert any("animation" in words for words in tree.report["warnings"])


def test_weights_move_each_vertex_by_the_mean_of_its_joints():
    file = GltfFile()
    primitive = file.plain(TREE)
    count = len(TREE.vertices)
    primitive["attributes"]["JOINTS_0"] = file.accessor(np.tile(np.array([[0, 1, 0, 0]], "<u2"), (count, 1)))
    weights = np.tile(np.array([[64, 191, 0, 0]], "<u1"), (count, 1))
    primitive["attributes"]["WEIGHTS_0"] = file.accessor(weights, normalized=True)
    file.node(translation=[4.0, 0, 0])
    file.node(translation=[0.0, 0, 8.0], scale=[1.0, 2.0, 1.0])
    file.json["skins"] = [{"joints": [0, 1]}]
    file.node(mesh=file.mesh(primitive), skin=0)
    tree, _ = wood_of(file.bytes(), options=ImportRequest(up_axis="y"))
    assert tree.height_m == pytest.approx(HEIGHT_M * (64 + 2 * 191) / 255, rel=1e-5)


def test_morph_targets_have_their_default_weights():
    file = GltfFile()
    change = np.zeros_like(TREE.vertices)
    change[:, 1] = TREE.vertices[:, 1]
    primitive = file.plain(TREE, targets=[{"POSITION": file.accessor(change.astype("<f4"))}])
    file.node(mesh=file.mesh(primitive, weights=[0.25]))
    assert read_tree(file.bytes(), "a.glb").height_m == pytest.approx(1.25 * HEIGHT_M, rel=1e-5)
    file.json["nodes"][0]["weights"] = [0.5]  # the node's weights have precedence
    assert read_tree(file.bytes(), "a.glb").height_m == pytest.approx(1.5 * HEIGHT_M, rel=1e-5)


def test_instances_are_expanded_where_they_are_drawn():
    """500 cards, one of them mirrored, as one mesh: the crown has 1000 faces at the given places."""
    random = np.random.default_rng(4)
    places = random.uniform((-1.5, 3, -1), (1.5, 5, 1), (500, 3)).astype("<f4")
    turns = random.normal(size=(500, 4))
    turns = np.round(turns / np.linalg.norm(turns, axis=1, keepdims=True) * 127).astype("<i1")
    scales = random.uniform(0.8, 1.2, (500, 1)).astype("<f4").repeat(3, axis=1)
    scales[7, 0] *= -1
    file = GltfFile()
    file.use("EXT_mesh_gpu_instancing")
    file.node(name="trunk", mesh=file.mesh(file.plain(TREE)))
    instances = {
        "TRANSLATION": file.accessor(places),
        "ROTATION": file.accessor(turns, normalized=True),
        "SCALE": file.accessor(scales),
    }
    card = make.cards([(0, 0, 0)], size=0.2)
    file.node(
        name="leaf",
        mesh=file.mesh(file.plain(card)),
        extensions={"EXT_mesh_gpu_instancing": {"attributes": instances}},
    )
    tree = read_tree(file.bytes(), "a.glb")
    leaves = next(p for p in tree.primitives if p.kind == "leaves")
    assert len(leaves.faces) == 1000
    origin = np.array(tree.report["roots"]["origin_in_file"])
    # the card's lower edge is centred on the place of its instance
    foot = leaves.positions_m.reshape(500, 4, 3)[:, :2].mean(axis=1) + origin
    assert np.abs(foot - places).max() < 1e-5
    normal = np.cross(*np.moveaxis(np.diff(leaves.positions_m[leaves.faces], axis=1), 1, 0))
    mirrored = np.isclose(np.sign((normal[14:16] * normal[14]).sum(axis=1)), 1).all()
    assert mirrored and not np.allclose(normal[14], 0)


@pytest.mark.parametrize(
    ("form", "extension", "kept"),
    [
        ("PNG", None, "image/png"),
        ("WEBP", "EXT_texture_webp", "image/webp"),
        ("KTX2", "KHR_texture_basisu", "image/png"),
    ],
)
def test_textures_of_every_form_cut_out_the_leaves(form, extension, kept):
    content = ktx2((30, 160, 20, 0)) if form == "KTX2" else leaf_image(form)
    file = GltfFile()
    leaf = file.material("crown", content, f"image/{form.lower()}", extension)
    card = make.cards([(1.2, 4.0, 0), (-1.0, 4.4, 0)])
    uv = file.accessor(np.tile(SQUARE_UV, (2, 1)).astype("<f4"))
    primitive = file.plain(card, material=leaf)
    primitive["attributes"]["TEXCOORD_0"] = uv
    file.node(mesh=file.mesh(file.plain(TREE)))
    file.node(mesh=file.mesh(primitive))
    tree = read_tree(file.bytes(), "a.glb")
    leaves = next(p for p in tree.primitives if p.kind == "leaves")
    assert leaves.material is not None
    ((shown, mime),) = leaves.material.images.values()
    assert mime == kept
    expected = np.full((8, 8, 4), (30, 160, 20, 0)) if form == "KTX2" else Image.open(io.BytesIO(content))
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(shown)).convert("RGBA")), np.asarray(expected))
    assert not [words for words in tree.report["warnings"] if "texture" in words]
    again = read_tree(render_glb(tree), "b.glb")  # what the page gets can be read again, with its texture
    leaves = next(p for p in again.primitives if p.kind == "leaves")
    assert leaves.material is not None and len(leaves.material.images) == 1


def test_a_texture_transform_is_applied_to_the_coordinates():
    """The example of KHR_texture_transform: the lower left quadrant, turned."""
    file = GltfFile()
    transform = {"offset": [0, 1], "rotation": np.pi / 2, "scale": [0.5, 0.5]}
    file.use("KHR_texture_transform", required=False)
    leaf = file.material(
        "crown", leaf_image("PNG"), "image/png", extensions={"KHR_texture_transform": transform}
    )
    primitive = file.plain(make.cards([(1.2, 4.0, 0)]), material=leaf)
    primitive["attributes"]["TEXCOORD_0"] = file.accessor(SQUARE_UV.astype("<f4"))
    file.node(mesh=file.mesh(file.plain(TREE)))
    file.node(mesh=file.mesh(primitive))
    tree = read_tree(file.bytes(), "a.glb")
    leaves = next(p for p in tree.primitives if p.kind == "leaves")
    u, v = SQUARE_UV.T
    assert leaves.uv is not None and leaves.material is not None
    assert np.allclose(leaves.uv, np.column_stack([0.5 * v, 1 - 0.5 * u]), atol=1e-6)
    assert leaves.uv.min() >= 0 and leaves.uv[:, 0].max() <= 0.5 and leaves.uv[:, 1].min() >= 0.5
    assert "KHR_texture_transform" not in json.dumps(leaves.material.json)


def test_whatever_is_not_drawn_is_reported():
    file = GltfFile()
    file.use("KHR_lights_punctual", required=False)
    bad = file.material("crown", b"not an image", "image/png")
    line = file.plain(TREE) | {"mode": 1}
    file.node(mesh=file.mesh(file.plain(TREE, material=bad), line))
    warnings = " ".join(read_tree(file.bytes(), "a.glb").report["warnings"])
    for word in ("KHR_lights_punctual", "'crown'", "lines"):
        assert word in warnings


def test_many_primitives_that_share_one_vertex_buffer_keep_only_their_vertices():
    file = GltfFile()
    shared = file.accessor(TREE.vertices.astype("<f4"))
    halves = np.array_split(TREE.faces, 40)
    parts = [{"attributes": {"POSITION": shared}, "indices": file.indices(part)} for part in halves]
    file.node(mesh=file.mesh(*parts))
    tree = read_tree(file.bytes(), "a.glb")
    assert sum(len(p.positions_m) for p in tree.primitives) <= 4 * len(TREE.vertices)
    assert sum(len(p.faces) for p in tree.primitives) == len(TREE.faces)


def test_decoders_work_in_the_sandbox():
    """FBX is read from a temporary file; Draco, meshopt and KTX2 are loaded once files are confined."""
    file = GltfFile()
    leaf = file.material("crown", ktx2((30, 160, 20, 255)), "image/ktx2", "KHR_texture_basisu")
    crown = file.meshopt(make.cards([(1.2, 4.0, 0)]), material=leaf)
    crown["attributes"]["TEXCOORD_0"] = file.accessor(SQUARE_UV.astype("<f4"))
    file.node(mesh=file.mesh(file.draco(TREE), crown))
    tree, _ = import_mesh_sandboxed(file.bytes(), "a.glb")
    assert tree.height_m == pytest.approx(HEIGHT_M, rel=1e-3)
    assert not [words for words in tree.report["warnings"] if "texture" in words]
    tree, _ = import_mesh_sandboxed(fbx_bytes({"bark": (TREE, (0.4, 0.3, 0.2))}), "a.fbx")
    assert tree.height_m == pytest.approx(HEIGHT_M, rel=1e-4)

"""What an untrusted file costs grows with its length, not with what it pretends to hold."""

import io
import json
import struct
import zlib

import numpy as np
import pytest
from galewood.formats.bounded_image import open_image
from galewood.formats.companions import MOST_WARNINGS, Source
from galewood.formats.gltf.scene import placed_meshes
from galewood.formats.textures import drawable
from galewood.tree import joined_parts
from galewood.tree.importer import read_tree
from galewood.tree.repair import Surface
from galewood.util import MeshError
from PIL import Image

from tests.precompute.fixtures import tree_meshes as make
from tests.precompute.fixtures.gltf_files import GltfFile
from tests.precompute.fixtures.hostile_files import textured

FORMATS = ("PNG", "JPEG", "WEBP", "AVIF", "TGA", "BMP", "TIFF", "DDS", "GIF")


def chunk(kind: bytes, body: bytes) -> bytes:
    return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))


def png_with_remarks(count: int) -> bytes:
    """A PNG of 4 × 4 pixels with texts."""
    head = chunk(b"IHDR", struct.pack(">IIBBBBB", 4, 4, 8, 6, 0, 0, 0))
    texts = b"".join(chunk(b"tEXt", b"key\0value") for _ in range(count))
    pixels = chunk(b"IDAT", zlib.compress(bytes(4 * 17)))
    return b"\x89PNG\r\n\x1a\n" + head + texts + pixels + chunk(b"IEND", b"")


def jpeg_with(filling: bytes) -> bytes:
    stream = io.BytesIO()
    Image.new("RGB", (8, 8)).save(stream, "JPEG")
    return stream.getvalue()[:2] + filling + stream.getvalue()[2:]


@pytest.mark.parametrize(
    "content",
    [png_with_remarks(100_000), jpeg_with(b"\xff\xe9\0\2" * 300_000), jpeg_with(b"\xff" * 1_000_000)],
    ids=["texts of a PNG", "markers of a JPEG", "filling of a JPEG"],
)
def test_images_of_tiny_pieces_are_not_read_to_their_end(content):
    tree = read_tree(textured(content), "a.glb")
    assert any("'crown' cannot be read" in warning for warning in tree.report["warnings"])


def test_a_few_remarks_do_no_harm():
    content = png_with_remarks(500)
    assert drawable(content, "bark", Source()) == (content, "image/png")


@pytest.mark.parametrize("form", FORMATS)
def test_honest_images_are_read_whole(form):
    random = np.random.default_rng(2)
    noise = Image.fromarray(random.integers(0, 255, (512, 512, 3), dtype=np.uint8), "RGB")
    stream = io.BytesIO()
    noise.save(stream, form)
    image = open_image(stream.getvalue())
    image.load()
    assert image.size == (512, 512)


def test_formats_that_start_programs_are_not_opened():
    stream = io.BytesIO()
    Image.new("RGB", (8, 8)).save(stream, "EPS")
    source = Source()
    assert drawable(stream.getvalue(), "bark", source) is None
    assert "cannot be read" in source.warnings[0]


def nodes(children: list[list[int]], roots: list[int]) -> bytes:
    document = make.gltf_document(make.y_tree())
    document["nodes"] = [{"children": inner} if inner else {"mesh": 0} for inner in children]
    document["scenes"] = [{"nodes": roots}]
    return make.gltf_bytes(document)


@pytest.mark.parametrize(
    ("data", "code"),
    [
        (nodes([*([k + 1, k + 1] for k in range(40)), []], [0]), "nested-too-deep"),
        (nodes([[1], [0]], [0]), "nested-too-deep"),
        (nodes([*([k + 1] for k in range(300)), []], [0]), "nested-too-deep"),
        (nodes([[]] * 100_001, [0]), "too-many-nodes"),
        (nodes([*([k + 1, k + 1] for k in range(15)), [], [0], [0]], [16, 17]), "too-many-nodes"),
        (nodes([[7]], [0]), "gltf-structure"),
    ],
    ids=["doubled", "a circle", "deep", "many", "many copies", "no such child"],
)
def test_nodes_are_a_hierarchy_of_bounded_size(data, code):
    with pytest.raises(MeshError) as caught:
        read_tree(data, "a.gltf")
    assert caught.value.code == code


def test_a_shared_node_is_drawn_for_each_parent_and_a_repeated_root_once():
    once = placed_meshes(json.loads(nodes([[]], [0] * 50)))
    shared = placed_meshes(json.loads(nodes([[2], [2], []], [0, 1])))
    assert (len(once), len(shared)) == (1, 2)


def many_parts(count: int) -> bytes:
    """A tree and triangles whose nodes have names of their own, all of one material."""
    file = GltfFile()
    file.json["materials"] = [{"name": "bark"}]
    wood = make.y_tree()
    triangle = Surface(wood.vertices[:3], np.array([[0, 1, 2]], dtype=np.int32))
    file.node(mesh=file.mesh(file.plain(wood, material=0)))
    mesh = file.mesh(file.plain(triangle, material=0))
    for k in range(count):
        file.node(mesh=mesh, name=f"leaf {k}")
    return file.bytes()


def test_many_parts_are_joined_in_one_pass(monkeypatch):
    calls: list[object] = []
    fingerprint = joined_parts._fingerprint
    monkeypatch.setattr(joined_parts, "_fingerprint", lambda one: calls.append(one) or fingerprint(one))
    assert len(read_tree(many_parts(200), "a.glb").report["pieces"]) >= 200
    assert len(calls) == 1
    monkeypatch.setattr(joined_parts, "MAX_PARTS", 150)
    with pytest.raises(MeshError) as caught:
        read_tree(many_parts(200), "a.glb")
    assert caught.value.code == "too-many-parts"


def test_a_file_gives_a_bounded_number_of_warnings():
    source = Source()
    for k in range(1000):
        source.warn(f"The texture {k} is not drawn.")
    assert len(source.warnings) == MOST_WARNINGS + 1

"""Bombs and contradictions in compressed files, for the tests of mesh import and of uploads."""

import io
import struct
import zipfile
import zlib
from collections.abc import Callable

import DracoPy
import meshopt
import numpy as np

from tests.precompute import tree_meshes as make
from tests.precompute.gltf_files import SQUARE_UV, GltfFile, ktx2

TREE = make.y_tree()
KTX2 = ("image/ktx2", "KHR_texture_basisu")


def varint(value: int) -> bytes:
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes([*out, value])


def draco_with(content: bytes) -> bytes:
    """A GLB whose Draco stream is replaced."""
    file = GltfFile()
    primitive = file.draco(TREE)
    primitive["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = file.view(content)
    file.node(mesh=file.mesh(primitive))
    return file.bytes()


def draco_bomb(method: int) -> bytes:
    """A stream that declares four billion triangles (method 0: sequential, 1: Edgebreaker)."""
    head = b"DRACO" + struct.pack("<BBBBH", 2, 2, 1, method, 0)
    counts = varint(10) + varint(2**32 - 1) if method else varint(2**32 - 1) + varint(10)
    return draco_with(head + (b"\0" if method else b"") + counts + bytes(64))


def damaged_draco() -> bytes:
    content = bytearray(DracoPy.encode(TREE.vertices.astype("<f4"), TREE.faces.astype("<u4")))
    content[40:60] = bytes(20)
    return draco_with(bytes(content[:200]))


def meshopt_with(count: int, stride: int, mode="ATTRIBUTES", content: bytes | None = None, **more) -> bytes:
    file = GltfFile()
    packed = meshopt.encode_gltf_buffer(TREE.vertices.astype("<f4"), "ATTRIBUTES")
    view = file.meshopt_view(packed if content is None else content, count, stride, mode, **more)
    primitive = file.plain(TREE)
    file.json["accessors"].append({"bufferView": view, "componentType": 5126, "count": count, "type": "VEC3"})
    primitive["attributes"]["POSITION"] = len(file.json["accessors"]) - 1
    file.node(mesh=file.mesh(primitive))
    return file.bytes()


def textured(content: bytes, mime="image/png", extension: str | None = None) -> bytes:
    file = GltfFile()
    leaf = file.material("crown", content, mime, extension)
    primitive = file.plain(make.cards([(1.2, 4.0, 0)]), material=leaf)
    primitive["attributes"]["TEXCOORD_0"] = file.accessor(SQUARE_UV.astype("<f4"))
    file.node(mesh=file.mesh(file.plain(TREE)))
    file.node(mesh=file.mesh(primitive))
    return file.bytes()


def png_of(width: int, height: int) -> bytes:
    """A PNG that declares a size, with almost no data."""

    def chunk(kind: bytes, body: bytes) -> bytes:
        return struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))

    head = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", zlib.compress(b"")) + chunk(b"IEND", b"")
    )


def huge_ktx2() -> bytes:
    content = bytearray(ktx2((1, 2, 3, 255)))
    content[20:28] = struct.pack("<2I", 2**31, 2**31)
    return bytes(content)


def skinned(joints: list[int], children: dict[int, list[int]], worst_joint=0) -> bytes:
    file = GltfFile()
    primitive = file.plain(TREE)
    count = len(TREE.vertices)
    primitive["attributes"]["JOINTS_0"] = file.accessor(np.full((count, 4), worst_joint, dtype="<u1"))
    primitive["attributes"]["WEIGHTS_0"] = file.accessor(np.tile(np.array([[1, 0, 0, 0]], "<f4"), (count, 1)))
    file.json["skins"] = [{"joints": joints}]
    file.node(mesh=file.mesh(primitive), skin=0)
    for k in (1, 2):
        file.node(root=False, name=f"joint {k}", children=children.get(k, []))
    return file.bytes()


def instanced(count: int, faces_of=TREE) -> bytes:
    """A mesh drawn `count` times; all instances share one place, so that the file stays small."""
    file = GltfFile()
    file.use("EXT_mesh_gpu_instancing")
    mesh = file.mesh(file.plain(faces_of))
    place = file.accessor(np.zeros((1, 3), dtype="<f4"))
    # an accessor without data is all zeros, whatever count it declares
    file.json["accessors"].append({"componentType": 5126, "count": count, "type": "VEC3"})
    attributes = {"TRANSLATION": place + 1}
    file.node(mesh=mesh, extensions={"EXT_mesh_gpu_instancing": {"attributes": attributes}})
    return file.bytes()


def many_nodes(count: int) -> bytes:
    file = GltfFile()
    mesh = file.mesh(file.plain(TREE))
    file.json["nodes"] = [{"mesh": mesh}] * count
    file.json["scenes"] = [{"nodes": list(range(count))}]
    return file.bytes()


def zipped(files: dict[str, bytes], packing=zipfile.ZIP_DEFLATED) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", packing) as packed:
        for name, content in files.items():
            packed.writestr(name, content)
    return stream.getvalue()


def declared_size(data: bytes, size: int) -> bytes:
    """The archive with another uncompressed size of its only file in the directory."""
    at = data.index(b"PK\x01\x02")
    return data[: at + 24] + struct.pack("<I", size) + data[at + 28 :]


def encrypted() -> bytes:
    data = bytearray(zipped({"a.obj": make.obj_bytes(TREE)}))
    for magic, offset in ((b"PK\x03\x04", 6), (b"PK\x01\x02", 8)):
        data[data.index(magic) + offset] |= 1
    return bytes(data)


def linked() -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w") as packed:
        entry = zipfile.ZipInfo("a.obj")
        entry.create_system, entry.external_attr = 3, 0o120777 << 16
        packed.writestr(entry, "/etc/passwd")
    return stream.getvalue()


def broken_fbx() -> bytes:
    return b"Kaydara FBX Binary  \0\x1a\0" + struct.pack("<I", 7400) + b"\xff" * 60


def points_of_ply() -> bytes:
    return make.ply_bytes(make.Surface(TREE.vertices, TREE.faces[:0]))


OBJ = make.obj_bytes(TREE)
ZEROS = bytes(100_000_000)
CASES: list[tuple[str, Callable[[], bytes], str, str]] = [  # name, file, reason and code of the error
    ("draco, sequential", lambda: draco_bomb(0), "too-large", "too-many-faces"),
    ("draco, edgebreaker", lambda: draco_bomb(1), "too-large", "too-many-faces"),
    ("draco, damaged", damaged_draco, "malformed", "draco-damaged"),
    ("draco, empty", lambda: draco_with(b"x"), "malformed", "draco-damaged"),
    ("meshopt, count", lambda: meshopt_with(2**31, 12), "too-large", "decoded-too-large"),
    ("meshopt, count and stride", lambda: meshopt_with(2**24, 256), "too-large", "decoded-too-large"),
    ("meshopt, stride", lambda: meshopt_with(186, 2**20), "malformed", "meshopt-damaged"),
    ("meshopt, mode", lambda: meshopt_with(186, 12, "OTHER"), "malformed", "meshopt-damaged"),
    ("meshopt, filter", lambda: meshopt_with(186, 12, filter="OTHER"), "malformed", "meshopt-damaged"),
    ("meshopt, odd filter", lambda: meshopt_with(186, 12, filter="COLOR"), "malformed", "meshopt-damaged"),
    ("meshopt, truncated", lambda: meshopt_with(186, 12, content=b"\xa0abc"), "malformed", "meshopt-damaged"),
    ("meshopt, triangles", lambda: meshopt_with(7, 4, "TRIANGLES"), "malformed", "meshopt-damaged"),
    ("accessor", lambda: instanced(10**12), "too-large", "too-many-instances"),
    ("instances", lambda: instanced(10**6), "too-large", "too-many-instances"),
    ("faces of instances", lambda: instanced(90_000), "too-large", "too-many-faces"),
    ("nodes", lambda: many_nodes(10**6), "unsuitable", "too-many-nodes"),
    ("faces of nodes", lambda: many_nodes(50_000), "too-large", "too-many-faces"),
    ("joints in a circle", lambda: skinned([1], {1: [2], 2: [1]}), "unsuitable", "skin-cycle"),
    ("a joint of itself", lambda: skinned([1], {1: [1]}), "unsuitable", "skin-cycle"),
    ("no such joint node", lambda: skinned([99], {}), "malformed", "gltf-structure"),
    ("no such joint", lambda: skinned([1, 2], {}, worst_joint=7), "malformed", "gltf-structure"),
    ("PNG of 4 × 10⁹ pixels", lambda: textured(png_of(65_535, 65_535)), "too-large", "image-too-large"),
    ("PNG of 10⁸ pixels", lambda: textured(png_of(10_000, 10_000)), "too-large", "image-too-large"),
    ("KTX2", lambda: textured(huge_ktx2(), *KTX2), "too-large", "image-too-large"),
    ("zip, ratio", lambda: zipped({"a.obj": OBJ, "b.bin": ZEROS}), "too-large", "zip-ratio"),
    ("zip, size", lambda: declared_size(zipped({"a.obj": OBJ}), 2**31), "too-large", "zip-size"),
    ("zip, wrong size", lambda: declared_size(zipped({"a.obj": OBJ}), 10), "malformed", "unreadable"),
    ("zip, entries", lambda: zipped({f"{k}.obj": b"" for k in range(5000)}), "too-large", "zip-entries"),
    ("zip, encrypted", encrypted, "unsuitable", "zip-encrypted"),
    ("zip, link", linked, "malformed", "unreadable"),
    ("zip, climbing", lambda: zipped({"../a.obj": OBJ}), "unsupported", "zip-names"),
    ("zip, absolute", lambda: zipped({"/etc/a.obj": OBJ}), "unsupported", "zip-names"),
    ("zip, drive", lambda: zipped({"C:\\a.obj": OBJ}), "unsupported", "zip-names"),
    ("zip in a zip", lambda: zipped({"a.zip": zipped({"a.obj": OBJ})}), "unsupported", "nested-archive"),
    ("zip as OBJ in a zip", lambda: zipped({"a.obj": zipped({"a": OBJ})}), "unsupported", "nested-archive"),
    ("zip, two models", lambda: zipped({"a.glb": b"x", "b.glb": b"x"}), "unsuitable", "several-models"),
    ("zip, other", lambda: zipped({"a.blend": b"BLENDER"}), "unsupported", "unsupported-type"),
    ("zip, truncated", lambda: zipped({"a.obj": OBJ})[:-40], "malformed", "unreadable"),
    ("zip, packing", lambda: b"PK\x03\x04" + bytes(60), "malformed", "unreadable"),
    ("FBX, truncated", broken_fbx, "malformed", "unreadable"),
    ("FBX, text", lambda: b"; FBX 7.4.0 project file\nObjects: {\nGeometry: 1, {", "malformed", "unreadable"),
    ("LAS", lambda: b"LASF" + bytes(300), "unsupported", "point-cloud"),
    ("XYZ", lambda: b"1.0 2.0 3.0 255 0 0\n" * 40, "unsupported", "point-cloud"),
    ("PLY without faces", points_of_ply, "unsupported", "point-cloud"),
    ("Blender", lambda: b"BLENDER-v300" + bytes(99), "unsupported", "unsupported-type"),
    ("USD", lambda: b"PXR-USDC" + bytes(99), "unsupported", "unsupported-type"),
]  # fmt: skip

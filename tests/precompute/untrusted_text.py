"""Files of every format with nasty names, and documents with wrong values, for the tests of mesh import."""

from __future__ import annotations

import copy
import io
import json
import struct
import zipfile
from collections.abc import Iterator
from typing import Any

import numpy as np

from tests.precompute import tree_meshes as make
from tests.precompute.fbx_files import fbx_bytes
from tests.precompute.gltf_files import MESHOPT, SQUARE_UV, GltfFile, leaf_image

Json = dict[str, Any]
NASTY = (
    "lone \ud800 surrogate",
    "\udfff",
    "nul \0 and \x1b[31m escape",
    "line\nbreak\u2028and\x85more",
    "bark\u202egnp.exe",
    "\u2066isolate\u2069 \u200bzero width\ufeff",
    "x" * 100_000,
    "'quotes\" <b>&amp;</b> %00 \\u0000",
    "\U000e0041tag \U0010ffff",
)
"""Names that cannot be encoded, cannot be stored, pretend to be others, or are long."""
WRONG: tuple[Any, ...] = (
    None, True, -1, 1.5, 10**30, 1e308, float("inf"), float("nan"), "", "text", "\ud800", [], [[]], {},
    {"a": 1}, ["x"], [1, None], [1e308] * 4, [0] * 16, [{}] * 3, 255, 2**31, -(2**63),
)  # fmt: skip
"""Values for places where others are expected."""


def rich_gltf() -> GltfFile:
    """A tree that uses about everything that is read of a glTF."""
    file = GltfFile()
    wood = make.y_tree()
    bark = file.material("bark", leaf_image("PNG"), "image/png", texCoord=0)
    file.json["materials"][bark] |= {
        "emissiveFactor": [0, 0, 0.1],
        "alphaMode": "OPAQUE",
        "alphaCutoff": 0.5,
        "doubleSided": True,
        "normalTexture": {"index": 0, "scale": 0.5},
        "occlusionTexture": {"index": 0, "strength": 0.5},
        "extras": {"remark": "bark"},
        "extensions": {
            "KHR_materials_pbrSpecularGlossiness": {
                "diffuseFactor": [0.3, 0.2, 0.1, 1],
                "glossinessFactor": 0.3,
            },
            "KHR_materials_unlit": {},
        },
    }
    crown = file.material("crown", leaf_image("WEBP"), "image/webp", "EXT_texture_webp")
    file.json["samplers"] = [{"wrapS": 33071, "magFilter": 9729}]
    file.json["textures"][0]["sampler"] = 0
    file.json["materials"][crown]["pbrMetallicRoughness"] |= {
        "baseColorFactor": [0.2, 0.5, 0.1, 1],
        "metallicFactor": 0,
        "roughnessFactor": 1,
    }
    info = file.json["materials"][crown]["pbrMetallicRoughness"]["baseColorTexture"]
    transform = {"offset": [0.1, 0], "rotation": 0.1, "scale": [1, 1], "texCoord": 0}
    info["extensions"] = {"KHR_texture_transform": transform}
    trunk = file.plain(wood, material=bark, mode=4)
    zeros = file.accessor(np.zeros((len(wood.vertices), 3), dtype="<f4"))
    trunk["targets"] = [{"POSITION": zeros}]
    leaves = file.plain(make.cards([(1.2, 4.0, 0)]), material=crown)
    leaves["attributes"]["TEXCOORD_0"] = file.accessor(SQUARE_UV.astype("<f4"))
    mesh = file.mesh(trunk, name="trunk", weights=[0.5])
    root = file.node(mesh=mesh, name="tree", scale=[1, 1, 1], weights=[0.1], skin=0)
    joints = np.zeros((len(wood.vertices), 4), dtype="<u1")
    trunk["attributes"]["JOINTS_0"] = file.accessor(joints)
    weights = np.tile(np.array([[1, 0, 0, 0]], "<f4"), (len(joints), 1))
    trunk["attributes"]["WEIGHTS_0"] = file.accessor(weights)
    joint = file.node(root=False, name="joint", translation=[0, 0, 0], rotation=[0, 0, 0, 1])
    file.json["skins"] = [
        {"joints": [joint], "inverseBindMatrices": file.accessor(np.eye(4, dtype="<f4").reshape(1, 16))}
    ]
    file.json["nodes"][root]["children"] = [joint]
    places = file.accessor(np.array([[0, 0, 0], [0.2, 0.3, 0]], dtype="<f4"))
    file.use("EXT_mesh_gpu_instancing")
    file.node(
        mesh=file.mesh(leaves, name="leaves"),
        name="foliage",
        matrix=np.eye(4).reshape(-1).tolist(),
        extensions={"EXT_mesh_gpu_instancing": {"attributes": {"TRANSLATION": places}}},
    )
    packed = file.meshopt(make.tube((0, 2, 0), (0.6, 3.6, 0.6), 0.05, 0.03))
    file.node(mesh=file.mesh(packed, name="twig"), name="packed")
    file.use("KHR_draco_mesh_compression")
    drawn = file.draco(make.tube((0, 2, 0), (-0.6, 3.6, 0.6), 0.05, 0.03))
    file.node(mesh=file.mesh(drawn, name="limb"), name="drawn")
    file.json["accessors"][zeros]["sparse"] = _sparse(file)
    file.json["animations"] = [{"name": "sway", "channels": []}]
    file.use("VENDOR_remarks", required=False)
    file.json["extras"] = {"author": "somebody"}
    assert MESHOPT in file.json["extensionsUsed"]
    return file


def _sparse(file: GltfFile) -> Json:
    rows = file.view(np.array([1, 2], dtype="<u2").tobytes())
    values = file.view(np.zeros((2, 3), dtype="<f4").tobytes())
    return {
        "count": 2,
        "indices": {"bufferView": rows, "componentType": 5123},
        "values": {"bufferView": values},
    }


def places_of(value: Any, path: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """The path of every value in a document, without the document itself."""
    items = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, inner in items:
        yield (*path, key)
        yield from places_of(inner, (*path, key))


def with_value(document: Json, path: tuple[Any, ...], value: Any) -> Json:
    """A copy of the document with another value at a path."""
    changed = copy.deepcopy(document)
    holder: Any = changed
    for key in path[:-1]:
        holder = holder[key]
    holder[path[-1]] = value
    return changed


def glb_of(document: Json, binary: bytes) -> bytes:
    """A GLB of a document, whose strings may hold lone surrogates."""
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = binary + bytes(-len(binary) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(body), b"BIN\0") + body
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def document_of(file: GltfFile) -> tuple[Json, bytes]:
    """The document and the binary of a file under construction."""
    data = file.bytes()
    (length,) = struct.unpack_from("<I", data, 12)
    return json.loads(data[20 : 20 + length]), bytes(file.binary)


def named(document: Json, random: np.random.Generator, names: tuple[str, ...] = NASTY) -> Json:
    """A copy in which every name, and every other text that is not a keyword, is a nasty one."""
    changed = copy.deepcopy(document)
    for path in list(places_of(document)):
        holder: Any = changed
        for key in path[:-1]:
            holder = holder[key]
        if path[-1] in ("name", "author", "remark"):
            holder[path[-1]] = names[int(random.integers(len(names)))]
    for key in ("scenes", "nodes", "meshes", "materials", "images", "textures", "accessors", "animations"):
        for entry in changed[key]:
            entry["name"] = names[int(random.integers(len(names)))]
            entry["extras"] = {names[int(random.integers(len(names)))]: names[0]}
    changed["extensionsUsed"].append(names[int(random.integers(len(names)))])
    return changed


def files_named(name: str) -> Iterator[tuple[str, bytes]]:
    """Files of the other formats, each with the name wherever the format has names; the name of each file."""
    text = name.encode("utf-8", "surrogatepass")
    line = text.replace(b"\n", b" ")
    wood = make.y_tree()
    obj = make.obj_bytes(wood, "").replace(
        b"f ", b"o " + line + b"\ng " + line + b"\nusemtl " + line + b"\nf ", 1
    )
    obj = b"mtllib " + line + b"\nmtllib a.mtl\n" + obj
    library = b"newmtl " + line + b"\nKd 0.3 0.2 0.1\nmap_Kd " + line + b"\nmap_" + line + b" x\n"
    yield name + ".obj", obj
    yield "a.zip", _zip({"a.obj": obj, "a.mtl": library, _entry(name): b"x", _entry(name) + ".7z": b"x"})
    yield "a.stl", text[:80].ljust(80, b" ") + make.stl_bytes(wood)[80:]
    ply = make.ply_bytes(wood)
    yield "a.ply", ply.replace(b"element vertex", b"comment " + line[:500] + b"\nelement vertex", 1)
    fbx = fbx_bytes({"NAME": (wood, (0.3, 0.2, 0.1))})
    yield "a.fbx", fbx.replace(b"NAME", line.replace(b'"', b"'")[:5000])
    yield "a.csv", _cylinders(text)


def _entry(name: str) -> str:
    return "".join(c for c in name if c.isprintable() and c not in ":\\/")[:200] + "\u202e.x"


def _zip(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as packed:
        for name, content in files.items():
            packed.writestr(name, content)
    return stream.getvalue()


def _cylinders(heading: bytes) -> bytes:
    heading = heading.replace(b"\n", b" ").replace(b'"', b"'").replace(b",", b" ")[:5000]
    head = b"ID,parentID,startX,startY,startZ,endX,endY,endZ,radius," + heading + b"\n"
    rows = [f"{k},{k - 1},0,0,{k - 1},0,0,{k},0.1,x" for k in range(1, 9)]
    return head + "\n".join(rows).encode() + b"\n9,8,0,0,8,0,0," + heading + b",0.1,x\n"

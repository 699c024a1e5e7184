"""Malicious and malformed uploads with the allowed response statuses."""

from __future__ import annotations

import io
import json
import struct
import zipfile
from dataclasses import dataclass, replace

import numpy as np

from tests.precompute.fixtures import cylinder_models, hostile_files
from tests.server.support.sample_meshes import greedy_ply, nowhere_obj, pole_obj, truncated_glb, zip_file

BOMBS = (
    "draco, edgebreaker", "meshopt, count", "instances", "PNG of 4 × 10⁹ pixels", "KTX2", "zip, entries",
    "zip, climbing", "FBX, truncated",
)  # fmt: skip
"""Cases of hostile_files that are also uploaded: one of each reader that decodes or unpacks."""


@dataclass(frozen=True)
class Case:
    name: str
    filename: str
    data: bytes
    status: int
    codes: tuple[str, ...] = ()  # problem codes; empty if the upload is accepted


def zip_bomb() -> bytes:
    """100 MB of zeros in 100 KB."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("tree.obj", bytes(100_000_000))
    return stream.getvalue()


def glb(document: dict[str, object], body: bytes = b"") -> bytes:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body += bytes(-len(body) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    chunks += struct.pack("<I4s", len(body), b"BIN\0") + body if body else b""
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def glb_of_faces(count: int) -> bytes:
    """A GLB with `count` triangles of the same three vertices and one-byte indices."""
    corners = 3 * count
    positions = np.eye(3, dtype="<f4").tobytes()
    document: dict[str, object] = {
        "asset": {"version": "2.0"},
        "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": 36 + corners}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 36},
            {"buffer": 0, "byteOffset": 36, "byteLength": corners},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"},
            {"bufferView": 1, "componentType": 5121, "count": corners, "type": "SCALAR"},
        ],
    }  # fmt: skip
    return glb(document, positions + bytes([0, 1, 2]) * count)


def deep_gltf(depth: int = 5000) -> bytes:
    """A glTF with deeply nested nodes."""
    nodes: list[dict[str, object]] = [{"children": [k + 1]} for k in range(depth)]
    return json.dumps({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
                       "nodes": [*nodes, {"mesh": 0}], "meshes": [{"primitives": []}]}).encode()  # fmt: skip


def reaching_gltf(uri: str) -> bytes:
    """A glTF with an external buffer URI."""
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
        "buffers": [{"uri": uri, "byteLength": 36}], "bufferViews": [{"buffer": 0, "byteLength": 36}],
        "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3"}],
    }  # fmt: skip
    return json.dumps(document).encode()


def stl_of(faces: int, declared: int | None = None) -> bytes:
    """A binary STL of random triangles with a fixed seed."""
    body = np.zeros(faces, dtype=[("numbers", "<f4", 12), ("end", "<u2")])
    body["numbers"] = np.random.default_rng(7).uniform(0, 5, (faces, 12))
    return bytes(80) + struct.pack("<I", faces if declared is None else declared) + body.tobytes()


def scaled_pole(factor: float) -> bytes:
    """The pole in other units; OBJ files have no unit."""
    lines = pole_obj().decode().splitlines()
    scaled = (
        "v " + " ".join(f"{float(n) * factor:.3f}" for n in line.split()[1:])
        if line.startswith("v ")
        else line
        for line in lines
    )
    return "\n".join(scaled).encode()


def moved(obj: bytes, by_m: float, first: int) -> bytes:
    """The pole of an OBJ, shifted, with face indices from `first`."""
    lines: list[str] = []
    for line in obj.decode().splitlines():
        kind, *rest = line.split()
        if kind == "v":
            rest[0] = f"{float(rest[0]) + by_m:.6f}"
        elif kind == "f":
            rest = [str(int(n) + first) for n in rest]
        lines.append(" ".join([kind, *rest]))
    return "\n".join(lines).encode() + b"\n"


def cases() -> list[Case]:
    """All cases."""
    pole, scan = pole_obj(), cylinder_models.y_model()
    circle = cylinder_models.archi(replace(scan, parent=np.zeros_like(scan.parent)))
    vertices = pole.count(b"\nv ") + 1
    flat = b"\n".join(b"v %d 0 %d" % (i, j) for i in range(4) for j in range(4)) + b"\nf 1 2 6 5\nf 2 3 7 6\n"
    broken, empty = ("truncated", "unreadable", "not-a-glb", "wrong-count"), ("empty-file", "no-file")
    status = {"malformed": 400, "unsupported": 415, "unsuitable": 422, "too-large": 413}
    bombs = [
        Case(name, "a.bin", data_of(), status[reason], (code,))
        for name, data_of, reason, code in hostile_files.CASES
        if name in BOMBS
    ]
    return [
        *bombs,
        Case("empty OBJ", "a.obj", b"", 400, empty),
        Case("empty GLB", "a.glb", b"", 400, empty),
        Case("truncated GLB", "a.glb", truncated_glb(), 400, broken),
        Case("billions of PLY elements", "a.ply", greedy_ply(), 400, broken),
        Case("billions of STL triangles", "a.stl", stl_of(2, 4_000_000_000), 400, broken),
        Case("not numbers", "a.obj", nowhere_obj(), 422),
        Case("a web page", "a.obj", b"<!doctype html><title>Tree</title>", 415, ("unsupported-type",)),
        Case("one triangle", "a.obj", b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", 422),
        Case("a plane", "a.obj", flat, 422),
        Case("random triangles", "a.stl", stl_of(400), 422),
        Case("a zip without a model", "a.obj", zip_file(), 415, ("unsupported-type",)),
        Case("a zip bomb", "a.obj", zip_bomb(), 413, ("zip-ratio",)),
        Case("a buffer elsewhere", "a.gltf", reaching_gltf("../../../../etc/passwd"), 400),
        Case("a buffer on a host", "a.gltf", reaching_gltf("http://127.0.0.1:1/x.bin"), 400),
        Case("deep nodes", "a.gltf", deep_gltf(), 422),
        Case("deep JSON", "a.gltf", b'{"a":' * 100_000, 400),
        Case(
            "2 million lines of faces",
            "a.obj",
            b"v 0 0 0\n" + b"f 1 1 1\n" * 2_000_000,
            413,
            ("too-many-faces",),
        ),
        Case("3 million faces", "a.glb", glb_of_faces(3_000_000), 413, ("too-many-faces",)),
        Case("two trees", "a.obj", pole + moved(pole, 6.0, vertices), 0),
        Case("a name that climbs", "../../../etc/cron.d/x.obj", pole, 201),
        Case("not UTF-8", "a.obj", b"# p\xe9ch\xe9\n" + scaled_pole(1.01), 201),
        Case("a library elsewhere", "a.obj", b"mtllib ../../../../etc/passwd\n" + scaled_pole(1.02), 201),
        Case("millimetres", "mm.obj", scaled_pole(1030), 201),
        Case("a scanned tree", "a.mat", cylinder_models.treeqsm(scan), 201),
        Case("a scanned tree as a table", "a.csv", cylinder_models.simpleforest(scan.scaled(1.1)), 201),
        Case("a truncated scan", "a.mat", cylinder_models.treeqsm(scan)[:400], 400, ("unreadable",)),
        Case("a scan as HDF5", "a.mat", b"\x89HDF\r\n\x1a\n" + bytes(500), 415, ("mat-version",)),
        Case("a scan in a circle", "a.csv", circle, 422, ("cylinder-cycle",)),
    ]

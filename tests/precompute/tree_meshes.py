"""Small meshes of known dimensions and writers for each format, so that no test needs a file."""

import base64
import json
import struct
from typing import Any

import numpy as np
from galewood.tree.render_mesh import render_glb
from galewood.tree.repair import Surface
from galewood.tree.types import RenderPrimitive, TreeMesh


def tube(start, end, radius_start, radius_end, sides=10, rings=6, closed=True) -> Surface:
    """A straight round tube with outward faces; closed by fans."""
    start, end = np.array(start, dtype=float), np.array(end, dtype=float)
    axis = (end - start) / np.linalg.norm(end - start)
    side = np.cross(axis, (0.0, 0.0, 1.0) if abs(axis[2]) < 0.9 else (1.0, 0.0, 0.0))
    side /= np.linalg.norm(side)
    other = np.cross(axis, side)
    angle = np.arange(sides) * 2 * np.pi / sides
    circle = np.cos(angle)[:, None] * side + np.sin(angle)[:, None] * other
    share = np.linspace(0, 1, rings)[:, None, None]
    radius = radius_start + (radius_end - radius_start) * share
    vertices = ((start + share * (end - start)) + radius * circle).reshape(-1, 3)
    faces = []
    for ring in range(rings - 1):
        for k in range(sides):
            a, b = ring * sides + k, ring * sides + (k + 1) % sides
            faces += [(a, b, b + sides), (a, b + sides, a + sides)]
    if closed:
        top = len(vertices) + 1
        vertices = np.vstack([vertices, start, end])
        last = (rings - 1) * sides
        for k in range(sides):
            following = (k + 1) % sides
            faces += [(following, k, top - 1), (last + k, last + following, top)]
    return Surface(vertices, np.array(faces, dtype=np.int32))


def joined(*surfaces: Surface) -> Surface:
    offsets = np.cumsum([0] + [len(s.vertices) for s in surfaces[:-1]])
    return Surface(
        np.vstack([s.vertices for s in surfaces]),
        np.vstack([s.faces + o for s, o in zip(surfaces, offsets, strict=True)]).astype(np.int32),
    )


FORK_M = 2.5
BRANCHES = (((0, FORK_M, 0), (1.6, 4.6, 0)), ((0, FORK_M, 0), (-1.5, 4.9, 0.4)))


def y_tree(closed=True) -> Surface:
    """A trunk of radius 0.15 m and two branches, as overlapping tubes; 4.9 m tall, y up."""
    trunk = tube((0, 0, 0), (0, FORK_M + 0.1, 0), 0.15, 0.12, closed=closed)
    return joined(trunk, *(tube(a, b, 0.09, 0.04, closed=closed) for a, b in BRANCHES))


def cards(centres, size=0.3) -> Surface:
    """A square leaf card of two triangles above each given point."""
    square = np.array([[-0.5, 0, 0], [0.5, 0, 0], [0.5, 1, 0], [-0.5, 1, 0]]) * size
    vertices = (np.asarray(centres)[:, None] + square).reshape(-1, 3)
    corner = 4 * np.arange(len(centres))[:, None, None]
    return Surface(vertices, (corner + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3).astype(np.int32))


def as_tree(wood: Surface, leaves: Surface | None = None, species: str = "") -> TreeMesh:
    """A TreeMesh created directly from surfaces, without the mesh import; its parts may name a species."""
    primitives = [RenderPrimitive(f"wood_0 {species}".strip(), "wood", wood.vertices, wood.faces)]
    if leaves is not None:
        primitives.append(RenderPrimitive("leaves_0", "leaves", leaves.vertices, leaves.faces))
    top = max(float(p.positions_m[:, 1].max()) for p in primitives)
    return TreeMesh(primitives, wood.vertices, wood.faces, top, None, {})


def glb_bytes(wood: Surface, leaves: Surface | None = None, species: str = "") -> bytes:
    return render_glb(as_tree(wood, leaves, species))


def obj_bytes(surface: Surface, head="") -> bytes:
    lines = [head] + ["v " + " ".join(f"{c:.9g}" for c in v) for v in surface.vertices]
    return "\n".join(lines + ["f " + " ".join(str(i + 1) for i in f) for f in surface.faces]).encode()


def stl_bytes(surface: Surface) -> bytes:
    record = np.zeros(len(surface.faces), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    record["v"] = surface.vertices[surface.faces]
    return b"x" * 80 + struct.pack("<I", len(record)) + record.tobytes()


def ply_bytes(surface: Surface, vertices=None) -> bytes:
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {vertices or len(surface.vertices)}\n"
        "property float x\nproperty float y\nproperty float z\n"
        f"element face {len(surface.faces)}\nproperty list uchar int vertex_indices\nend_header\n"
    )
    face = np.zeros(len(surface.faces), dtype=[("n", "u1"), ("i", "<i4", 3)])
    face["n"], face["i"] = 3, surface.faces
    return head.encode() + surface.vertices.astype("<f4").tobytes() + face.tobytes()


def gltf_document(surface: Surface, uri: str | None = None, quantised=False) -> dict[str, Any]:
    """A glTF with one mesh; its buffer is a data URI unless `uri` is given; optionally 16-bit normalised."""
    positions = surface.vertices.astype("<f4")
    node: dict[str, Any] = {"mesh": 0}
    component, normalised = 5126, False
    if quantised:
        scale = float(np.abs(surface.vertices).max())
        positions = np.zeros(
            (len(surface.vertices), 4), dtype="<i2"
        )  # rows are padded to a multiple of four bytes
        positions[:, :3] = np.round(surface.vertices / scale * 32767)
        node["scale"] = [scale] * 3
        component, normalised = 5122, True
    first, second = positions.tobytes(), surface.faces.astype("<u4").tobytes()
    blob = first + second
    view = {"buffer": 0, "byteLength": len(first)} | ({"byteStride": 8} if quantised else {})
    accessor = {"bufferView": 0, "componentType": component, "count": len(positions), "type": "VEC3"}
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [node],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            accessor | ({"normalized": True} if normalised else {}),
            {"bufferView": 1, "componentType": 5125, "count": surface.faces.size, "type": "SCALAR"},
        ],
        "bufferViews": [view, {"buffer": 0, "byteOffset": len(first), "byteLength": len(second)}],
        "buffers": [{"byteLength": len(blob), "uri": uri or _data_uri(blob)}],
    }


def _data_uri(blob: bytes) -> str:
    return "data:application/octet-stream;base64," + base64.b64encode(blob).decode()


def gltf_bytes(document: dict[str, Any]) -> bytes:
    return json.dumps(document).encode()

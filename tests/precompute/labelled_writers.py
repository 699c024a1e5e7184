"""Writes the parts of generated trees as OBJ, PLY, STL and GLB."""

import json
import struct
from typing import Any

import numpy as np

from tests.precompute.labelled_looks import Part
from tests.precompute.labelled_shapes import together


def write_obj(parts: list[Part]) -> bytes:
    lines, base = [], 1
    for part in parts:
        lines += [f"o {part.name}"] if part.name else []
        lines += ["v " + " ".join(f"{c:.7g}" for c in v) for v in part.shape.vertices]
        lines += ["f " + " ".join(str(i + base) for i in f) for f in part.shape.faces]
        base += len(part.shape.vertices)
    return "\n".join(lines).encode()


def write_ply(parts: list[Part]) -> bytes:
    whole = together(*(p.shape for p in parts))
    coloured = any(p.look.vertex_colour for p in parts)
    bytes_rgb = "property uchar red\nproperty uchar green\nproperty uchar blue\n" if coloured else ""
    head = (
        f"ply\nformat binary_little_endian 1.0\nelement vertex {len(whole.vertices)}\nproperty float x\n"
        f"property float y\nproperty float z\n{bytes_rgb}element face {len(whole.faces)}\n"
        "property list uchar int vertex_indices\nend_header\n"
    )
    face = np.zeros(len(whole.faces), dtype=[("n", "u1"), ("i", "<i4", 3)])
    face["n"], face["i"] = 3, whole.faces
    kinds = [("p", "<f4", 3)] + ([("c", "u1", 3)] if coloured else [])
    vertex = np.zeros(len(whole.vertices), dtype=kinds)
    vertex["p"] = whole.vertices
    if coloured:
        vertex["c"] = np.round(np.concatenate([_vertex_colours(p) for p in parts]) ** (1 / 2.2) * 255)
    return head.encode() + vertex.tobytes() + face.tobytes()


def write_stl(parts: list[Part]) -> bytes:
    whole = together(*(p.shape for p in parts))
    record = np.zeros(len(whole.faces), dtype=[("n", "<f4", 3), ("v", "<f4", (3, 3)), ("a", "<u2")])
    record["v"] = whole.vertices[whole.faces]
    return b"x" * 80 + struct.pack("<I", len(record)) + record.tobytes()


def write_glb(parts: list[Part]) -> bytes:
    """A GLB in which parts of the same name, image and alpha mode share one primitive."""
    blob = bytearray()
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": []}],
        "nodes": [],
        "meshes": [],
        "accessors": [],
        "bufferViews": [],
        "materials": [],
        "textures": [],
        "images": [],
    }

    def view(content: bytes) -> int:
        blob.extend(b"\0" * (-len(blob) % 4))
        document["bufferViews"].append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(content)})
        blob.extend(content)
        return len(document["bufferViews"]) - 1

    def accessor(rows, kind: str, component: int) -> int:
        document["accessors"].append(
            {"bufferView": view(rows.tobytes()), "componentType": component, "count": len(rows), "type": kind}
        )
        return len(document["accessors"]) - 1

    shared: dict[tuple[Any, ...], list[Part]] = {}
    for part in parts:
        look = part.look
        shared.setdefault((part.name, look.image, look.alpha_mode, look.factor), []).append(part)
    for (name, image, alpha_mode, factor), members in shared.items():
        whole = together(*(p.shape for p in members))
        attributes = {"POSITION": accessor(whole.vertices.astype("<f4"), "VEC3", 5126)}
        material: dict[str, Any] = {"name": name} if name else {}
        pbr: dict[str, Any] = {"metallicFactor": 0.0}
        if image is not None:
            uv = [_in_cell(p.shape.uv, p.look.cell, len(p.shape.vertices)) for p in members]
            attributes["TEXCOORD_0"] = accessor(np.concatenate(uv).astype("<f4"), "VEC2", 5126)
            document["images"].append({"bufferView": view(image), "mimeType": "image/png"})
            document["textures"].append({"source": len(document["images"]) - 1})
            pbr["baseColorTexture"] = {"index": len(document["textures"]) - 1}
        if factor is not None:
            pbr["baseColorFactor"] = [*factor, 1.0]
        if any(p.look.vertex_colour for p in members):
            colour = [_vertex_colours(p) for p in members]
            attributes["COLOR_0"] = accessor(np.concatenate(colour).astype("<f4"), "VEC3", 5126)
        material["pbrMetallicRoughness"] = pbr
        material |= {"alphaMode": alpha_mode} if alpha_mode else {}
        document["materials"].append(material)
        indices = accessor(whole.faces.astype("<u4").reshape(-1), "SCALAR", 5125)
        primitive = {"attributes": attributes, "indices": indices, "material": len(document["materials"]) - 1}
        document["meshes"].append({"primitives": [primitive]})
        document["nodes"].append({"mesh": len(document["meshes"]) - 1})
        document["scenes"][0]["nodes"].append(len(document["nodes"]) - 1)
    document["buffers"] = [{"byteLength": len(blob)}]
    text = json.dumps({k: v for k, v in document.items() if v != []}).encode()
    text += b" " * (-len(text) % 4)
    body = bytes(blob) + b"\0" * (-len(blob) % 4)
    head = struct.pack("<4sII", b"glTF", 2, 28 + len(text) + len(body))
    return (
        head
        + struct.pack("<I4s", len(text), b"JSON")
        + text
        + struct.pack("<I4s", len(body), b"BIN\0")
        + body
    )


def _vertex_colours(part: Part) -> np.ndarray:
    rng = np.random.default_rng(len(part.shape.vertices))
    colours = np.tile(part.look.vertex_colour or (1.0, 1.0, 1.0), (len(part.shape.vertices), 1))
    return np.clip(colours * rng.uniform(1 - part.look.noise, 1 + part.look.noise, (len(colours), 1)), 0, 1)


def _in_cell(uv, cell, count):
    rows = uv if uv is not None else np.zeros((count, 2))
    if cell is None:
        return rows
    u0, v0, u1, v1 = cell
    return np.column_stack(
        [
            u0 + np.clip(rows[:, 0] % 1.0001, 0, 1) * (u1 - u0),
            v0 + np.clip(rows[:, 1] % 1.0001, 0, 1) * (v1 - v0),
        ]
    )

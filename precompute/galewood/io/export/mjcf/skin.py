"""The drawn mesh as MuJoCo skins: each vertex between the bodies of two nodes, as the table draws it."""

from __future__ import annotations

import struct
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.rigid.bodies import GROUND_BODY, RigidTree, upright
from galewood.io.export.rigid.looks import write_look
from galewood.table import Table
from galewood.util import Floats, Ints

BONE_NAME_BYTES = 40


@dataclass(frozen=True)
class Skin:
    """A skin file with its look; the names of files in the folder of the export."""

    name: str
    file: str
    texture: str | None
    rgba: tuple[float, float, float, float]


def write_skins(
    folder: Path, name: str, table: Table, file: GltfFile, tree: RigidTree, names: list[str]
) -> list[Skin]:
    """Write a skin for every primitive that the table's tree shows, with its texture as PNG.

    ``names`` (b + 1): of the bodies, and last of the body that stands for the ground.
    """
    rest = upright(file.rest_m())
    bones, weights = vertex_bones(table, tree)
    place = np.concatenate([upright(tree.hinge_m), np.zeros((1, 3))])
    found, start = list[Skin](), 0
    for index, (primitive, corners) in enumerate(
        zip(table.metadata["primitives"], file.faces(), strict=True)
    ):
        mine = slice(start, start + int(primitive["vertices"]))
        start = mine.stop
        kind = str(primitive["kind"])
        if kind == "leaves" and table.foliage == "bare":
            continue
        look = write_look(file, index, folder, name, transparent=False)
        faces = np.concatenate([corners, corners[:, ::-1]]) if look.both_sides else corners
        uv = file.texture_coordinates()[index]
        data = skin_bytes(rest[mine], uv, faces, bones[mine], weights[mine], names, place)
        path = f"{name}_{kind}_{index}.skn"
        (folder / path).write_bytes(data)
        texture = look.texture if uv is not None else None
        found.append(Skin(f"{name}_{kind}_{index}", path, texture, look.rgba))
    return found


def vertex_bones(table: Table, tree: RigidTree) -> tuple[Ints, Floats]:
    """Bodies (v, 2) that a vertex hangs on, the ground as b, and their weights (v, 2)."""
    joint = table.vertex_joint.astype(np.int64)
    body = tree.of_node[table.joint_nodes.astype(np.int64)][joint]
    share = table.joint_share.astype(np.float64)[joint]
    return np.where(body == GROUND_BODY, tree.count, body), np.stack([1 - share, share], axis=1)


def skin_bytes(
    rest_m: Floats,
    uv: npt.NDArray[np.floating[Any]] | None,
    faces: Ints,
    bones: Ints,
    weights: Floats,
    names: list[str],
    place_m: Floats,
) -> bytes:
    """A skin in MuJoCo's binary format SKN (MuJoCo documentation, XML reference, skin/file)."""
    used = np.unique(bones[weights > 0])  # MuJoCo takes no bone without vertices
    coordinates = np.zeros((0, 2)) if uv is None else uv
    parts = [
        struct.pack("<4i", len(rest_m), len(coordinates), len(faces), len(used)),
        rest_m.astype("<f4").tobytes(),
        coordinates.astype("<f4").tobytes(),
        faces.astype("<i4").tobytes(),
    ]
    for bone in used:
        weight = np.where(bones == bone, weights, 0.0).sum(axis=1)
        held = np.flatnonzero(weight > 0)
        parts += [
            names[bone].encode().ljust(BONE_NAME_BYTES, b"\0"),
            place_m[bone].astype("<f4").tobytes(),
            struct.pack("<4f", 1.0, 0.0, 0.0, 0.0),
            struct.pack("<i", len(held)),
            held.astype("<i4").tobytes(),
            weight[held].astype("<f4").tobytes(),
        ]
    return b"".join(parts)

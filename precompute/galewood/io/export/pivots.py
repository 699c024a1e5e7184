"""Pivot-painter textures for Unreal Engine: pivots, axes, extents and parents of the parts of a tree.

Follows Unreal's page "Pivot Painter Tool 2.0" and its MAXScript reference: the position texture holds 16-bit
pivots, with the parent's index in alpha as the bits of a half float, plus 1024; the axis texture holds 8-bit
x axes with the extent along them in alpha, in steps of 8 up to 2048; the foliage shader takes hierarchies of
four levels. A part is a branch of the table, or the twigs and leaves of one joint.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.io.export.engine.levels import write_levels
from galewood.io.export.engine.tangents import add_tangents
from galewood.io.export.errors import ExportError
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.gltf_names import give_names
from galewood.io.export.looped import Loop
from galewood.io.export.options import ExportOptions
from galewood.io.export.skeletal.bones import export_bones
from galewood.io.export.skeletal.joints import joint_motion, joint_of_vertex
from galewood.io.export.skeletal.skeleton import branch_of_node, levels, parents_of, samples
from galewood.io.export.textures import write_exr, write_png8
from galewood.table import Table
from galewood.util import Floats, Ints

MAX_LEVELS = 4
MOST_PARTS = 30_000
CM_PER_M = 100.0
INDEX_OFFSET = 1024
EXTENT_STEP_CM, EXTENT_STEPS = 8.0, 256


@dataclass(frozen=True)
class Parts:
    """Parts of a tree, parents first; m, axes of the tree."""

    parent: Ints
    """(p,) parent of each; the trunk is its own."""
    level: Ints
    """(p,) 0: trunk."""
    pivot_m: Floats
    """(p, 3)"""
    axis: Floats
    """(p, 3) unit vectors from the pivot to the far end."""
    extent_m: Floats
    """(p,) length along the axis."""
    of_vertex: Ints
    """(v,) part of each render vertex."""


def parts_of(table: Table, rest_m: Floats) -> Parts:
    """The parts of a tree. Branches of the fourth level and beyond belong to their parent."""
    part_of_node, parent, level = _branches(table)
    joint = joint_of_vertex(table)
    node_of_joint = _nearer_node(table)
    of_vertex = part_of_node[node_of_joint][joint]
    hanging = np.repeat(
        [primitive["kind"] != "wood" for primitive in table.metadata["primitives"]],
        [int(primitive["vertices"]) for primitive in table.metadata["primitives"]],
    )
    clusters = np.unique(joint[hanging])
    number = np.full(len(table.joint_share), -1)
    number[clusters] = len(parent) + np.arange(len(clusters))
    of_vertex = np.where(hanging, number[joint], of_vertex)
    parent_part = part_of_node[node_of_joint][clusters]
    parent, level = np.concatenate([parent, parent_part]), np.concatenate([level, level[parent_part] + 1])
    if len(parent) > MOST_PARTS:
        raise ExportError(f"the tree has {len(parent)} parts; pivot-painter textures hold {MOST_PARTS}")
    pivot = np.concatenate(
        [_branch_pivots(table, part_of_node), table.joint_rest_m[clusters].astype(np.float64)]
    )
    axis, extent = _reach(rest_m, of_vertex, pivot)
    return Parts(parent, level, pivot, axis, extent, of_vertex)


def _branches(table: Table) -> tuple[Ints, Ints, Ints]:
    """Part of each node (n,), parents and levels of these parts; roots but the first count as branches."""
    branch, parent_branch = branch_of_node(table)
    parent_branch = np.where(parent_branch < 0, 0, parent_branch)
    level = levels(np.where(np.arange(len(parent_branch)) == 0, -1, parent_branch))
    kept = level < MAX_LEVELS - 1
    part = np.cumsum(kept) - 1
    for one in np.flatnonzero(~kept):
        part[one] = part[parent_branch[one]]
    return part[branch], part[parent_branch[kept]], level[kept]


def _nearer_node(table: Table) -> Ints:
    nodes = table.joint_nodes.astype(np.int64)
    return np.where(table.joint_share > 0.5, nodes[:, 1], nodes[:, 0])


def _branch_pivots(table: Table, part_of_node: Ints) -> Floats:
    """Where each branch begins: the parent of its first node, or that node itself."""
    parent, rest = parents_of(table), table.node_rest_m.astype(np.float64)
    first = np.unique(part_of_node, return_index=True)[1]
    return rest[np.where(parent[first] >= 0, parent[first], first)]


def _reach(rest_m: Floats, of_vertex: Ints, pivot: Floats) -> tuple[Floats, Floats]:
    """Axes (p, 3) towards the vertex farthest from each pivot, and its distance (p,), m."""
    arm = rest_m - pivot[of_vertex]
    length = np.linalg.norm(arm, axis=1)
    axis, extent = np.tile([0.0, 1.0, 0.0], (len(pivot), 1)), np.zeros(len(pivot))
    order = np.lexsort((length, of_vertex))
    last = np.flatnonzero(np.diff(of_vertex[order], append=-1))
    farthest = order[last]
    part = of_vertex[farthest]
    extent[part] = length[farthest]
    long = length[farthest] > 0
    axis[part[long]] = arm[farthest][long] / length[farthest][long, None]
    return axis, extent


def to_unreal(vectors: Floats) -> Floats:
    """Vectors (…, 3) with z up: Unreal's importer of glTF takes (x, y, z) as (x, z, y), left-handed."""
    return vectors[..., [0, 2, 1]]


def packed_index(index: Ints) -> npt.NDArray[np.float16]:
    """Integers as half floats whose bits are the integer plus 1024, as the shader unpacks them."""
    return (index + INDEX_OFFSET).astype(np.uint16).view(np.float16)


def unpacked_index(packed: npt.NDArray[np.float16]) -> Ints:
    """The inverse of ``packed_index``."""
    return packed.view(np.uint16).astype(np.int64) - INDEX_OFFSET


def export_pivots(
    table: Table, glb: bytes, loops: Mapping[str, Loop], folder: Path, name: str, options: ExportOptions
) -> dict[str, Any]:
    """Write textures, static mesh, and a rigged mesh with wind.json; return the description.

    ``loops``: by the name of the wind; how far parts turn is that of the last one.
    """
    loop = list(loops.values())[-1]
    file = GltfFile(glb, table)
    give_names(file.gltf, name)
    add_tangents(file)
    parts = parts_of(table, file.rest_m())
    count = len(parts.parent)
    width = 1 << (int(np.ceil(np.sqrt(count))) - 1).bit_length()
    height = 1 << (-(-count // width) - 1).bit_length()
    column, row = parts.of_vertex % width, parts.of_vertex // width
    file.add_second_coordinates(
        np.stack([(column + 0.5) / width, (row + 0.5) / height], axis=1).astype(np.float32)
    )
    _write_position(folder / f"{name}_pivot_index.exr", parts, width, height)
    _write_axis(folder / f"{name}_axis_extent.png", parts, width, height)
    detail = write_levels(file, table, folder, name, options.levels)
    (folder / f"{name}.glb").write_bytes(file.glb())
    description: dict[str, Any] = {
        "format": "galewood-pivots",
        "version": 1,
        "mesh": f"{name}.glb",
        "textures": {"position_index": f"{name}_pivot_index.exr", "axis_extent": f"{name}_axis_extent.png"},
        "axes": "Unreal: cm, z up; glTF (x, y, z) is (x, z, y); TEXCOORD_1 is the centre of the part's texel",
        "detail": detail,
        "parts": count,
        "width": width,
        "height": height,
        "levels": _levels(table, parts, loop),
        "frequencies_hz": [float(f) for f in table.metadata["frequencies_hz"][:4]],
        "rigged": export_bones(table, glb, loops, folder, f"{name}_rigged", options),
    }
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    return description


def _write_position(path: Path, parts: Parts, width: int, height: int) -> None:
    pixels = np.zeros((height * width, 4), np.float16)
    pixels[: len(parts.parent), :3] = CM_PER_M * to_unreal(parts.pivot_m)
    pixels[: len(parts.parent), 3] = packed_index(parts.parent)
    write_exr(path, pixels.reshape(height, width, 4))


def _write_axis(path: Path, parts: Parts, width: int, height: int) -> None:
    pixels = np.zeros((height * width, 4), np.uint8)
    pixels[: len(parts.parent), :3] = np.rint(255 * (0.5 + 0.5 * to_unreal(parts.axis)))
    steps = np.clip(CM_PER_M * parts.extent_m / EXTENT_STEP_CM, 1, EXTENT_STEPS) / EXTENT_STEPS
    pixels[: len(parts.parent), 3] = np.rint(255 * steps)
    write_png8(path, pixels.reshape(height, width, 4))


def _levels(table: Table, parts: Parts, loop: Loop) -> list[dict[str, Any]]:
    """How far the parts of each level turn in the loop, degrees RMS: what a wind setting should reproduce."""
    motion = samples(joint_motion(table, loop.q()))
    sine = np.sqrt(np.square(motion.rotation[:, :, :3]).sum(axis=2))
    turn = np.degrees(np.sqrt(np.square(2 * np.arcsin(np.minimum(sine, 1.0))).mean(axis=0)))
    of_vertex = turn[joint_of_vertex(table)]
    level = parts.level[parts.of_vertex]
    return [
        {"parts": int((parts.level == k).sum()), "turn_deg_rms": float(of_vertex[level == k].mean())}
        for k in range(MAX_LEVELS)
        if (level == k).any()
    ]

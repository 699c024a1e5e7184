"""A GLB with a skeleton, skin weights and looping animations (glTF 2.0, section 3.7.3)."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from galewood.io.export.engine.levels import write_levels
from galewood.io.export.engine.tangents import add_tangents
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.gltf_names import give_names
from galewood.io.export.looped import Loop, seam
from galewood.io.export.options import ExportOptions
from galewood.io.export.skeletal.clips import Clip, add_clip, clip_of, local_motion, local_rest, product
from galewood.io.export.skeletal.joints import (
    RigidMotion,
    joint_motion,
    joint_of_vertex,
    node_motion,
    rotated,
)
from galewood.io.export.skeletal.skeleton import MAX_POSES, Skeleton, choose_bones
from galewood.io.export.skeletal.skinning import BONES_PER_VERTEX, fitted_weights
from galewood.io.export.skeletal.trunk import add_capsule, trunk_capsule
from galewood.io.export.skeletal.wind_groups import wind_groups
from galewood.solid.skinning import drawn_positions
from galewood.table import Table
from galewood.util import Floats, Ints

MEASURED_MOMENTS = 64


@dataclass(frozen=True)
class Rig:
    """A skeleton, and the bones of every vertex."""

    skeleton: Skeleton
    bones: Ints
    """(v, 4)"""
    weights: Floats
    """(v, 4)"""


def rigged(table: Table, rest_m: Floats, loops: Sequence[Loop], most: int) -> Rig:
    """At most ``most`` bones at the nodes of the table, and weights fitted to the motion of all loops."""
    few = _few_poses(loops)
    of_nodes = node_motion(table, few)
    skeleton = choose_bones(table, of_nodes, most)
    of_bones = RigidMotion(of_nodes.moved_m[:, skeleton.node], of_nodes.rotation[:, skeleton.node])
    bones, weights = fitted_weights(table, rest_m, skeleton, of_bones, joint_motion(table, few))
    joint = joint_of_vertex(table)
    return Rig(skeleton, bones[joint], _normal(weights)[joint])


def _few_poses(loops: Sequence[Loop]) -> Floats:
    """(T, r) at most MAX_POSES poses of all loops, evenly spaced."""
    q = np.concatenate([loop.keys() for loop in loops])
    return q[np.unique(np.linspace(0, len(q) - 1, min(len(q), MAX_POSES)).astype(np.int64))]


def _normal(weights: Floats) -> Floats:
    """Weights whose single-precision sums are 1."""
    rounded = np.round(weights * 65535) / 65535
    rounded[np.arange(len(rounded)), rounded.argmax(axis=1)] += 1.0 - rounded.sum(axis=1)
    return rounded


def skinned(rig: Rig, motion: RigidMotion, rest_m: Floats, frame: float) -> Floats:
    """(v, 3) vertices at a frame number of a clip, by linear blend skinning, as glTF players do it.

    Players interpolate each bone's translation and rotation relative to its parent.
    """
    first, share = int(frame), frame - int(frame)
    local = local_motion(rig.skeleton, motion)
    second = first + 1
    place = (1 - share) * local.moved_m[first] + share * local.moved_m[second]
    turn = (1 - share) * local.rotation[first] + share * local.rotation[second]
    turn /= np.linalg.norm(turn, axis=1, keepdims=True)
    where, rotation = _global(rig.skeleton, place, turn)
    found = np.zeros_like(rest_m)
    for k in range(BONES_PER_VERTEX):
        bone = rig.bones[:, k]
        moved = where[bone] + rotated(rotation[bone], rest_m - rig.skeleton.place_m[bone])
        found += rig.weights[:, k : k + 1] * moved
    return found


def _global(skeleton: Skeleton, place: Floats, turn: Floats) -> tuple[Floats, Floats]:
    where, rotation = place.copy(), turn.copy()
    for bone, above in enumerate(skeleton.parent):
        if above >= 0:
            where[bone] = where[above] + rotated(rotation[above], place[bone])
            rotation[bone] = product(rotation[above], turn[bone])
    return where, rotation


def export_bones(
    table: Table, glb: bytes, loops: Mapping[str, Loop], folder: Path, name: str, options: ExportOptions
) -> dict[str, Any]:
    """Write the rigged GLB with a clip NAME_WIND for each loop, its coarser levels of detail, and wind.json.

    Returns the description, which is written too. ``loops``: by the name of the wind. Raises ExportError.
    """
    file = GltfFile(glb, table)
    give_names(file.gltf, name)
    add_tangents(file)
    rest_m = file.rest_m()
    rig = rigged(table, rest_m, list(loops.values()), options.bones)
    clips = [clip_of(table, rig.skeleton, f"{name}_{wind}", loop) for wind, loop in loops.items()]
    first = _add_rig(file, rig, name)
    levels = write_levels(file, table, folder, name, options.levels)
    capsule = trunk_capsule(table, rest_m)
    add_capsule(file, capsule, name)
    for clip in clips:
        add_clip(file, rig.skeleton, clip, first)
    about = [_about(table, rest_m, rig, clip) for clip in clips]
    description: dict[str, Any] = {
        "format": "galewood-bones",
        "version": 2,
        "mesh": f"{name}.glb",
        "bones": len(rig.skeleton.node),
        **clips[0].loop.about_length(table),
        "clips": about,
        "levels": levels,
        "trunk": {"foot_m": capsule.foot_m.tolist(), "top_m": capsule.top_m.tolist(), **capsule.about()},
        "measured": {key: max(each["measured"][key] for each in about) for key in about[0]["measured"]},
    }
    file.note("galewood_bones", description)
    (folder / f"{name}.glb").write_bytes(file.glb())
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    groups = wind_groups(table, rig.skeleton, _joined([clip.motion for clip in clips]))
    (folder / f"{name}.wind.json").write_text(json.dumps(groups, indent=2) + "\n")
    return description


def _joined(motions: Sequence[RigidMotion]) -> RigidMotion:
    """Motions of the same bodies, one after another."""
    moved = np.concatenate([motion.moved_m for motion in motions])
    return RigidMotion(moved, np.concatenate([motion.rotation for motion in motions]))


def _about(table: Table, rest_m: Floats, rig: Rig, clip: Clip) -> dict[str, Any]:
    measured = _errors(table, rest_m, rig, clip) | seam(table, rest_m, clip.loop)
    return {"animation": clip.name, "wind": clip.loop.wind.document(), "measured": measured}


def _errors(table: Table, rest_m: Floats, rig: Rig, clip: Clip) -> dict[str, float]:
    worst, squares, loop = 0.0, 0.0, clip.loop
    moments = np.linspace(0.0, loop.frames, min(MEASURED_MOMENTS, 2 * loop.frames), endpoint=False)
    for frame in moments:
        exact = drawn_positions(table, rest_m, loop.q_at(frame * loop.seconds / loop.frames))
        apart = np.linalg.norm(skinned(rig, clip.motion, rest_m, float(frame)) - exact, axis=1)
        worst, squares = max(worst, float(apart.max())), squares + float(np.square(apart).mean())
    percent = 100 / float(table.metadata["height_m"])
    return {
        "error_percent_of_height": percent * worst,
        "rms_error_percent_of_height": percent * (squares / len(moments)) ** 0.5,
    }


def _add_rig(file: GltfFile, rig: Rig, name: str) -> int:
    """Add skeleton and skin; return the node of the first bone."""
    import pygltflib

    gltf, skeleton = file.gltf, rig.skeleton
    kind = np.uint8 if len(skeleton.node) <= 256 else np.uint16
    # glTF: a bone of weight 0 is 0
    file.add_attribute("JOINTS_0", np.where(rig.weights > 0, rig.bones, 0).astype(kind))
    file.add_attribute("WEIGHTS_0", rig.weights.astype(np.float32))
    first = len(gltf.nodes)
    rest = local_rest(skeleton)
    for bone, bone_name in enumerate(skeleton.name):
        children = (first + np.flatnonzero(skeleton.parent == bone)).tolist()
        gltf.nodes.append(
            pygltflib.Node(name=bone_name, translation=rest[bone].tolist(), children=children or None)
        )
    roots = (first + np.flatnonzero(skeleton.parent < 0)).tolist()
    gltf.nodes.append(pygltflib.Node(name=f"{name}_skeleton", children=roots))
    scene = gltf.scenes[gltf.scene or 0]
    scene.nodes = [*(scene.nodes or []), len(gltf.nodes) - 1]
    inverse = np.tile(np.eye(4), (len(skeleton.node), 1, 1))
    inverse[:, 3, :3] = -skeleton.place_m  # columns first
    gltf.skins.append(
        pygltflib.Skin(
            name=f"{name}_skin",
            inverseBindMatrices=file.add_rows(inverse.reshape(-1, 16)),
            skeleton=len(gltf.nodes) - 1,
            joints=list(range(first, first + len(skeleton.node))),
        )
    )
    for node in gltf.nodes[:first]:
        if node.mesh is not None:
            node.skin = len(gltf.skins) - 1
    return first

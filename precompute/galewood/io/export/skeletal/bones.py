"""A GLB with a skeleton, skin weights and a looping animation (glTF 2.0, section 3.7.3)."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.gltf_names import give_names
from galewood.io.export.looped import Loop, seam
from galewood.io.export.options import MOST_BONES
from galewood.io.export.skeletal.joints import (
    RigidMotion,
    joint_motion,
    joint_of_vertex,
    node_motion,
    rotated,
)
from galewood.io.export.skeletal.skeleton import Skeleton, choose_bones, samples
from galewood.io.export.skeletal.skinning import BONES_PER_VERTEX, fitted_weights
from galewood.io.export.skeletal.wind_groups import wind_groups
from galewood.solid.skinning import drawn_positions
from galewood.table import Table
from galewood.util import Floats, Ints

if TYPE_CHECKING:
    import pygltflib

MEASURED_MOMENTS = 64
STILL_TOLERANCE = 1e-6
"""A bone that moves less than this, m or in a quaternion, has no channel in the animation."""


@dataclass(frozen=True)
class Rig:
    """A skeleton, its motion at the keys of a loop, and the bones of every vertex."""

    skeleton: Skeleton
    motion: RigidMotion
    """Of the bones: displacement and rotation about their places at rest."""
    bones: Ints
    """(v, 4)"""
    weights: Floats
    """(v, 4)"""


def rigged(table: Table, rest_m: Floats, loop: Loop, most: int = MOST_BONES) -> Rig:
    """Bones at the nodes of the table, and weights fitted to the motion of the loop."""
    q = loop.keys()
    motion = node_motion(table, q)
    few = samples(motion)
    skeleton = choose_bones(table, few, most)
    of_bones = RigidMotion(few.moved_m[:, skeleton.node], few.rotation[:, skeleton.node])
    bones, weights = fitted_weights(table, rest_m, skeleton, of_bones, samples(joint_motion(table, q)))
    joint = joint_of_vertex(table)
    whole = RigidMotion(motion.moved_m[:, skeleton.node], motion.rotation[:, skeleton.node])
    return Rig(skeleton, whole, bones[joint], _normal(weights)[joint])


def _normal(weights: Floats) -> Floats:
    """Weights whose single-precision sums are 1."""
    rounded = np.round(weights * 65535) / 65535
    rounded[np.arange(len(rounded)), rounded.argmax(axis=1)] += 1.0 - rounded.sum(axis=1)
    return rounded


def skinned(rig: Rig, rest_m: Floats, frame: float) -> Floats:
    """(v, 3) vertices at a frame number below the last, by linear blend skinning, as glTF players do it.

    Players interpolate each bone's translation and rotation relative to its parent.
    """
    first, share = int(frame), frame - int(frame)
    local = local_motion(rig.skeleton, rig.motion)
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


def local_motion(skeleton: Skeleton, motion: RigidMotion) -> RigidMotion:
    """Translations (T, b, 3) and rotations (T, b, 4) of the bones relative to their parents."""
    where = skeleton.place_m + motion.moved_m
    above = np.maximum(skeleton.parent, 0)
    root = (skeleton.parent < 0)[None, :, None]
    back = motion.rotation[:, above] * np.array([-1.0, -1.0, -1.0, 1.0])
    place = np.where(root, where, rotated(back, where - where[:, above]))
    return RigidMotion(place, np.where(root, motion.rotation, _product(back, motion.rotation)))


def _global(skeleton: Skeleton, place: Floats, turn: Floats) -> tuple[Floats, Floats]:
    where, rotation = place.copy(), turn.copy()
    for bone, above in enumerate(skeleton.parent):
        if above >= 0:
            where[bone] = where[above] + rotated(rotation[above], place[bone])
            rotation[bone] = _product(rotation[above], turn[bone])
    return where, rotation


def _product(a: Floats, b: Floats) -> Floats:
    """Quaternions (…, 4) of the rotation b followed by a."""
    along, other = a[..., :3], b[..., :3]
    vector = a[..., 3:] * other + b[..., 3:] * along + np.cross(along, other)
    return np.concatenate(
        [vector, a[..., 3:] * b[..., 3:] - (along * other).sum(axis=-1, keepdims=True)], axis=-1
    )


def export_bones(
    table: Table, glb: bytes, loop: Loop, folder: Path, name: str, most: int = MOST_BONES
) -> dict[str, Any]:
    """Write the rigged GLB, wind.json for Unreal, and a description; return it. Raises ExportError."""
    file = GltfFile(glb, table)
    give_names(file.gltf, name)
    rest_m = file.rest_m()
    rig = rigged(table, rest_m, loop, most)
    description: dict[str, Any] = {
        "format": "galewood-bones",
        "version": 1,
        "mesh": f"{name}.glb",
        "bones": len(rig.skeleton.node),
        "animation": f"{name}_sway",
        **loop.about(table),
        "measured": _errors(table, rest_m, loop, rig) | seam(table, rest_m, loop),
    }
    _add_rig(file, rig, loop, name)
    file.note("galewood_bones", description)
    (folder / f"{name}.glb").write_bytes(file.glb())
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    groups = wind_groups(table, rig.skeleton, rig.motion)
    (folder / f"{name}.wind.json").write_text(json.dumps(groups, indent=2) + "\n")
    return description


def _errors(table: Table, rest_m: Floats, loop: Loop, rig: Rig) -> dict[str, float]:
    worst, squares = 0.0, 0.0
    moments = np.linspace(0.0, loop.frames, min(MEASURED_MOMENTS, 2 * loop.frames), endpoint=False)
    for frame in moments:
        exact = drawn_positions(table, rest_m, loop.q_at(frame * loop.seconds / loop.frames))
        apart = np.linalg.norm(skinned(rig, rest_m, float(frame)) - exact, axis=1)
        worst, squares = max(worst, float(apart.max())), squares + float(np.square(apart).mean())
    percent = 100 / float(table.metadata["height_m"])
    return {
        "error_percent_of_height": percent * worst,
        "rms_error_percent_of_height": percent * (squares / len(moments)) ** 0.5,
    }


def _add_rig(file: GltfFile, rig: Rig, loop: Loop, name: str) -> None:
    import pygltflib

    gltf, skeleton = file.gltf, rig.skeleton
    kind = np.uint8 if len(skeleton.node) <= 256 else np.uint16
    # glTF: a bone of weight 0 is 0
    file.add_attribute("JOINTS_0", np.where(rig.weights > 0, rig.bones, 0).astype(kind))
    file.add_attribute("WEIGHTS_0", rig.weights.astype(np.float32))
    first = len(gltf.nodes)
    local = local_motion(skeleton, rig.motion)
    rest = np.where(
        (skeleton.parent < 0)[:, None], skeleton.place_m, skeleton.place_m - skeleton.place_m[skeleton.parent]
    )
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
    animation = pygltflib.Animation(name=f"{name}_sway")
    gltf.animations.append(animation)
    _animate(file, animation, local, rest, first, loop.key_times_s())


def _animate(
    file: GltfFile,
    animation: pygltflib.Animation,
    local: RigidMotion,
    rest: Floats,
    first: int,
    times_s: Floats,
) -> None:
    """Add channels for the bones that move; ``first``: node of the first bone."""
    import pygltflib

    time = file.add_rows(times_s.astype(np.float32), bounds=True)
    still = np.array([0.0, 0.0, 0.0, 1.0])
    for bone in range(len(rest)):
        tracks = (
            ("translation", local.moved_m[:, bone], rest[bone]),
            ("rotation", local.rotation[:, bone], still),
        )
        for path, rows, at_rest in tracks:
            # an animation must have a channel, also in still air
            needed = bone == 0 and path == "translation"
            if np.abs(rows - at_rest).max() < STILL_TOLERANCE and not needed:
                continue
            output = file.add_rows(rows.astype(np.float32))
            animation.samplers.append(
                pygltflib.AnimationSampler(input=time, output=output, interpolation="LINEAR")
            )
            target = pygltflib.AnimationChannelTarget(node=first + bone, path=path)
            animation.channels.append(
                pygltflib.AnimationChannel(sampler=len(animation.samplers) - 1, target=target)
            )

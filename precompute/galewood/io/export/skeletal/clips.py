"""Clips: the motion of the bones of a skeleton in one wind each, as animations of a GLB."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from galewood.io.export.looped import Loop
from galewood.io.export.skeletal.joints import RigidMotion, node_motion, rotated
from galewood.io.export.skeletal.skeleton import Skeleton
from galewood.table import Table
from galewood.util import Floats

if TYPE_CHECKING:
    import pygltflib

    from galewood.io.export.gltf_file import GltfFile

STILL_TOLERANCE = 1e-6
"""A bone that moves less than this, m or in a quaternion, has no channel in the animation."""


@dataclass(frozen=True)
class Clip:
    """The motion of bones at the keys of a loop."""

    name: str
    loop: Loop
    motion: RigidMotion
    """Displacement and rotation of the bones about their places at rest."""


def clip_of(table: Table, skeleton: Skeleton, name: str, loop: Loop) -> Clip:
    """The motion of a skeleton in a loop."""
    nodes = node_motion(table, loop.keys())
    return Clip(name, loop, RigidMotion(nodes.moved_m[:, skeleton.node], nodes.rotation[:, skeleton.node]))


def local_motion(skeleton: Skeleton, motion: RigidMotion) -> RigidMotion:
    """Translations (T, b, 3) and rotations (T, b, 4) of the bones relative to their parents."""
    where = skeleton.place_m + motion.moved_m
    above = np.maximum(skeleton.parent, 0)
    root = (skeleton.parent < 0)[None, :, None]
    back = motion.rotation[:, above] * np.array([-1.0, -1.0, -1.0, 1.0])
    place = np.where(root, where, rotated(back, where - where[:, above]))
    return RigidMotion(place, np.where(root, motion.rotation, product(back, motion.rotation)))


def product(a: Floats, b: Floats) -> Floats:
    """Quaternions (…, 4) of the rotation b followed by a."""
    along, other = a[..., :3], b[..., :3]
    vector = a[..., 3:] * other + b[..., 3:] * along + np.cross(along, other)
    return np.concatenate(
        [vector, a[..., 3:] * b[..., 3:] - (along * other).sum(axis=-1, keepdims=True)], axis=-1
    )


def local_rest(skeleton: Skeleton) -> Floats:
    """(b, 3) places of the bones at rest relative to their parents, m."""
    root = (skeleton.parent < 0)[:, None]
    return np.where(root, skeleton.place_m, skeleton.place_m - skeleton.place_m[skeleton.parent])


def add_clip(file: GltfFile, skeleton: Skeleton, clip: Clip, first: int) -> None:
    """Add an animation with channels for the bones that move; ``first``: node of the first bone."""
    import pygltflib

    local, rest = local_motion(skeleton, clip.motion), local_rest(skeleton)
    animation = pygltflib.Animation(name=clip.name)
    file.gltf.animations.append(animation)
    time = file.add_rows(clip.loop.key_times_s().astype(np.float32), bounds=True)
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
            _add_channel(animation, time, file.add_rows(rows.astype(np.float32)), first + bone, path)


def _add_channel(animation: pygltflib.Animation, time: int, output: int, node: int, path: str) -> None:
    import pygltflib

    animation.samplers.append(pygltflib.AnimationSampler(input=time, output=output, interpolation="LINEAR"))
    target = pygltflib.AnimationChannelTarget(node=node, path=path)
    animation.channels.append(pygltflib.AnimationChannel(sampler=len(animation.samplers) - 1, target=target))

"""Writes an assembly into a stage.

Names of schemas and attributes are those that the importer of Unreal Engine 5.7 reads
(docs/how-to/exports.md says where they are from).
"""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.skeletal.bones import Rig
from galewood.io.export.skeletal.clips import local_motion, local_rest
from galewood.io.export.skeletal.joints import RigidMotion
from galewood.io.export.skeletal.skeleton import Skeleton
from galewood.io.export.skeletal.skinning import BONES_PER_VERTEX
from galewood.io.export.usd.alike import Copies
from galewood.io.export.usd.assembly import Assembly, Parts
from galewood.io.export.usd.geometry import Drawn, animate, bind_mesh, define_mesh, define_skeleton
from galewood.io.export.usd.library import usd_library
from galewood.util import Floats, Ints

ROOT_JOINT, PART_JOINT = "root", "part"
UNREAL_PREFIX = "unreal:naniteAssembly:"


def joint_paths(skeleton: Skeleton) -> list[str]:
    """Paths of the root joint and of the bones under it, as USD names joints."""
    found = [ROOT_JOINT]
    for name, parent in zip(skeleton.name, skeleton.parent, strict=True):
        found.append(f"{found[parent + 1]}/{name}")
    return found


def add_assembly(stage: Any, root: str, file: GltfFile, assembly: Assembly, materials: list[Any]) -> None:
    """Add the base, ROOT/base, and an instancer of the parts of each mesh, ROOT/parts_0 and so on."""
    pxr = usd_library()
    prim = stage.GetPrimAtPath(root)
    prim.AddAppliedSchema("NaniteAssemblyRootAPI")
    token, uniform = pxr.Sdf.ValueTypeNames.Token, pxr.Sdf.VariabilityUniform
    prim.CreateAttribute(f"{UNREAL_PREFIX}meshType", token, False, uniform).Set("skeletalMesh")
    skeleton = _add_base(stage, f"{root}/base", file, assembly, materials)
    prim.CreateRelationship(f"{UNREAL_PREFIX}skeleton", False).SetTargets([skeleton])
    for number, part in enumerate(assembly.parts):
        if part.copies:
            _add_parts(stage, f"{root}/parts_{number}", file, assembly, part, materials[part.mesh])


def _add_base(stage: Any, path: str, file: GltfFile, assembly: Assembly, materials: list[Any]) -> Any:
    """The skinned mesh of everything that is no part; returns the path of its skeleton."""
    pxr, rig = usd_library(), assembly.rig
    pxr.UsdSkel.Root.Define(stage, path)
    joints, zero = joint_paths(rig.skeleton), np.zeros((1, 3))
    place, local = rig.skeleton.place_m, local_rest(rig.skeleton)
    skeleton = define_skeleton(
        stage, f"{path}/skeleton", joints, np.concatenate([zero, place]), np.concatenate([zero, local])
    )
    skeleton.CreateJointNamesAttr([ROOT_JOINT, *rig.skeleton.name])
    animate(stage, skeleton, joints, _under_root(local_motion(rig.skeleton, assembly.clip.motion)))
    rest, normal, drawn = file.rest_m(), file.normals(), ~assembly.in_parts(len(rig.bones))
    start = 0
    for mesh, (count, faces, uv) in enumerate(
        zip(file.counts, file.faces(), file.texture_coordinates(), strict=True)
    ):
        mine, start = slice(start, start + count), start + count
        kept = drawn[mine]
        if kept.any():
            shown = Drawn(
                rest[mine][kept], normal[mine][kept], (np.cumsum(kept) - 1)[faces[kept[faces].all(axis=1)]],
                None if uv is None else uv[kept],
            )  # fmt: skip
            named = f"{path}/{pxr.Tf.MakeValidIdentifier(file.gltf.meshes[mesh].name)}"
            bound = define_mesh(stage, named, shown, materials[mesh])
            bind_mesh(bound, f"{path}/skeleton", rig.bones[mine][kept] + 1, rig.weights[mine][kept])
    return skeleton.GetPath()


def _under_root(local: RigidMotion) -> RigidMotion:
    """The motion of bones, and before them that of the root joint, which stands still."""
    frames = len(local.moved_m)
    still = np.tile([0.0, 0.0, 0.0, 1.0], (frames, 1, 1))
    return RigidMotion(
        np.concatenate([np.zeros((frames, 1, 3)), local.moved_m], axis=1),
        np.concatenate([still, local.rotation], axis=1),
    )


def _add_parts(stage: Any, path: str, file: GltfFile, assembly: Assembly, part: Parts, material: Any) -> None:
    """An instancer of the copies of one mesh, each bound to BONES_PER_VERTEX bones."""
    pxr, rig, uv = usd_library(), assembly.rig, file.texture_coordinates()[part.mesh]
    start = sum(file.counts[: part.mesh])
    instancer = pxr.UsdGeom.PointInstancer.Define(stage, path)
    pxr.UsdGeom.Scope.Define(stage, f"{path}/prototypes")
    for number, copies in enumerate(part.copies):
        of_first = None if uv is None else uv[copies.vertices[0] - start]
        shown = Drawn(copies.shape_m, _flat_normals(copies), copies.faces, of_first)
        _add_prototype(stage, f"{path}/prototypes/leaf_{number}", shown, material)
        instancer.GetPrototypesRel().AddTarget(f"{path}/prototypes/leaf_{number}")
    counts = [len(copies.place_m) for copies in part.copies]
    place, scale, turn = (
        np.concatenate([getattr(copies, field) for copies in part.copies])
        for field in ("place_m", "scale", "turn")
    )
    instancer.CreateProtoIndicesAttr(pxr.Vt.IntArray(np.repeat(np.arange(len(counts)), counts).tolist()))
    instancer.CreatePositionsAttr(pxr.Vt.Vec3fArray.FromNumpy(place.astype(np.float32)))
    instancer.CreateScalesAttr(
        pxr.Vt.Vec3fArray.FromNumpy(np.repeat(scale[:, None], 3, 1).astype(np.float32))
    )
    instancer.CreateOrientationsAttr(pxr.Vt.QuathArray([_half(pxr, matrix) for matrix in turn]))
    first = np.concatenate([copies.vertices[:, 0] for copies in part.copies])
    _bind_instances(instancer.GetPrim(), rig, first)


def _bind_instances(prim: Any, rig: Rig, vertex: Ints) -> None:
    """Bind instances to the bones of one vertex each (n,)."""
    pxr = usd_library()
    prim.AddAppliedSchema("NaniteAssemblySkelBindingAPI")
    weights = rig.weights[vertex]
    # an unused place repeats the most important bone, with weight 0
    main = rig.bones[vertex][np.arange(len(vertex)), weights.argmax(axis=1)]
    bones = np.where(weights > 0, rig.bones[vertex], main[:, None])
    types = pxr.Sdf.ValueTypeNames
    names = pxr.Vt.TokenArray([rig.skeleton.name[bone] for bone in bones.reshape(-1)])
    shares = pxr.Vt.FloatArray.FromNumpy(weights.reshape(-1).astype(np.float32))
    for use, kind, values in (
        ("bindJoints", types.TokenArray, names),
        ("bindJointWeights", types.FloatArray, shares),
    ):
        name = f"primvars:{UNREAL_PREFIX}{use}"
        prim.CreateAttribute(name, kind, False, pxr.Sdf.VariabilityUniform).Set(values)
        primvar = pxr.UsdGeom.Primvar(prim.GetAttribute(name))
        primvar.SetInterpolation(pxr.UsdGeom.Tokens.uniform)
        primvar.SetElementSize(BONES_PER_VERTEX)


def _add_prototype(stage: Any, path: str, shown: Drawn, material: Any) -> None:
    """A shape with a skeleton of one joint: the importer finds parts of skinned trees by their skeletons."""
    pxr, zero = usd_library(), np.zeros((1, 3))
    pxr.UsdSkel.Root.Define(stage, path)
    define_skeleton(stage, f"{path}/skeleton", [PART_JOINT], zero, zero)
    mesh, count = define_mesh(stage, f"{path}/mesh", shown, material), len(shown.rest_m)
    bind_mesh(mesh, f"{path}/skeleton", np.zeros((count, 1), np.int64), np.ones((count, 1)))


def _flat_normals(copies: Copies) -> Floats:
    """(k, 3) normals of the triangles around each vertex: those of the tree are not alike."""
    corner = copies.shape_m[copies.faces]
    across = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    total = np.zeros_like(copies.shape_m)
    for k in range(3):
        np.add.at(total, copies.faces[:, k], across)
    return total / np.maximum(np.linalg.norm(total, axis=1, keepdims=True), 1e-30)


def _half(pxr: Any, turn: Floats) -> Any:
    """A rotation (3, 3) as a quaternion of half floats."""
    quaternion = pxr.Gf.Matrix3d(*turn.T.ravel().tolist()).ExtractRotation().GetQuat()
    return pxr.Gf.Quath(quaternion)

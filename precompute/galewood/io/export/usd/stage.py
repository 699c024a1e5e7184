"""A USD file with an exact looping animation: UsdSkel, with the table's joints as bones.

Every vertex of a table moves rigidly with one joint, so a skeleton of these joints, each vertex bound to one
of them, is the motion of the table itself, at a tenth of the size of a cache of vertex positions. USD sets no
limit to the number of joints.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.gltf_names import give_names
from galewood.io.export.looped import Loop, seam
from galewood.io.export.skeletal.joints import RigidMotion, joint_motion, joint_of_vertex
from galewood.io.export.usd.library import usd_library
from galewood.io.export.usd.materials import add_materials
from galewood.solid.skinning import drawn_positions
from galewood.table import Table
from galewood.util import Floats


def export_usd(table: Table, glb: bytes, loop: Loop, folder: Path, name: str) -> dict[str, Any]:
    """Write NAME.usdc, its textures and a description; return it."""
    pxr = usd_library()
    file = GltfFile(glb, table)
    give_names(file.gltf, name)
    path = folder / f"{name}.usdc"
    stage = pxr.Usd.Stage.CreateNew(str(path))
    pxr.UsdGeom.SetStageUpAxis(stage, pxr.UsdGeom.Tokens.y)
    pxr.UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetTimeCodesPerSecond(loop.fps)
    stage.SetFramesPerSecond(loop.fps)
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(loop.frames)
    root = f"/{pxr.Tf.MakeValidIdentifier(name)}"
    stage.SetDefaultPrim(pxr.UsdSkel.Root.Define(stage, root).GetPrim())
    _add_skeleton(stage, root, table, joint_motion(table, loop.keys()))
    _add_meshes(stage, root, table, file, add_materials(stage, root, file, folder))
    stage.GetRootLayer().Save()
    rest_m = file.rest_m()
    description: dict[str, Any] = {
        "format": "galewood-usd",
        "version": 1,
        "stage": path.name,
        "joints": len(table.joint_share),
        **loop.about(table),
        "measured": {"error_percent_of_height": _error_percent(stage, table, rest_m, loop)}
        | seam(table, rest_m, loop),
    }
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    return description


def _add_skeleton(stage: Any, root: str, table: Table, motion: RigidMotion) -> None:
    pxr = usd_library()
    place = table.joint_rest_m.astype(np.float64)
    names = [f"joint_{index:04d}" for index in range(len(place))]
    rest = pxr.Vt.Matrix4dArray(
        [pxr.Gf.Matrix4d().SetTranslate(pxr.Gf.Vec3d(*row)) for row in place.tolist()]
    )
    skeleton = pxr.UsdSkel.Skeleton.Define(stage, f"{root}/skeleton")
    skeleton.CreateJointsAttr(names)
    skeleton.CreateBindTransformsAttr(rest)
    skeleton.CreateRestTransformsAttr(rest)
    animation = pxr.UsdSkel.Animation.Define(stage, f"{root}/skeleton/sway")
    animation.CreateJointsAttr(names)
    animation.CreateScalesAttr(pxr.Vt.Vec3hArray([pxr.Gf.Vec3h(1, 1, 1)] * len(names)))
    translations, rotations = animation.CreateTranslationsAttr(), animation.CreateRotationsAttr()
    for frame in range(len(motion.moved_m)):
        where = (place + motion.moved_m[frame]).astype(np.float32)
        translations.Set(pxr.Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(where)), frame)
        turn = motion.rotation[frame].astype(np.float32)
        rotations.Set(pxr.Vt.QuatfArray.FromNumpy(np.ascontiguousarray(turn)), frame)
    pxr.UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel().SetTargets(
        [animation.GetPrim().GetPath()]
    )


def _add_meshes(stage: Any, root: str, table: Table, file: GltfFile, materials: list[Any]) -> None:
    pxr = usd_library()
    identity, one = pxr.Gf.Matrix4d(1.0), np.float32(1.0)
    splits = np.cumsum(file.counts)[:-1]
    points, normals = (np.split(rows.astype(np.float32), splits) for rows in (file.rest_m(), file.normals()))
    joints = np.split(joint_of_vertex(table), splits)
    drawn = zip(file.faces(), points, normals, joints, file.texture_coordinates(), materials, strict=True)
    for index, (faces, rest, normal, joint, uv, material) in enumerate(drawn):
        part = pxr.Tf.MakeValidIdentifier(file.gltf.meshes[index].name)
        mesh = pxr.UsdGeom.Mesh.Define(stage, f"{root}/{part}")
        mesh.CreatePointsAttr(pxr.Vt.Vec3fArray.FromNumpy(rest))
        mesh.CreateFaceVertexCountsAttr(pxr.Vt.IntArray.FromNumpy(np.full(len(faces), 3, np.int32)))
        mesh.CreateFaceVertexIndicesAttr(pxr.Vt.IntArray.FromNumpy(faces.astype(np.int32).reshape(-1)))
        mesh.CreateNormalsAttr(pxr.Vt.Vec3fArray.FromNumpy(normal))
        mesh.SetNormalsInterpolation(pxr.UsdGeom.Tokens.vertex)
        mesh.CreateSubdivisionSchemeAttr(pxr.UsdGeom.Tokens.none)
        mesh.CreateDoubleSidedAttr(True)
        if uv is not None:
            upward = np.ascontiguousarray(uv * [1, -1] + [0, 1], np.float32)  # USD: v from the bottom
            primvars = pxr.UsdGeom.PrimvarsAPI(mesh)
            kind = pxr.Sdf.ValueTypeNames.TexCoord2fArray
            primvars.CreatePrimvar("st", kind, pxr.UsdGeom.Tokens.vertex).Set(
                pxr.Vt.Vec2fArray.FromNumpy(upward)
            )
        binding = pxr.UsdSkel.BindingAPI.Apply(mesh.GetPrim())
        binding.CreateSkeletonRel().SetTargets([pxr.Sdf.Path(f"{root}/skeleton")])
        numbers = pxr.Vt.IntArray.FromNumpy(joint.astype(np.int32))
        binding.CreateJointIndicesPrimvar(False, 1).Set(numbers)
        weights = pxr.Vt.FloatArray.FromNumpy(np.full(len(joint), one))
        binding.CreateJointWeightsPrimvar(False, 1).Set(weights)
        binding.CreateGeomBindTransformAttr().Set(identity)
        pxr.UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)


def posed(stage: Any, frame: float) -> Floats:
    """(v, 3) the vertices of all meshes at a time code, skinned by UsdSkel itself."""
    pxr = usd_library()
    cache, found = pxr.UsdSkel.Cache(), list[Floats]()
    root = stage.GetDefaultPrim()
    cache.Populate(pxr.UsdSkel.Root(root), pxr.Usd.PrimDefaultPredicate)
    for prim in root.GetChildren():
        if not prim.IsA(pxr.UsdGeom.Mesh):
            continue
        skin = cache.GetSkinningQuery(prim)
        skeleton = cache.GetSkelQuery(pxr.UsdSkel.Skeleton(root.GetChild("skeleton")))
        points = pxr.UsdGeom.Mesh(prim).GetPointsAttr().Get()
        skin.ComputeSkinnedPoints(skeleton.ComputeSkinningTransforms(frame), points, frame)
        found.append(np.array(points, np.float64))
    return np.concatenate(found)


def _error_percent(stage: Any, table: Table, rest_m: Floats, loop: Loop) -> float:
    worst = 0.0
    for frame in np.linspace(0.0, loop.frames, 24, endpoint=False):
        exact = drawn_positions(table, rest_m, loop.q_at(frame * loop.seconds / loop.frames))
        worst = max(worst, float(np.linalg.norm(posed(stage, float(frame)) - exact, axis=1).max()))
    return 100 * worst / float(table.metadata["height_m"])

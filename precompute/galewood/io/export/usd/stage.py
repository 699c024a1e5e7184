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
from galewood.io.export.options import ExportOptions
from galewood.io.export.skeletal.joints import RigidMotion, joint_motion, joint_of_vertex
from galewood.io.export.skeletal.wind_groups import wind_groups
from galewood.io.export.usd.assembly import assembly_error_percent, assembly_of
from galewood.io.export.usd.assembly_stage import add_assembly
from galewood.io.export.usd.geometry import Drawn, animate, bind_mesh, define_mesh, define_skeleton
from galewood.io.export.usd.library import usd_library
from galewood.io.export.usd.materials import add_materials
from galewood.solid.skinning import drawn_positions
from galewood.table import Table
from galewood.util import Floats


def export_usd(
    table: Table, glb: bytes, loop: Loop, folder: Path, name: str, options: ExportOptions
) -> dict[str, Any]:
    """Write NAME.usdc, its textures and a description; return it. Raises ExportError.

    With ``options.assembly`` the tree is one of parts, with NAME.wind.json beside it.
    """
    pxr = usd_library()
    file = GltfFile(glb, table)
    give_names(file.gltf, name)
    path, root = folder / f"{name}.usdc", f"/{pxr.Tf.MakeValidIdentifier(name)}"
    assembly = assembly_of(table, file, loop, name, options.bones) if options.assembly else None
    stage = pxr.Usd.Stage.CreateNew(str(path))
    pxr.UsdGeom.SetStageUpAxis(stage, pxr.UsdGeom.Tokens.y)
    pxr.UsdGeom.SetStageMetersPerUnit(stage, 1.0)
    stage.SetTimeCodesPerSecond(loop.fps)
    stage.SetFramesPerSecond(loop.fps)
    stage.SetStartTimeCode(0)
    stage.SetEndTimeCode(loop.frames)
    rest_m, kind = file.rest_m(), pxr.UsdGeom.Xform if assembly else pxr.UsdSkel.Root
    stage.SetDefaultPrim(kind.Define(stage, root).GetPrim())
    materials = add_materials(stage, root, file, folder)
    if assembly:
        add_assembly(stage, root, file, assembly, materials)
        motion = assembly.clip.motion
        about = {"bones": len(assembly.rig.skeleton.node), **assembly.about()}
        groups = wind_groups(table, assembly.rig.skeleton, motion)
        (folder / f"{name}.wind.json").write_text(json.dumps(groups, indent=2) + "\n")
        error_percent = assembly_error_percent(stage, root, table, rest_m, assembly)
    else:
        _add_skeleton(stage, root, table, joint_motion(table, loop.keys()))
        _add_meshes(stage, root, table, file, materials)
        about, error_percent = {"joints": len(table.joint_share)}, _error_percent(stage, table, rest_m, loop)
    stage.GetRootLayer().Save()
    description: dict[str, Any] = {
        "format": "galewood-usd",
        "version": 1,
        "stage": path.name,
        **about,
        **loop.about(table),
        "measured": {"error_percent_of_height": error_percent} | seam(table, rest_m, loop),
    }
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    return description


def _add_skeleton(stage: Any, root: str, table: Table, motion: RigidMotion) -> None:
    place = table.joint_rest_m.astype(np.float64)
    names = [f"joint_{index:04d}" for index in range(len(place))]
    skeleton = define_skeleton(stage, f"{root}/skeleton", names, place, place)
    animate(stage, skeleton, names, RigidMotion(place + motion.moved_m, motion.rotation))


def _add_meshes(stage: Any, root: str, table: Table, file: GltfFile, materials: list[Any]) -> None:
    pxr, splits = usd_library(), np.cumsum(file.counts)[:-1]
    points, normals = np.split(file.rest_m(), splits), np.split(file.normals(), splits)
    joints = np.split(joint_of_vertex(table), splits)
    drawn = zip(points, normals, file.faces(), file.texture_coordinates(), strict=True)
    for index, (rest, normal, faces, uv) in enumerate(drawn):
        part = pxr.Tf.MakeValidIdentifier(file.gltf.meshes[index].name)
        mesh = define_mesh(stage, f"{root}/{part}", Drawn(rest, normal, faces, uv), materials[index])
        joint = joints[index][:, None]
        bind_mesh(mesh, f"{root}/skeleton", joint, np.ones(joint.shape))


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

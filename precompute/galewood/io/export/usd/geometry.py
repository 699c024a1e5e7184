"""Meshes and skeletons of a USD stage."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.io.export.skeletal.joints import RigidMotion
from galewood.io.export.usd.library import usd_library
from galewood.util import Floats, Ints


@dataclass(frozen=True)
class Drawn:
    """Vertices (v, 3), m, their normals (v, 3), triangles (f, 3), and texture coordinates (v, 2), if any."""

    rest_m: Floats
    normal: Floats
    faces: Ints
    uv: npt.NDArray[np.floating[Any]] | None


def define_mesh(stage: Any, path: str, drawn: Drawn, material: Any) -> Any:
    """A mesh prim with a material. ``drawn.uv``: from the top of the picture, as in glTF."""
    pxr = usd_library()
    mesh = pxr.UsdGeom.Mesh.Define(stage, path)
    mesh.CreatePointsAttr(_vectors(drawn.rest_m))
    mesh.CreateFaceVertexCountsAttr(_integers(np.full(len(drawn.faces), 3)))
    mesh.CreateFaceVertexIndicesAttr(_integers(drawn.faces.reshape(-1)))
    mesh.CreateNormalsAttr(_vectors(drawn.normal))
    mesh.SetNormalsInterpolation(pxr.UsdGeom.Tokens.vertex)
    mesh.CreateSubdivisionSchemeAttr(pxr.UsdGeom.Tokens.none)
    mesh.CreateDoubleSidedAttr(True)
    if drawn.uv is not None:
        upward = np.ascontiguousarray(drawn.uv * [1, -1] + [0, 1], np.float32)  # USD: v from the bottom
        kind = pxr.Sdf.ValueTypeNames.TexCoord2fArray
        primvar = pxr.UsdGeom.PrimvarsAPI(mesh).CreatePrimvar("st", kind, pxr.UsdGeom.Tokens.vertex)
        primvar.Set(pxr.Vt.Vec2fArray.FromNumpy(upward))
    pxr.UsdShade.MaterialBindingAPI.Apply(mesh.GetPrim()).Bind(material)
    return mesh


def bind_mesh(mesh: Any, skeleton: str, joints: Ints, weights: Floats) -> None:
    """Bind the vertices of a mesh to joints (v, k) with weights (v, k)."""
    pxr, count = usd_library(), joints.shape[1]
    binding = pxr.UsdSkel.BindingAPI.Apply(mesh.GetPrim())
    binding.CreateSkeletonRel().SetTargets([pxr.Sdf.Path(skeleton)])
    binding.CreateJointIndicesPrimvar(False, count).Set(_integers(joints.reshape(-1)))
    flat = np.ascontiguousarray(weights.reshape(-1), np.float32)
    binding.CreateJointWeightsPrimvar(False, count).Set(pxr.Vt.FloatArray.FromNumpy(flat))
    binding.CreateGeomBindTransformAttr().Set(pxr.Gf.Matrix4d(1.0))


def define_skeleton(stage: Any, path: str, joints: Sequence[str], place_m: Floats, local_m: Floats) -> Any:
    """A skeleton at rest. ``joints``: paths; (b, 3) ``place_m`` in the tree, ``local_m`` under the parent."""
    pxr = usd_library()
    skeleton = pxr.UsdSkel.Skeleton.Define(stage, path)
    skeleton.CreateJointsAttr(joints)
    skeleton.CreateBindTransformsAttr(_moves(place_m))
    skeleton.CreateRestTransformsAttr(_moves(local_m))
    return skeleton


def animate(stage: Any, skeleton: Any, joints: Sequence[str], local: RigidMotion) -> None:
    """Give a skeleton the animation ``sway``. ``local``: places and rotations under the parent, by frame."""
    pxr = usd_library()
    animation = pxr.UsdSkel.Animation.Define(stage, f"{skeleton.GetPath()}/sway")
    animation.CreateJointsAttr(joints)
    animation.CreateScalesAttr(pxr.Vt.Vec3hArray([pxr.Gf.Vec3h(1, 1, 1)] * len(joints)))
    translations, rotations = animation.CreateTranslationsAttr(), animation.CreateRotationsAttr()
    for frame, (where, turn) in enumerate(zip(local.moved_m, local.rotation, strict=True)):
        translations.Set(_vectors(where), frame)
        found = pxr.Vt.QuatfArray.FromNumpy(np.ascontiguousarray(turn, np.float32))
        rotations.Set(found, frame)
    source = pxr.UsdSkel.BindingAPI.Apply(skeleton.GetPrim()).CreateAnimationSourceRel()
    source.SetTargets([animation.GetPrim().GetPath()])


def _moves(where_m: Floats) -> Any:
    pxr = usd_library()
    return pxr.Vt.Matrix4dArray(
        [pxr.Gf.Matrix4d().SetTranslate(pxr.Gf.Vec3d(*row)) for row in where_m.tolist()]
    )


def _vectors(rows: Floats) -> Any:
    return usd_library().Vt.Vec3fArray.FromNumpy(np.ascontiguousarray(rows, np.float32))


def _integers(values: Ints) -> Any:
    return usd_library().Vt.IntArray.FromNumpy(np.ascontiguousarray(values, np.int32))

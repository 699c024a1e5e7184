"""USD assemblies: read by OpenUSD, moved by its own skeletons, held against the table."""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.io.export import ExportError, ExportOptions, write_export
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.looped import looped
from galewood.io.export.usd.alike import FEWEST_COPIES, copies_of
from galewood.motion.wind import PRESETS
from galewood.solid.skinning import drawn_positions
from galewood.table import Table, decode
from scipy.spatial import KDTree
from scipy.spatial.transform import Rotation

Gf: Any
Usd: Any
UsdGeom: Any
UsdSkel: Any
Gf, Usd, UsdGeom, UsdSkel = (import_module(f"pxr.{name}") for name in ("Gf", "Usd", "UsdGeom", "UsdSkel"))
SHIPPED = Path(__file__).parents[4] / "assets/species/shipped/apricot-forest.table"
STORM = PRESETS["storm-front"]
SECONDS, FPS = 2.0, 12.0
OPTIONS = ExportOptions(wind=STORM, seconds=SECONDS, fps=FPS, assembly=True)
SEED = 4


@dataclass(frozen=True)
class Written:
    """An assembly, opened again."""

    folder: Path
    told: dict[str, Any]
    table: Table
    rest_m: Any
    stage: Any

    @property
    def skeleton(self) -> Any:
        return UsdSkel.Skeleton(self.stage.GetPrimAtPath("/oak/base/skeleton"))

    @property
    def instancers(self) -> list[Any]:
        prims = self.stage.GetDefaultPrim().GetChildren()
        return [UsdGeom.PointInstancer(prim) for prim in prims if prim.IsA(UsdGeom.PointInstancer)]


@pytest.fixture(scope="module")
def written(tmp_path_factory: pytest.TempPathFactory) -> Written:
    folder = tmp_path_factory.mktemp("assembly")
    table, glb = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    told = write_export(table, glb, "usd", folder, "oak", OPTIONS)
    return Written(
        folder, told, table, GltfFile(glb, table).rest_m(), Usd.Stage.Open(str(folder / "oak.usdc"))
    )


def schemas(prim: Any) -> list[str]:
    """Applied schemas, those that this OpenUSD does not know too."""
    return list(prim.GetMetadata("apiSchemas").GetAppliedItems())


def test_the_root_says_that_it_is_an_assembly_on_a_skeleton(written: Written) -> None:
    root = written.stage.GetDefaultPrim()
    assert (root.GetName(), root.GetTypeName()) == ("oak", "Xform")
    assert schemas(root) == ["NaniteAssemblyRootAPI"]
    kind = root.GetAttribute("unreal:naniteAssembly:meshType")
    assert (kind.GetTypeName(), kind.GetVariability(), kind.Get()) == ("token", 1, "skeletalMesh")
    (target,) = root.GetRelationship("unreal:naniteAssembly:skeleton").GetTargets()
    assert target == written.skeleton.GetPath()
    skel_root = UsdSkel.Root.Find(written.skeleton.GetPrim()).GetPrim()
    assert skel_root.GetPath().HasPrefix(root.GetPath()) and skel_root != root
    drawn = [UsdGeom.Mesh(prim) for prim in skel_root.GetChildren() if prim.IsA(UsdGeom.Mesh)]
    assert all(len(mesh.GetPointsAttr().Get()) > 0 for mesh in drawn) and drawn
    assert UsdGeom.GetStageUpAxis(written.stage) == "Y"
    assert UsdGeom.GetStageMetersPerUnit(written.stage) == 1.0


def test_the_joints_hang_on_one_root_and_have_the_names_of_wind_json(written: Written) -> None:
    paths = list(written.skeleton.GetJointsAttr().Get())
    names = list(written.skeleton.GetJointNamesAttr().Get())
    assert names == [path.rpartition("/")[2] for path in paths]
    assert len(set(names)) == len(names) == written.told["bones"] + 1
    for place, path in enumerate(paths[1:], 1):
        assert path.rpartition("/")[0] in paths[:place]
    document = json.loads((written.folder / "oak.wind.json").read_text())
    assert [joint["JointName"] for joint in document["Joints"]] == names[1:]


def test_every_instance_is_bound_to_joints_of_the_skeleton(written: Written) -> None:
    names = set(written.skeleton.GetJointNamesAttr().Get())
    instances = shapes = 0
    for instancer in written.instancers:
        prim, count = instancer.GetPrim(), len(instancer.GetProtoIndicesAttr().Get())
        assert schemas(prim) == ["NaniteAssemblySkelBindingAPI"]
        primvars = UsdGeom.PrimvarsAPI(prim)
        joints, weights = (
            primvars.GetPrimvar(f"unreal:naniteAssembly:{use}") for use in ("bindJoints", "bindJointWeights")
        )
        assert (joints.GetTypeName(), weights.GetTypeName()) == ("token[]", "float[]")
        assert joints.GetAttr().GetVariability() == weights.GetAttr().GetVariability() == 1  # uniform
        size = joints.GetElementSize()
        assert len(joints.Get()) == len(weights.Get()) == size * count
        assert set(joints.Get()) <= names
        assert np.allclose(np.array(weights.Get()).reshape(count, size).sum(axis=1), 1, atol=1e-6)
        targets = instancer.GetPrototypesRel().GetTargets()
        assert sorted(set(instancer.GetProtoIndicesAttr().Get())) == list(range(len(targets)))
        for target in targets:
            below = [prim.GetTypeName() for prim in Usd.PrimRange(written.stage.GetPrimAtPath(target))]
            assert below == ["SkelRoot", "Skeleton", "Mesh"]
        instances, shapes = instances + count, shapes + len(targets)
    assert (written.told["instances"], written.told["shapes"]) == (instances, shapes)
    assert instances > 100 * shapes


@pytest.mark.parametrize("frame", [0.0, 5.0, 13.5])
def test_parts_and_base_move_as_the_table_draws_the_tree(written: Written, frame: float) -> None:
    """A part moves by the blended transforms of its joints; vertices are found by their places at rest."""
    cache = UsdSkel.Cache()
    base = UsdSkel.Root(written.stage.GetPrimAtPath("/oak/base"))
    cache.Populate(base, Usd.PrimDefaultPredicate)
    query = cache.GetSkelQuery(written.skeleton)
    names = list(written.skeleton.GetJointNamesAttr().Get())
    moves = np.array(query.ComputeSkinningTransforms(frame))
    rest, moved = list[Any](), list[Any]()
    for prim in base.GetPrim().GetChildren():
        if prim.IsA(UsdGeom.Mesh):
            points = UsdGeom.Mesh(prim).GetPointsAttr().Get()
            rest.append(np.array(points, np.float64))
            cache.GetSkinningQuery(prim).ComputeSkinnedPoints(
                query.ComputeSkinningTransforms(frame), points, frame
            )
            moved.append(np.array(points, np.float64))
    for instancer in written.instancers:
        places = np.array(instancer.ComputeInstanceTransformsAtTime(0, 0))
        primvars = UsdGeom.PrimvarsAPI(instancer.GetPrim())
        joints, weights = (
            primvars.GetPrimvar(f"unreal:naniteAssembly:{use}") for use in ("bindJoints", "bindJointWeights")
        )
        size = joints.GetElementSize()
        used = np.array([names.index(name) for name in joints.Get()]).reshape(-1, size)
        shares = np.array(weights.Get(), np.float64).reshape(-1, size)
        blended = np.einsum("nk,nkab->nab", shares, moves[used])
        targets = instancer.GetPrototypesRel().GetTargets()
        shapes = [
            np.array(UsdGeom.Mesh(written.stage.GetPrimAtPath(f"{target}/mesh")).GetPointsAttr().Get())
            for target in targets
        ]
        for number, which in enumerate(instancer.GetProtoIndicesAttr().Get()):
            at = np.c_[shapes[which], np.ones(len(shapes[which]))] @ places[number]
            rest.append(at[:, :3])
            moved.append((at @ blended[number])[:, :3])
    at_rest, found = np.concatenate(rest), np.concatenate(moved)
    assert len(at_rest) == len(written.rest_m)
    away, vertex = KDTree(written.rest_m).query(at_rest)
    percent = 100 / float(written.table.metadata["height_m"])
    assert percent * away.max() < 0.01
    loop = looped(written.table, STORM, SECONDS, FPS)
    exact = drawn_positions(written.table, written.rest_m, loop.q_at(frame / loop.fps))
    off = percent * np.linalg.norm(found - exact[vertex], axis=1).max()
    print(f"frame {frame}: {off:.3f} %")
    assert off < 0.3  # with 12 frames per second
    assert off < 1.5 * written.told["measured"]["error_percent_of_height"] + 0.02
    assert percent * np.linalg.norm(exact - written.rest_m, axis=1).max() > 10


def test_openusd_finds_no_fault(written: Written, tmp_path: Path) -> None:
    assert faults(written.stage) == []
    broken = Usd.Stage.Open(written.stage.Flatten())
    broken.ClearDefaultPrim()
    assert faults(broken)


def faults(stage: Any) -> list[str]:
    """What all validators of OpenUSD say, those of usdchecker among them."""
    validation: Any = import_module("pxr.UsdValidation")
    validators = validation.ValidationRegistry().GetOrLoadAllValidators()
    assert len(validators) > 10
    found = validation.ValidationContext(validators).Validate(stage)
    return [f"{error.GetName()}: {error.GetMessage()}" for error in found]


def test_leaves_that_are_moved_turned_and_scaled_are_copies() -> None:
    print(f"seed {SEED}")
    rng = np.random.default_rng(SEED)
    shape, faces = rng.normal(size=(5, 3)), np.array([[0, 1, 2], [0, 2, 3], [2, 3, 4]])
    turns = Rotation.random(30, rng=rng).as_matrix()
    scales, places = rng.uniform(0.5, 2, 30), rng.uniform(-5, 5, (30, 3))
    leaves = scales[:, None, None] * shape @ turns.transpose(0, 2, 1) + places[:, None]
    leaves[3] += rng.normal(size=(5, 3)) * 0.1  # another shape
    leaves[4] = leaves[4] * [-1, 1, 1]  # a mirror image is no copy
    odd = 3 + 2 * FEWEST_COPIES
    uv = rng.uniform(size=(5, 2)) + np.zeros((30, 1, 1))
    uv[odd:] += 0.25  # leaves with another picture
    numbers = 5 * np.arange(30)[:, None, None] + faces
    order = rng.permutation(30)
    found = copies_of(leaves.reshape(-1, 3), numbers[order].reshape(-1, 3), uv.reshape(-1, 2))
    kept = [sorted(copies.vertices[:, 0] // 5) for copies in found]
    assert kept == [[k for k in range(odd) if k not in (3, 4)], list(range(odd, 30))]
    for copies in found:
        again = copies.scale[:, None, None] * copies.shape_m @ copies.turn.transpose(0, 2, 1)
        assert np.abs(again + copies.place_m[:, None] - leaves.reshape(-1, 3)[copies.vertices]).max() < 1e-12
        assert np.allclose(np.linalg.det(copies.turn), 1)
        assert np.array_equal(copies.faces, faces)
    assert copies_of(leaves[:3].reshape(-1, 3), numbers[:3].reshape(-1, 3), None) == []


def test_what_cannot_be_an_assembly_is_said(tmp_path: Path) -> None:
    table, glb = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    with pytest.raises(ExportError, match="option of usd"):
        write_export(table, glb, "bones", tmp_path, "oak", OPTIONS)
    bare = decode(SHIPPED.with_suffix(".bare.table").read_bytes())
    with pytest.raises(ExportError, match="leaves of the same shape"):
        write_export(bare, glb, "usd", tmp_path, "oak", OPTIONS)
    assert not list(tmp_path.iterdir())

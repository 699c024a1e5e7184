"""Exports: every kind is read again by another program and held against the table's own motion."""

from __future__ import annotations

import json
import shutil
import struct
import subprocess
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import galewood
import numpy as np
import pygltflib
import pytest
import trimesh
from galewood.io.cli.commands import app
from galewood.io.export import KINDS, RIGID_KINDS, ExportError, ExportOptions, archive, write_export
from galewood.io.export.looped import Loop, looped
from galewood.io.export.pivots import packed_index, unpacked_index
from galewood.motion.wind import Wind, WindField
from galewood.player import WindDrivenTrees, periodic_motion
from galewood.solid.skinning import drawn_positions
from galewood.table import Table, decode
from PIL import Image
from pydantic import ValidationError
from typer.testing import CliRunner

from tests.golden import GOLDEN_FOLDER
from tests.precompute.fixtures.gltf_reading import Glb

REPOSITORY = Path(__file__).parents[3]
SHIPPED = REPOSITORY / "assets/species/shipped/apricot-forest.table"
GOLDEN = GOLDEN_FOLDER / "pole.safetensors"
VALIDATOR = REPOSITORY / "node_modules/gltf-validator"
WIND = Wind(mean_speed_m_s=9.0, gustiness=0.7, seed=3)
OPTIONS = ExportOptions(wind=WIND, seconds=2.0, fps=12.0)
LOOPED = tuple(kind for kind in KINDS if kind not in ("impostor", *RIGID_KINDS))
ERROR, SEAM = 0.1, 0.05  # % of the height


@dataclass(frozen=True)
class Exports:
    """Every kind of export of one tree, each in the folder of its name, and PNG textures in "vat-png"."""

    folder: Path
    table: Table
    rest_m: Any
    loop: Loop
    told: dict[str, dict[str, Any]]

    def drawn(self, time_s: float) -> Any:
        """(v, 3) what the table itself draws at a time of the loop."""
        return drawn_positions(self.table, self.rest_m, self.loop.q_at(time_s))

    def percent(self, positions: Any, time_s: float) -> float:
        apart = np.linalg.norm(positions - self.drawn(time_s), axis=1).max()
        return 100 * float(apart) / float(self.table.metadata["height_m"])

    def moments(self, count: int) -> Any:
        """Times of the loop, at frames and between them."""
        return np.linspace(0.0, self.loop.seconds, count, endpoint=False)


@pytest.fixture(scope="module")
def exports(tmp_path_factory: pytest.TempPathFactory) -> Exports:
    folder = tmp_path_factory.mktemp("exports")
    table, glb = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    told = {kind: write_export(table, glb, kind, folder / kind, "tree", OPTIONS) for kind in LOOPED}
    png = OPTIONS.model_copy(update={"format": "png"})
    told["vat-png"] = write_export(table, glb, "vat", folder / "vat-png", "tree", png)
    rest = np.concatenate(
        [rows.astype(np.float64) for rows in [Glb(folder / "vat/tree.glb").attribute("POSITION")]]
    )
    return Exports(folder, table, rest, looped(table, WIND, OPTIONS.seconds, OPTIONS.fps), told)


def test_a_motion_that_repeats_has_no_seam(exports: Exports) -> None:
    loop = exports.loop
    steps = np.linalg.norm(np.diff(loop.steps, axis=0), axis=1)
    across = np.linalg.norm(loop.steps[0] - loop.steps[-1])
    assert across < 1.5 * steps.max()
    end = drawn_positions(exports.table, exports.rest_m, loop.after)
    assert exports.percent(end, 0.0) < SEAM
    sway = np.linalg.norm(exports.drawn(0.7) - exports.drawn(0.2), axis=1).max()
    assert sway > 0.005 * float(exports.table.metadata["height_m"])


def test_in_a_steady_wind_the_repeated_motion_is_where_the_player_comes_to_rest() -> None:
    table = decode(GOLDEN.read_bytes())
    wind = Wind(mean_speed_m_s=6.0, gustiness=0.0, heading_swing_deg=0.0)
    motion = periodic_motion(table, wind, 2.0)
    tree, field = WindDrivenTrees(table, [[0.0, 0.0, 0.0, 1.0]]), WindField(wind)
    for k in range(1200):
        tree.step(field, motion.dt_s * (k + 1), motion.dt_s)
    places = 2 * len(table.modal_place)
    assert places and np.abs(motion.q - tree.q[0]).max() < 1e-3 * np.abs(tree.q[0]).max()


@pytest.mark.parametrize("kind", ["vat", "vat-png"])
def test_the_textures_hold_the_motion_of_the_table(exports: Exports, kind: str) -> None:
    folder, about = exports.folder / kind, exports.told[kind]
    maps = {use: texture(folder, one) for use, one in about["textures"].items()}
    uv = Glb(folder / "tree.glb").attribute("TEXCOORD_1").astype(np.float64)
    column = np.floor(uv[:, 0] * about["width"]).astype(int)
    row = np.floor(uv[:, 1] * about["height"]).astype(int)
    assert maps["offset"].shape == (about["height"], about["width"], 3)
    worst = 0.0
    for time_s in exports.moments(31):
        at = time_s * about["fps"]
        first, share = int(at), at - int(at)
        a, b = (row + (first + k) % about["frames"] * about["rows_per_frame"] for k in (0, 1))
        moved, turn = (
            (1 - share) * maps[use][a, column] + share * maps[use][b, column]
            for use in ("offset", "rotation")
        )
        w = np.sqrt(1.0 - np.square(turn).sum(axis=1, keepdims=True))
        arm = exports.rest_m - maps["pivot"][row, column]
        turned = arm + 2 * np.cross(turn, np.cross(turn, arm) + w * arm)
        worst = max(worst, exports.percent(maps["pivot"][row, column] + moved + turned, float(time_s)))
    assert worst < ERROR
    assert about["measured"]["error_percent_of_height"] == pytest.approx(worst, rel=0.5)
    assert about["measured"]["seam_percent_of_height"] < SEAM


def texture(folder: Path, about: dict[str, Any]) -> Any:
    """A texture read by OpenEXR or by VTK."""
    path = folder / about["file"]
    if path.suffix == ".exr":
        import OpenEXR

        return OpenEXR.File(str(path)).channels()["RGB"].pixels.astype(np.float64)
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkIOImage import vtkPNGReader

    reader = vtkPNGReader()
    reader.SetFileName(str(path))
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    texels = vtk_to_numpy(image.GetPointData().GetScalars())
    assert texels.dtype == np.uint16
    values = texels.reshape(height, width, 3)[::-1] / 65535  # VTK begins at the bottom
    low, high = np.array(about["low"]), np.array(about["high"])
    return low + values * (high - low)


def test_the_bounds_hold_every_vertex_of_the_loop(exports: Exports) -> None:
    bounds = exports.told["vat"]["bounds_m"]
    for time_s in exports.moments(12):
        drawn = exports.drawn(float(time_s))
        assert (drawn >= bounds["low"]).all()
        assert (drawn <= bounds["high"]).all()


@pytest.mark.parametrize("kind", ["vat", "vat-png"])
def test_the_decoders_have_the_numbers_of_the_export(exports: Exports, kind: str) -> None:
    for name in ("tree.gdshader", "tree.hlsl", "galewoodVat.js"):
        text = (exports.folder / kind / name).read_text()
        assert "@" not in text
    assert (
        f"frames = {exports.told[kind]['frames']}.0" in (exports.folder / kind / "tree.gdshader").read_text()
    )


def test_the_skeleton_moves_the_vertices_as_the_table_does(exports: Exports) -> None:
    glb, measured = Glb(exports.folder / "bones/tree.glb"), exports.told["bones"]["measured"]
    weights = glb.attribute("WEIGHTS_0")
    assert weights.shape[1] == 4
    assert np.abs(weights.sum(axis=1) - 1).max() < 1e-6
    worst = max(exports.percent(glb.skinned(float(time_s)), float(time_s)) for time_s in exports.moments(16))
    assert worst < 2 * ERROR
    assert measured["error_percent_of_height"] == pytest.approx(worst, rel=0.5)
    closed = np.abs(glb.skinned(0.0) - glb.skinned(exports.loop.seconds)).max()
    assert closed < 1e-5


def test_a_small_skeleton_keeps_the_sway(exports: Exports, tmp_path: Path) -> None:
    few = OPTIONS.model_copy(update={"bones": 24})
    mesh = SHIPPED.with_suffix(".glb").read_bytes()
    told = write_export(exports.table, mesh, "bones", tmp_path, "tree", few)
    assert told["bones"] == 24
    sway = max(exports.percent(exports.rest_m, float(time_s)) for time_s in exports.moments(12))
    worst = max(
        exports.percent(Glb(tmp_path / "tree.glb").skinned(float(time_s)), float(time_s))
        for time_s in exports.moments(5)
    )
    assert worst < 0.15 * sway


def test_unreals_wind_document_names_the_bones(exports: Exports) -> None:
    document = json.loads((exports.folder / "bones/tree.wind.json").read_text())
    glb = Glb(exports.folder / "bones/tree.glb").document
    bones = [glb["nodes"][joint]["name"] for joint in glb["skins"][0]["joints"]]
    assert [joint["JointName"] for joint in document["Joints"]] == bones
    groups = document["SimulationGroups"]
    assert {joint["SimulationGroupIndex"] for joint in document["Joints"]} == set(range(len(groups)))
    assert [group["bIsTrunkGroup"] for group in groups] == [True] + [False] * (len(groups) - 1)


def test_the_pivot_textures_hold_a_hierarchy_of_four_levels(exports: Exports) -> None:
    import OpenEXR

    folder, about = exports.folder / "pivots", exports.told["pivots"]
    pixels = OpenEXR.File(str(folder / about["textures"]["position_index"])).channels()["RGBA"].pixels
    assert pixels.dtype == np.float16
    parent = unpacked_index(np.ascontiguousarray(pixels.reshape(-1, 4)[: about["parts"], 3]))
    for part in range(about["parts"]):
        steps = 0
        while parent[part] != part:
            part, steps = int(parent[part]), steps + 1
        assert part == 0
        assert steps < 4
    uv = Glb(folder / "tree.glb").attribute("TEXCOORD_1")
    texel = (uv * [about["width"], about["height"]]).astype(int)
    part = texel[:, 1] * about["width"] + texel[:, 0]
    pivot_cm = pixels.reshape(-1, 4)[part, :3].astype(np.float64)
    unreal_cm = 100 * exports.rest_m[:, [0, 2, 1]]
    axis = Image.open(folder / about["textures"]["axis_extent"])
    values = np.array(axis).reshape(-1, 4)[part] / 255
    reach = np.linalg.norm(unreal_cm - pivot_cm, axis=1)
    # 16-bit pivots of a tree of 12 m are rounded to 0.5 cm, extents to 8 cm
    assert (reach <= 2048 * values[:, 3] + 9).all()
    direction = 2 * values[:, :3] - 1
    assert np.abs(np.linalg.norm(direction, axis=1) - 1).max() < 0.01
    for one in np.unique(part):
        mine = np.flatnonzero(part == one)
        # the rounding of the pivots hides which of several about as far is the farthest
        farthest = mine[reach[mine] > reach[mine].max() - 2]
        along = ((unreal_cm - pivot_cm)[farthest] * direction[farthest]).sum(axis=1)
        assert along.max() > 0.97 * reach[farthest].max() - 1


def test_parent_indices_are_packed_as_unreal_unpacks_them() -> None:
    index = np.arange(30_000)
    packed = packed_index(index)
    assert np.isfinite(packed).all()
    assert np.array_equal(unpacked_index(packed), index)
    for one in (0, 1, 1023, 1024, 29_999):
        # sign, exponent and mantissa of the half moved to those of a float, as the tool's reference has it
        bits = one + 1024
        single = (bits >> 10 & 0x1F) - 15 + 127 << 23 | (bits & 0x3FF) << 13
        assert struct.unpack("<f", struct.pack("<I", single))[0] == float(packed[one])


def test_usd_bakes_the_motion_of_the_table(exports: Exports) -> None:
    modules: list[Any] = [import_module(f"pxr.{name}") for name in ("Gf", "Usd", "UsdGeom", "UsdSkel")]
    Gf, Usd, UsdGeom, UsdSkel = modules
    stage = Usd.Stage.Open(str(exports.folder / "usd/tree.usdc"))
    assert UsdGeom.GetStageMetersPerUnit(stage) == 1.0
    assert stage.GetTimeCodesPerSecond() == pytest.approx(exports.loop.fps)
    frame = 5
    root = UsdSkel.Root(stage.GetDefaultPrim())
    assert UsdSkel.BakeSkinning(root, Gf.Interval(frame, frame))
    meshes = [UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh)]
    points = np.concatenate([np.array(mesh.GetPointsAttr().Get(frame), np.float64) for mesh in meshes])
    assert exports.percent(points, frame / exports.loop.fps) < ERROR
    assert exports.told["usd"]["measured"]["error_percent_of_height"] < ERROR
    assert all(
        path.suffix in (".usdc", ".png", ".jpg", ".json") for path in (exports.folder / "usd").iterdir()
    )


def test_usd_has_all_pictures_of_the_mesh(exports: Exports, tmp_path: Path) -> None:
    """Those of glTF: base colour, normals, and roughness, metal and occlusion in one picture."""
    modules: list[Any] = [import_module(f"pxr.{name}") for name in ("Usd", "UsdShade")]
    Usd, UsdShade = modules
    gltf = pygltflib.GLTF2.load_from_bytes(SHIPPED.with_suffix(".glb").read_bytes())
    assert gltf is not None
    wood = gltf.materials[0]
    assert wood.pbrMetallicRoughness and wood.normalTexture
    # the picture of normals stands for that of roughness too: which one it is does not matter here
    shown = int(wood.normalTexture.index or 0)
    wood.pbrMetallicRoughness.metallicRoughnessTexture = pygltflib.TextureInfo(index=shown)
    wood.pbrMetallicRoughness.roughnessFactor = 0.5
    wood.occlusionTexture = pygltflib.OcclusionTextureInfo(index=shown, strength=0.25)
    wood.normalTexture.scale = 2.0
    options = ExportOptions(seconds=1.0, fps=5.0)
    write_export(exports.table, b"".join(gltf.save_to_bytes()), "usd", tmp_path, "oak-4", options)
    stage = Usd.Stage.Open(str(tmp_path / "oak-4.usdc"))
    assert str(stage.GetDefaultPrim().GetPath()) == "/oak_4"
    shader = UsdShade.Shader(stage.GetPrimAtPath("/oak_4/materials/oak_4_wood/surface"))
    found = dict[str, Any]()
    for use in ("diffuseColor", "roughness", "metallic", "occlusion", "normal"):
        source, channel, _ = shader.GetInput(use).GetConnectedSource()
        reader = UsdShade.Shader(source.GetPrim())
        values = [reader.GetInput(name).Get() for name in ("file", "scale", "bias")]
        assert (tmp_path / values[0].path).is_file()
        found[use] = (channel, *(tuple(value) for value in values[1:]))
    assert found["diffuseColor"] == ("rgb", (1, 1, 1, 1), (0, 0, 0, 0))
    assert found["roughness"] == ("g", (0.5,) * 4, (0, 0, 0, 0))
    assert found["metallic"] == ("b", (0,) * 4, (0, 0, 0, 0))
    assert found["occlusion"] == ("r", (0.25,) * 4, (0.75,) * 4)
    assert found["normal"] == ("rgb", (4, 4, 2, 1), (-2, -2, -1, 0))


@pytest.mark.parametrize(
    ("kind", "module", "says"),
    [
        ("usd", "pxr", "usd-core: pip install 'galewood[usd]'"),
        ("vat", "OpenEXR", "pip install 'openexr'"),
        ("pivots", "OpenEXR", "pip install 'openexr'"),
    ],
)
def test_a_missing_package_is_noticed_before_any_work(
    exports: Exports, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kind: str, module: str, says: str
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    reports = list[str]()
    asked = ExportOptions(format="png") if kind == "pivots" else ExportOptions()
    with pytest.raises(ExportError) as raised:
        write_export(
            exports.table, b"", kind, tmp_path / "out", "tree", asked, lambda _, text: reports.append(text)
        )
    assert says in str(raised.value)
    assert reports == []
    assert not (tmp_path / "out").exists()


def test_the_command_prints_the_square_brackets_of_what_to_install(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pxr", None)
    result = CliRunner().invoke(app, ["export", str(SHIPPED), "--to", "usd", "--out", str(tmp_path / "out")])
    assert result.exit_code == 1
    assert "pip install 'galewood[usd]'" in result.output


def test_the_public_function_takes_the_options_as_keywords(exports: Exports, tmp_path: Path) -> None:
    table = galewood.MotionTable(SHIPPED.read_bytes(), SHIPPED.with_suffix(".glb").read_bytes())
    told = galewood.export_tree(table, to="glb", out=tmp_path, wind=WIND, seconds=2.0, fps=12.0)
    assert told == exports.told["glb"]
    assert (tmp_path / "tree.glb").read_bytes() == (exports.folder / "glb" / "tree.glb").read_bytes()
    with pytest.raises(ValidationError, match="frames"):
        galewood.export_tree(table, to="glb", out=tmp_path, frames=3)  # type: ignore[call-arg]


def test_trimesh_reads_the_meshes(exports: Exports) -> None:
    rest: Any = trimesh.load(SHIPPED.with_suffix(".glb"), force="mesh")
    for kind in ("vat", "bones", "pivots", "glb"):
        read: Any = trimesh.load(exports.folder / kind / "tree.glb", force="mesh")
        assert np.allclose(read.bounds, rest.bounds, atol=1e-5)
        assert len(read.faces) == len(rest.faces)


@pytest.mark.skipif(
    not VALIDATOR.exists() or not shutil.which("node"), reason="needs the page's node_modules"
)
def test_the_khronos_validator_finds_no_error(exports: Exports) -> None:
    still = exports.folder / "still" / "tree.glb"
    calm = ExportOptions(wind=Wind(mean_speed_m_s=0.0), seconds=1.0, fps=5.0)
    write_export(exports.table, SHIPPED.with_suffix(".glb").read_bytes(), "bones", still.parent, "tree", calm)
    files = sorted(exports.folder.glob("*/*.glb"))
    assert len(files) == 8
    assert [report for report in validated(files) if report["broken"]] == []


def validated(files: Sequence[Path]) -> list[dict[str, Any]]:
    """What the Khronos validator says about files: errors, and how many."""
    script = """
    const { readFileSync } = require("node:fs");
    const { validateBytes } = require(process.argv[1]);
    (async () => {
      for (const file of process.argv.slice(2)) {
        const { issues } = await validateBytes(new Uint8Array(readFileSync(file)));
        const errors = issues.messages.filter((one) => one.severity === 0);
        console.log(JSON.stringify({ file, errors, broken: issues.numErrors }));
      }
    })();
    """
    asked = ["node", "-e", script, str(VALIDATOR), *map(str, files)]
    done = subprocess.run(asked, capture_output=True, text=True, check=True)
    reports = [json.loads(line) for line in done.stdout.splitlines()]
    assert len(reports) == len(files)
    return reports


@pytest.mark.parametrize("kind", LOOPED)
def test_still_air_can_be_exported(tmp_path: Path, kind: str) -> None:
    """Nothing moves: no range to scale by, no channel to animate."""
    table, glb = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    still = ExportOptions(wind=Wind(mean_speed_m_s=0.0), seconds=1.0, fps=5.0, format="png")
    told = write_export(table, glb, kind, tmp_path, "tree", still)
    measured = told.get("measured", {})
    assert all(abs(percent) < 0.01 for percent in measured.values())
    if kind in ("bones", "glb"):
        animation = Glb(tmp_path / "tree.glb").document["animations"][0]
        assert animation["channels"]


@pytest.mark.parametrize("kind", LOOPED)
def test_all_kinds_take_the_same_options_and_say_the_same(exports: Exports, kind: str) -> None:
    told = exports.told[kind].get("rigged", exports.told[kind])
    wind = told["clips"][0]["wind"] if "clips" in told else told["wind"]
    assert told["loop"]
    assert told["seconds"] == pytest.approx(OPTIONS.seconds, abs=0.04)
    assert told["frames"] == 24
    assert wind == WIND.document()
    assert (exports.folder / kind / "tree.json").is_file()


@pytest.mark.parametrize("kind", ["vat", "bones", "usd", "glb"])
def test_a_motion_that_does_not_repeat_is_the_table_s_too(tmp_path: Path, kind: str) -> None:
    table, glb = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    once = ExportOptions(wind=WIND, seconds=1.0, fps=15.0, loop=False)
    told = write_export(table, glb, kind, tmp_path, "tree", once)
    assert not told["loop"]
    assert "seam_percent_of_height" not in told["measured"]
    assert told["measured"]["error_percent_of_height"] < (5 if kind == "glb" else 2 * ERROR)


@pytest.mark.parametrize("kind", ["vat", "bones", "pivots", "glb"])
def test_everything_in_a_glb_is_named_after_the_tree(exports: Exports, kind: str) -> None:
    document = Glb(exports.folder / kind / "tree.glb").document
    assert [node["name"] for node in document["nodes"][:3]] == [
        "tree_wood_0",
        "tree_twigs_0",
        "tree_leaves_0",
    ]
    assert [one["name"] for one in document["materials"]] == ["tree_wood", "tree_twigs", "tree_leaves"]
    pictures = ["tree_wood_base_color", "tree_wood_normal", "tree_leaves_base_color"]
    assert [one["name"] for one in document["images"]] == pictures
    if kind in ("bones", "glb"):
        told = exports.told[kind]
        named = told["clips"][0]["animation"] if kind == "bones" else told["animation"]
        assert document["animations"][0]["name"] == named == "tree_sway"


def test_archives_of_the_same_files_are_the_same(exports: Exports) -> None:
    first = archive(exports.folder / "vat")
    assert first == archive(exports.folder / "vat")
    assert first[:2] == b"PK"


def test_an_unknown_kind_is_refused_with_those_that_exist(tmp_path: Path) -> None:
    table = decode(GOLDEN.read_bytes())
    with pytest.raises(ExportError, match="choose one of vat, bones"):
        write_export(table, b"", "fbx", tmp_path / "out", "tree", ExportOptions())
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("name", "value", "says"),
    [
        ("seconds", 0.2, "greater than or equal to 1"),
        ("fps", 1000.0, "less than or equal to 120"),
        ("format", "tga", "'exr' or 'png'"),
        ("bones", 1, "greater than or equal to 4"),
        ("name", "../oak", "match"),
    ],
)
def test_impossible_options_are_refused_with_what_is_possible(name: str, value: object, says: str) -> None:
    with pytest.raises(ValidationError, match=says):
        ExportOptions.model_validate({name: value})


def test_the_command_writes_an_export_and_tells_its_error(tmp_path: Path) -> None:
    out = tmp_path / "new" / "bones"
    asked = ["export", str(SHIPPED), "--to", "bones", "--out", str(out), "--wind", "breeze"]
    result = CliRunner().invoke(app, [*asked, "--seconds", "1", "--fps", "10", "--bones", "20"])
    assert result.exit_code == 0, result.output
    assert {path.name for path in out.iterdir()} == {
        f"apricot-forest.{ending}" for ending in ("glb", "json", "wind.json")
    }
    told = json.loads((out / "apricot-forest.json").read_text())
    assert told["clips"][0]["wind"]["model"] == "perlin"
    assert told["frames"] == 10


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        (["--wind", "hurricane"], "breeze"),
        (["--to", "fbx"], "vat"),
        (["--mesh", str(GOLDEN)], "GLB"),
        (["--out", "sways/oak.glb"], "--out sways/oak --name oak"),
    ],
)
def test_the_command_says_what_to_do_about_a_mistake(tmp_path: Path, asked: list[str], says: str) -> None:
    result = CliRunner().invoke(
        app, ["export", str(SHIPPED), "--to", "bones", "--seconds", "1", "--out", str(tmp_path / "o"), *asked]
    )
    assert result.exit_code == 1
    assert says in result.output

"""What engines expect of an export: several clips, levels of detail, tangents, a shape for collisions."""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.constants import LEVEL_SHARES
from galewood.io.cli.commands import app
from galewood.io.export import ExportError, ExportOptions, write_export
from galewood.io.export.engine.tangents import tangents
from galewood.io.export.looped import looped
from galewood.io.export.skeletal.trunk import trunk_capsule
from galewood.motion.wind import PRESETS
from galewood.solid.skinning import drawn_positions
from galewood.table import Table, decode
from pydantic import ValidationError
from typer.testing import CliRunner

from tests.golden import GOLDEN_FOLDER
from tests.golden.make_levels import levels as golden_levels
from tests.precompute.fixtures.gltf_reading import Glb
from tests.precompute.io.test_exports import SHIPPED, VALIDATOR, validated

THREE = {name: PRESETS[name] for name in ("breeze", "autumn-gusts", "storm-front")}
OPTIONS = ExportOptions(winds=THREE, levels=3, seconds=2.0, fps=12.0)
ERROR = 0.4  # % of the height, at 12 frames per second
needs_node = pytest.mark.skipif(
    not VALIDATOR.exists() or not shutil.which("node"), reason="needs the page's node_modules"
)


@dataclass(frozen=True)
class Oak:
    """The exports of one tree, as "oak"."""

    folder: Path
    table: Table
    told: dict[str, dict[str, Any]]

    def glb(self, name: str, kind: str = "bones") -> Glb:
        return Glb(self.folder / kind / f"{name}.glb")


@pytest.fixture(scope="module")
def oak(tmp_path_factory: pytest.TempPathFactory) -> Oak:
    folder = tmp_path_factory.mktemp("oak")
    table, glb = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    one = OPTIONS.model_copy(update={"winds": {}, "wind": PRESETS["breeze"]})
    chosen = {"bones": OPTIONS, "vat": one, "pivots": OPTIONS}
    told = {kind: write_export(table, glb, kind, folder / kind, "oak", each) for kind, each in chosen.items()}
    return Oak(folder, table, told)


def test_every_wind_is_a_clip_that_moves_the_tree_as_the_table_does(oak: Oak) -> None:
    glb, told = oak.glb("oak"), oak.told["bones"]
    names = [f"oak_{wind}" for wind in THREE]
    assert [one["name"] for one in glb.document["animations"]] == names
    assert [one["animation"] for one in told["clips"]] == names
    rest = glb.attribute("POSITION").astype(np.float64)
    sways = list[float]()
    for number, wind in enumerate(THREE.values()):
        loop = looped(oak.table, wind, OPTIONS.seconds, OPTIONS.fps)
        worst = sway = 0.0
        for time_s in np.linspace(0.0, loop.seconds, 47, endpoint=False):
            exact = drawn_positions(oak.table, rest, loop.q_at(float(time_s)))
            apart = np.linalg.norm(glb.skinned(float(time_s), number) - exact, axis=1).max()
            worst = max(worst, 100 * apart / float(oak.table.metadata["height_m"]))
            sway = max(sway, float(np.linalg.norm(exact - rest, axis=1).max()))
        assert worst < ERROR
        assert told["clips"][number]["measured"]["error_percent_of_height"] == pytest.approx(worst, rel=0.6)
        sways.append(sway)
    assert sways == sorted(sways)
    assert sways[2] > 2 * sways[0]
    errors = [one["measured"]["error_percent_of_height"] for one in told["clips"]]
    assert told["measured"]["error_percent_of_height"] == max(errors)


def test_the_levels_are_those_of_the_player() -> None:
    """The golden file is read by the player's tests too (openMesh.test.ts)."""
    assert json.loads((GOLDEN_FOLDER / "levels.json").read_text()) == golden_levels()


@pytest.mark.parametrize("kind", ["bones", "vat", "pivots"])
def test_coarser_levels_have_fewer_leaves_and_the_same_frame(oak: Oak, kind: str) -> None:
    files = [oak.glb(f"oak{end}", kind) for end in ("", "_lod1", "_lod2")]
    told = oak.told[kind]["detail" if kind == "pivots" else "levels"]
    assert [one["share"] for one in told] == list(LEVEL_SHARES[:3])
    triangles = [_triangles(glb.document) for glb in files]
    assert [one["triangles"] for one in told] == triangles
    for coarse, fine in zip(triangles[1:], triangles, strict=False):
        # besides the trunk and what shrinks at the moment
        assert 0.5 < coarse / fine < 0.65
    for level, glb in enumerate(files):
        named = [node["name"] for node in glb.document["nodes"][:3]]
        assert named == [f"oak_{part}_0_LOD{level}" for part in ("wood", "twigs", "leaves")]
        assert len(glb.document["images"]) == 3
    sizes = [(oak.folder / kind / f"oak{end}.glb").stat().st_size for end in ("", "_lod1", "_lod2")]
    assert sizes == sorted(sizes, reverse=True)
    low, high = (files[0].attribute("POSITION").min(axis=0), files[0].attribute("POSITION").max(axis=0))
    for glb in files[1:]:
        rows = glb.attribute("POSITION")
        # grown leaves reach farther
        assert (rows > low - 0.5).all() and (rows < high + 0.5).all()


def _triangles(document: dict[str, Any]) -> int:
    used = [mesh["primitives"][0]["indices"] for mesh in document["meshes"]]
    return sum(document["accessors"][index]["count"] for index in used) // 3


def test_all_levels_have_the_same_skeleton(oak: Oak) -> None:
    fine, coarse = oak.glb("oak"), oak.glb("oak_lod2")
    skins = [glb.document["skins"][0] for glb in (fine, coarse)]
    bones = [
        [glb.document["nodes"][k]["name"] for k in skin["joints"]]
        for glb, skin in zip((fine, coarse), skins, strict=True)
    ]
    assert bones[0] == bones[1]
    inverse = [glb.rows(skin["inverseBindMatrices"]) for glb, skin in zip((fine, coarse), skins, strict=True)]
    assert np.array_equal(*inverse)
    assert "animations" not in coarse.document


@needs_node
def test_three_reads_all_levels_and_plays_the_clips_of_the_first_on_them(oak: Oak) -> None:
    time_s, files = 0.7, [str(oak.folder / "bones" / f"oak{end}.glb") for end in ("", "_lod1", "_lod2")]
    script = str(Path(__file__).with_name("read_in_three.mjs"))
    asked = ["node", script, "oak_storm-front", str(time_s), *files]
    done = subprocess.run(asked, capture_output=True, text=True, check=True)
    read = [json.loads(line) for line in done.stdout.splitlines()]
    moved = np.concatenate([mesh["moved"] for mesh in read[0]["meshes"]])
    assert read[0]["clips"] == [f"oak_{wind}" for wind in THREE]
    expected = oak.glb("oak").skinned(time_s, 2)
    assert np.abs(moved - expected).max() < 1e-3
    bumpy = [mesh["name"] for mesh in read[0]["meshes"] if mesh["tangents"]]
    assert bumpy == ["oak_wood_0_LOD0"]
    for coarse in read[1:]:
        # vertices of what has its full size are where those of the first level are
        places = {tuple(row): k for k, row in enumerate(np.round(read[0]["meshes"][1]["rest"], 5))}
        twigs = coarse["meshes"][1]
        pairs = [(k, places.get(tuple(row))) for k, row in enumerate(np.round(twigs["rest"], 5))]
        shared = [(k, at) for k, at in pairs if at is not None]
        assert len(shared) > 0.3 * len(pairs)
        for k, at in shared[::50]:
            assert np.abs(np.subtract(twigs["moved"][k], read[0]["meshes"][1]["moved"][at])).max() < 1e-3
    told, capsule = oak.told["bones"]["trunk"], read[0]["capsule"]
    assert capsule["name"] == "oak_trunk_capsule"
    assert (capsule["radius_m"], capsule["height_m"]) == (told["radius_m"], told["height_m"])
    half_m = 0.5 * told["height_m"] - told["radius_m"]
    top = np.array(capsule["middle"]) + half_m * np.array(capsule["up"])
    assert np.allclose(top, told["top_m"], atol=1e-5)


@needs_node
def test_the_khronos_validator_finds_no_error_in_clips_and_levels(oak: Oak) -> None:
    files = sorted(oak.folder.glob("*/*.glb"))
    assert len(files) == 3 + 3 + 6
    for report in validated(files):
        assert report["errors"] == []


@pytest.mark.parametrize("name", ["apricot-forest", "maple", "poplar"])
def test_the_capsule_follows_the_bark_of_the_trunk(name: str) -> None:
    path = SHIPPED.with_name(f"{name}.table")
    table, glb = decode(path.read_bytes()), Glb(path.with_suffix(".glb"))
    rest = glb.attribute("POSITION").astype(np.float64)
    capsule = trunk_capsule(table, rest)
    along = capsule.top_m - capsule.foot_m
    length_m = float(np.linalg.norm(along))
    assert length_m > 0.1 * float(table.metadata["height_m"])
    assert along[1] > 0.9 * length_m
    wood = rest[: int(table.metadata["primitives"][0]["vertices"])]
    at = (wood - capsule.foot_m) @ along / length_m**2
    away = np.linalg.norm(wood - capsule.foot_m - at[:, None] * along, axis=1)
    bark = away[(at > 0.0) & (at < 1.0) & (away < 3 * capsule.radius_m)]
    assert len(bark) > 20
    assert np.median(bark) == pytest.approx(capsule.radius_m, rel=0.3)


def test_tangents_point_where_pictures_go_on() -> None:
    """A sheet in the plane of x and y, its picture upright; then mirrored, then turned by a quarter."""
    rest = np.array([[0.0, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]])
    normal = np.tile([0.0, 0, 1], (4, 1))
    upright = np.array([[0.0, 1], [1, 1], [1, 0], [0, 0]])  # v from the top
    faces = np.array([[0, 1, 2], [0, 2, 3]])
    assert np.allclose(tangents(rest, normal, upright, faces), [1, 0, 0, 1])
    mirrored = np.c_[1 - upright[:, 0], upright[:, 1]]
    assert np.allclose(tangents(rest, normal, mirrored, faces), [-1, 0, 0, -1])
    turned = np.c_[upright[:, 1], 1 - upright[:, 0]]  # u grows downwards
    found = tangents(rest, normal, turned, faces)
    assert np.allclose(found, [0, -1, 0, 1])
    without = tangents(rest, normal, np.zeros((4, 2)), faces)
    assert np.allclose(np.linalg.norm(without[:, :3], axis=1), 1)
    assert np.allclose(without[:, 2], 0)


@pytest.mark.parametrize("seed", [3])
def test_tangents_of_a_turned_sheet_turn_with_it(seed: int) -> None:
    print(f"seed {seed}")
    rng = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    turn *= np.sign(np.linalg.det(turn))
    rest = np.c_[rng.uniform(size=(30, 2)), np.zeros(30)]
    uv = np.c_[rest[:, 0], -rest[:, 1]] @ [[0.8, 0.1], [-0.2, 0.7]]
    faces = rng.permuted(np.tile(np.arange(30), (40, 1)), axis=1)[:, :3]
    flat = tangents(rest, np.tile([0.0, 0, 1], (30, 1)), uv, faces)
    turned = tangents(rest @ turn.T, np.tile(turn[:, 2], (30, 1)), uv, faces)
    assert np.allclose(turned[:, :3], flat[:, :3] @ turn.T, atol=1e-6)
    assert np.array_equal(turned[:, 3], flat[:, 3])
    # u = 0.8 x + 0.2 y, v = 0.1 x − 0.7 y: where u grows and v stays
    along = np.linalg.solve([[0.8, 0.2], [0.1, -0.7]], [1.0, 0.0])
    assert np.allclose(flat[:, :2], along / np.linalg.norm(along), atol=1e-5)


@pytest.mark.parametrize(("kind", "file"), [("bones", "oak"), ("bones", "oak_lod1"), ("pivots", "oak")])
def test_tangents_are_orthonormal_and_where_there_is_a_picture_of_normals(
    oak: Oak, kind: str, file: str
) -> None:
    glb = oak.glb(file, kind)
    for mesh in glb.document["meshes"]:
        primitive = mesh["primitives"][0]
        bumpy = "normalTexture" in glb.document["materials"][primitive["material"]]
        assert ("TANGENT" in primitive["attributes"]) == bumpy
        if bumpy:
            rows = glb.rows(primitive["attributes"]["TANGENT"]).astype(np.float64)
            normal = glb.rows(primitive["attributes"]["NORMAL"]).astype(np.float64)
            assert np.abs(np.linalg.norm(rows[:, :3], axis=1) - 1).max() < 1e-5
            assert np.abs((rows[:, :3] * normal).sum(axis=1)).max() < 1e-5
            assert set(np.unique(rows[:, 3])) <= {-1.0, 1.0}


@pytest.mark.parametrize(
    ("kind", "options", "says"),
    [
        ("vat", ExportOptions(winds=THREE), "vat plays one wind"),
        ("usd", ExportOptions(levels=2), "usd has one level of detail; vat, bones, pivots"),
        ("mjcf", ExportOptions(levels=2), "mjcf has one level of detail"),
    ],
)
def test_what_a_kind_does_not_hold_is_refused(
    tmp_path: Path, kind: str, options: ExportOptions, says: str
) -> None:
    with pytest.raises(ExportError, match=says):
        write_export(decode(SHIPPED.read_bytes()), b"", kind, tmp_path / "out", "oak", options)
    assert not (tmp_path / "out").exists()


def test_names_of_winds_are_names_of_clips() -> None:
    with pytest.raises(ValidationError, match="match"):
        ExportOptions(winds={"a storm": PRESETS["breeze"]})
    with pytest.raises(ValidationError, match="at most 8"):
        ExportOptions(winds={f"w{k}": PRESETS["breeze"] for k in range(9)})


def test_the_command_takes_presets_and_files_as_winds(tmp_path: Path) -> None:
    document = tmp_path / "my storm.json"
    document.write_text(json.dumps(PRESETS["storm-front"].document()))
    asked = ["export", str(SHIPPED), "--to", "bones", "--out", str(tmp_path / "out"), "--seconds", "1"]
    few = [*asked, "--fps", "5", "--bones", "8", "--levels", "2"]
    result = CliRunner().invoke(app, [*few, "--winds", f"breeze,{document}", "--seed", "4"])
    assert result.exit_code == 0, result.output
    told = json.loads((tmp_path / "out" / "apricot-forest.json").read_text())
    named = [one["animation"] for one in told["clips"]]
    assert named == ["apricot-forest_breeze", "apricot-forest_my-storm"]
    assert [one["wind"]["seed"] for one in told["clips"]] == [4, 4]
    assert (tmp_path / "out" / "apricot-forest_lod1.glb").is_file()


@pytest.mark.parametrize(
    ("asked", "says"),
    [
        (["--winds", "breeze,hurricane"], "'hurricane'"),
        (["--winds", "breeze,breeze"], "two of --winds"),
        (["--winds", "breeze", "--wind", "still"], "give one of the two"),
        (["--winds", "breeze", "--to", "usd"], "usd plays one wind"),
        (["--levels", "6"], "--levels"),
    ],
)
def test_the_command_refuses_winds_that_it_cannot_write(tmp_path: Path, asked: list[str], says: str) -> None:
    call = ["export", str(SHIPPED), "--to", "bones", "--out", str(tmp_path / "out"), "--seconds", "1", *asked]
    result = CliRunner().invoke(app, call)
    assert result.exit_code != 0
    assert says in result.output.replace("\n", " ")

"""Trees as URDF, read by MuJoCo and trimesh, against their tables and the export for MuJoCo."""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import numpy as np
import pytest
import trimesh
from galewood.io.cli.commands import app
from galewood.io.export import ExportError, ExportOptions, write_export
from galewood.io.export.gltf_file import GltfFile
from galewood.pipeline.results import read_compliance
from galewood.table import Table, decode
from scipy.spatial import KDTree
from typer.testing import CliRunner

from tests.precompute.fixtures.mujoco_trees import linearised, ring_down, sprung, upright

mujoco: Any = import_module("mujoco")
REPOSITORY = Path(__file__).parents[4]
SHIPPED = REPOSITORY / "assets/species/shipped/apricot-forest.table"
FEW = 70
MODES = 5
FREQUENCY, DAMPING = 0.05, 0.10
WIND_M_S = 8


@dataclass(frozen=True)
class Tree:
    """A tree exported both ways, in MuJoCo."""

    folder: Path
    table: Table
    file: GltfFile
    told: dict[str, Any]
    model: Any
    """Of the URDF, with the springs of its description."""
    native: Any
    """Of the MJCF."""


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Tree:
    folder, options = tmp_path_factory.mktemp("urdf"), ExportOptions(bones=FEW)
    table, glb = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    compliance = read_compliance(SHIPPED)
    write_export(table, glb, "mjcf", folder / "mjcf", "tree", options, compliance=compliance)
    told = write_export(table, glb, "urdf", folder, "tree", options, compliance=compliance)
    native = mujoco.MjModel.from_xml_path(str(folder / "mjcf/tree.xml"))
    return Tree(folder, table, GltfFile(glb, table), told, sprung(folder / "tree.urdf"), native)


def test_mujoco_reads_the_joints_and_masses(tree: Tree) -> None:
    assert tree.told["bodies"] == FEW
    assert tree.model.nv == 3 * FEW == len(tree.told["joints"])
    assert tree.model.body_mass.sum() == pytest.approx(tree.told["mass_kg"], rel=1e-5)
    assert tree.model.body_mass.sum() == pytest.approx(tree.native.body_mass.sum(), rel=1e-5)
    for name, about in tree.told["joints"].items():
        assert tree.model.joint(name).damping[0] == pytest.approx(about["damping_n_m_s_rad"], rel=1e-5)


def test_it_stands_still_in_its_own_weight(tree: Tree) -> None:
    data = mujoco.MjData(tree.model)
    mujoco.mj_step(tree.model, data, 100)
    assert np.abs(data.qpos).max() < 1e-5


def test_it_sways_and_rings_down_as_the_table(tree: Tree) -> None:
    linear = linearised(tree.model)
    given = np.array(tree.table.metadata["frequencies_hz"][:MODES])
    assert np.abs(linear.frequency_hz[:MODES] / given - 1).max() < FREQUENCY
    native = linearised(tree.native)
    assert np.abs(linear.frequency_hz[:MODES] / native.frequency_hz[:MODES] - 1).max() < 1e-3
    damped = ring_down(tree.model, linear, MODES) / ring_down(tree.native, native, MODES)
    assert np.abs(damped - 1).max() < DAMPING


def test_the_forces_of_its_areas_are_those_of_the_wind_in_mujoco(tree: Tree) -> None:
    speed = tree.told["wind_m_s"][str(WIND_M_S)]
    torque = dict[str, float]()
    for wind in (speed, 0.0):
        tree.native.opt.wind[:] = [wind, 0.0, 0.0]
        data = mujoco.MjData(tree.native)
        mujoco.mj_forward(tree.native, data)
        for name in tree.told["joints"]:
            now = float(data.qfrc_passive[tree.native.jnt_dofadr[tree.native.joint(name).id]])
            torque[name] = torque[name] - now if wind == 0.0 else now
    data = mujoco.MjData(tree.model)
    mujoco.mj_forward(tree.model, data)
    found = np.zeros(tree.model.nv)
    for name, about in tree.told["links"].items():
        body = tree.model.body(name).id
        force = np.array([0.5 * tree.told["air_kg_m3"] * about["area_m2"] * speed**2, 0.0, 0.0])
        place = data.xpos[body] + data.xmat[body].reshape(3, 3) @ about["centre_m"]
        mujoco.mj_applyFT(tree.model, data, force, np.zeros(3), place, body, found)
    expected = np.array([torque[tree.model.joint(k).name] for k in range(tree.model.njnt)])
    assert np.abs(expected).max() > 100
    assert np.abs(found - expected).max() < 1e-4 * np.abs(expected).max()


def test_the_cylinders_lie_in_the_capsules_for_mujoco(tree: Tree) -> None:
    placed = list[dict[str, list[Any]]]()
    for model, kind in ((tree.model, "CYLINDER"), (tree.native, "CAPSULE")):
        data, found = mujoco.MjData(model), dict[str, list[Any]]()
        mujoco.mj_kinematics(model, data)
        for geom in np.flatnonzero(model.geom_type == getattr(mujoco.mjtGeom, f"mjGEOM_{kind}")):
            axis = data.geom_xmat[geom].reshape(3, 3)[:, 2]
            name = model.body(int(model.geom_bodyid[geom])).name
            row = np.concatenate([data.geom_xpos[geom], axis * np.sign(axis[2]), model.geom_size[geom, :2]])
            found.setdefault(name, []).append(row)
        placed.append(found)
    assert set(placed[0]) == set(placed[1])
    for name, rows in placed[0].items():
        np.testing.assert_allclose(np.array(rows), np.array(placed[1][name]), atol=2e-5)


def test_the_meshes_of_the_links_are_the_drawn_mesh(tree: Tree) -> None:
    """Every triangle once, and once more from behind where the material has two sides; with its picture."""
    data = mujoco.MjData(tree.model)
    mujoco.mj_kinematics(tree.model, data)
    found, pictures = list[Any](), set[str]()
    for link in ElementTree.parse(tree.folder / "tree.urdf").getroot().iter("link"):
        for mesh in link.iter("mesh"):
            path = tree.folder / mesh.attrib["filename"]
            place = data.body(link.attrib["name"]).xpos
            scene: Any = trimesh.load_scene(path, process=False)
            for part in scene.geometry.values():
                pictures.add(part.visual.material.image.mode if part.visual.material.image else "none")
                found.append(part.vertices[part.faces] + place)
    rest = np.split(upright(tree.file.rest_m()), np.cumsum(tree.file.counts)[:-1])
    both = [bool(tree.file.gltf.materials[k].doubleSided) for k in range(len(rest))]
    given = np.concatenate(
        [
            np.concatenate([place[corner]] * (2 if twice else 1))
            for place, corner, twice in zip(rest, tree.file.faces(), both, strict=True)
        ]
    )
    middles = np.concatenate(found).mean(axis=1), given.mean(axis=1)
    assert len(middles[0]) == len(middles[1]) and any(both)
    near = [KDTree(other).query(one)[0].max() for one, other in (middles, middles[::-1])]
    assert max(near) < 1e-4
    assert "RGBA" in pictures


def test_without_a_compliance_file_it_says_what_is_missing(tmp_path: Path) -> None:
    table, glb = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    with pytest.raises(ExportError, match="urdf needs the compliance file"):
        write_export(table, glb, "urdf", tmp_path / "out", "tree")
    assert not (tmp_path / "out").exists()


def test_the_command_writes_it_and_tells_the_fit(tmp_path: Path) -> None:
    asked = ["export", str(SHIPPED), "--to", "urdf", "--bones", "12", "--out", str(tmp_path)]
    run = CliRunner().invoke(app, [*asked, "--name", "mine"])
    assert run.exit_code == 0, run.output
    assert "12 bodies" in run.output
    assert sprung(tmp_path / "mine.urdf").nv == 36
    assert json.loads((tmp_path / "mine.json").read_text())["format"] == "galewood-urdf"


def test_a_table_without_leaves_draws_none(tmp_path: Path) -> None:
    table, glb = decode(SHIPPED.with_suffix(".bare.table").read_bytes()), SHIPPED.with_suffix(".glb")
    options = ExportOptions(bones=12)
    compliance = read_compliance(SHIPPED)
    write_export(table, glb.read_bytes(), "urdf", tmp_path, "tree", options, compliance=compliance)
    assert not any("leaves" in path.read_text() for path in tmp_path.glob("*.obj"))


def test_the_code_of_the_page_runs(
    tree: Tree, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = REPOSITORY.joinpath("docs/how-to/export-urdf.md").read_text(encoding="utf-8")
    code = page.partition("```python\n")[2].partition("```")[0]
    assert code.count("tree-urdf/") == 2 and code.count("< 20") == 1
    monkeypatch.chdir(tree.folder)
    exec(code.replace("tree-urdf/", "").replace("< 20", "< 0.5"), {})
    moved_m = float(capsys.readouterr().out)
    assert 0.001 < moved_m < 1.0

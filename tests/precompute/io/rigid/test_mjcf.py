"""Trees for MuJoCo, held against their tables and finite elements in MuJoCo itself."""

from __future__ import annotations

from dataclasses import dataclass
from importlib import import_module
from pathlib import Path
from typing import Any

import galewood
import numpy as np
import pytest
from galewood.io.cli.commands import app
from galewood.io.export import ExportError, ExportOptions, write_export
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.rigid.bodies import body_names
from galewood.io.export.rigid.chain import gravity, mass_matrix
from galewood.io.export.rigid.fitted import FittedTree, fitted_tree
from galewood.io.export.rigid.solid import Solid
from galewood.io.export.rigid.targets import oscillators
from galewood.motion.wind import PRESETS
from galewood.pipeline.results import read_compliance
from galewood.table import Table, decode, decode_compliance
from typer.testing import CliRunner

from tests.precompute.fixtures.mujoco_trees import (
    Bodies,
    Linear,
    blown,
    deflection_errors,
    in_gusts,
    linearised,
    ring_down,
    upright,
    wood_rings,
)

mujoco: Any = import_module("mujoco")
SHIPPED = Path(__file__).parents[4] / "assets/species/shipped/apricot-forest.table"
FEW = 70
MODES = 5
FREQUENCY, DAMPING, DEFLECTION = 0.05, 0.10, 0.05
SEED = 5


@dataclass(frozen=True)
class Tree:
    """A tree in MuJoCo."""

    folder: Path
    table: Table
    rest_m: Any
    told: dict[str, Any]
    model: Any
    linear: Linear


def exported(folder: Path, bodies: int, foliage: str = "") -> Tree:
    table = decode(SHIPPED.with_suffix(f"{foliage}.table").read_bytes())
    glb = SHIPPED.with_suffix(".glb").read_bytes()
    options = ExportOptions(bones=bodies)
    told = write_export(table, glb, "mjcf", folder, "tree", options, compliance=read_compliance(SHIPPED))
    model = mujoco.MjModel.from_xml_path(str(folder / "tree.xml"))
    return Tree(folder, table, GltfFile(glb, table).rest_m(), told, model, linearised(model))


@pytest.fixture(scope="module")
def tree(tmp_path_factory: pytest.TempPathFactory) -> Tree:
    return exported(tmp_path_factory.mktemp("mjcf"), FEW)


def test_it_stands_still_in_its_own_weight(tree: Tree) -> None:
    data = mujoco.MjData(tree.model)
    mujoco.mj_step(tree.model, data, 100)
    assert np.abs(data.qpos).max() < 1e-5
    assert data.ncon == 0
    assert tree.told["bodies"] == FEW
    assert tree.model.body_mass.sum() == pytest.approx(tree.told["mass_kg"], rel=1e-5)


def test_it_sways_at_the_frequencies_of_the_table(tree: Tree) -> None:
    given = np.array(tree.table.metadata["frequencies_hz"][:MODES])
    assert np.abs(tree.linear.frequency_hz[:MODES] / given - 1).max() < FREQUENCY


def test_it_rings_down_as_the_table_does(tree: Tree) -> None:
    alpha, beta = oscillators(tree.table, tree.rest_m).rayleigh()
    omega = 2 * np.pi * np.array(tree.table.metadata["frequencies_hz"][:MODES])
    found = ring_down(tree.model, tree.linear, MODES)
    assert np.abs(found / (0.5 * (alpha / omega + beta * omega)) - 1).max() < DAMPING


def test_a_steady_wind_bends_it_as_the_table_does(tree: Tree) -> None:
    sway = blown(tree.model, tree.told, tree.table, tree.rest_m, 8, 8.0)
    assert sway.warnings == 0
    last = slice(len(sway.by_table) // 3, None)
    given = sway.by_table[last].mean(axis=0)
    assert np.linalg.norm(sway.by_mujoco[last].mean(axis=0) - given) < 0.1 * np.linalg.norm(given)


def test_gusts_move_it_as_the_table_does(tree: Tree) -> None:
    """RMS sway of the top along and across the wind, and moment by moment."""
    wind = PRESETS["autumn-gusts"]
    gusty = in_gusts(tree.model, tree.told, tree.table, tree.rest_m, wind, 15.0, 10.0)
    assert gusty.warnings == 0
    heading = np.radians(wind.direction_deg)
    for direction in ([np.cos(heading), -np.sin(heading), 0.0], [np.sin(heading), np.cos(heading), 0.0]):
        own, given = gusty.sways(np.array(direction))
        assert given.std() > 0.01 * float(tree.table.metadata["height_m"])
        assert own.std() == pytest.approx(given.std(), rel=0.15)
        assert np.corrcoef(own, given)[0, 1] > 0.97


def test_the_air_at_the_bodies_is_that_of_the_wind_in_the_shelter_of_the_crown(tree: Tree) -> None:
    data = mujoco.MjData(tree.model)
    mujoco.mj_forward(tree.model, data)
    places, times = Bodies.of(tree.model, tree.told).places(data), np.arange(0, 20, 1 / 30)
    table = galewood.load(SHIPPED)
    for speed in (4, 8, 15):
        # the wind profile is 1 at the height of the tree
        height_m = float(tree.table.metadata["height_m"])
        still = galewood.Wind(
            mean_speed_m_s=speed,
            gustiness=0.0,
            direction_deg=90.0,
            heading_swing_deg=0.0,
            reference_height_m=height_m,
        )
        air = galewood.body_winds(table, still, places, times[:3])
        assert air.shape == (3, len(places), 3)
        assert np.allclose(air, [0.0, -tree.told["wind_m_s"][str(speed)], 0.0], atol=1e-6)
    gusts = galewood.body_winds(table, PRESETS["autumn-gusts"], places, times)
    assert not gusts[..., 2].any()
    # neighbours feel nearly the same, the ends of the crown do not
    apart_m = np.linalg.norm(places[:, None] - places[None], axis=2)
    near, far = (apart_m < 0.3) & (apart_m > 0), apart_m > 5
    differs = np.linalg.norm(gusts[:, :, None] - gusts[:, None], axis=3)[::60].mean(axis=0)
    assert differs[near].mean() < 0.3 * differs[far].mean()


@pytest.mark.parametrize("seed", [8])
def test_forces_of_even_air_are_mujocos_own(tree: Tree, seed: int) -> None:
    """In random motion: the rule of the page gives what MuJoCo's fluid model does with one wind for all."""
    print(f"seed {seed}")
    rng, model = np.random.default_rng(seed), tree.model
    bodies, data, air = Bodies.of(model, tree.told), mujoco.MjData(model), np.array([2.0, -1.0, 0.0])
    data.qpos[:], data.qvel[:] = rng.normal(scale=0.02, size=(2, model.nq))
    model.opt.wind[:] = air
    mujoco.mj_forward(model, data)
    given = data.qfrc_fluid.copy()
    model.opt.wind[:] = 0.0
    bodies.push(data, np.tile(air, (len(bodies.number), 1)))
    found = np.zeros(model.nv)
    for body in bodies.number:
        force = data.xfrc_applied[body]
        mujoco.mj_applyFT(model, data, force[:3].copy(), force[3:].copy(), data.xipos[body], body, found)
    assert np.abs(given).max() > 1.0
    assert np.abs(found - given).max() < 1e-3 * np.abs(given).max()


def test_the_linear_chain_is_mujocos(tree: Tree) -> None:
    """Mass matrix and stiffness, gravity included, against those that MuJoCo itself computes."""
    fitted = _fitted(tree)
    # MuJoCo numbers the bodies depth first
    names = body_names(fitted.tree, "tree")
    order = [names.index(tree.model.body(body).name) for body in range(2, tree.model.nbody)]
    hinge = (3 * np.array(order)[:, None] + np.arange(3)).ravel()
    mass = mass_matrix(fitted.tree, fitted.masses)[np.ix_(hinge, hinge)]
    assert np.abs(mass - tree.linear.mass).max() < 1e-5 * np.abs(mass).max()
    springs = fitted.stiffness[hinge]
    stiffness = np.diag(springs) + gravity(fitted.tree, fitted.masses)[1][np.ix_(hinge, hinge)]
    assert np.abs(stiffness - tree.linear.stiffness).max() < 1e-4 * np.abs(stiffness).max()
    soft = np.argsort(springs)[: len(mass) // 2]
    off = (stiffness - tree.linear.stiffness)[np.ix_(soft, soft)]
    assert np.abs(off).max() < 1e-3 * np.abs(stiffness[np.ix_(soft, soft)]).max()


def _fitted(tree: Tree) -> FittedTree:
    compliance = decode_compliance(read_compliance(SHIPPED) or b"")
    faces = GltfFile(SHIPPED.with_suffix(".glb").read_bytes(), tree.table).faces()
    return fitted_tree(tree.table, compliance, tree.rest_m, faces, FEW)


def test_the_skins_are_the_drawn_mesh(tree: Tree) -> None:
    model = tree.model
    assert model.nskin == len(tree.table.metadata["primitives"])
    assert np.abs(model.skin_vert - upright(tree.rest_m)).max() < 1e-5
    total = np.zeros(model.nskinvert)
    for skin in range(model.nskin):
        first = int(model.skin_boneadr[skin])
        for bone in range(first, first + int(model.skin_bonenum[skin])):
            held = slice(
                model.skin_bonevertadr[bone], model.skin_bonevertadr[bone] + model.skin_bonevertnum[bone]
            )
            place = model.skin_bonebindpos[bone]
            assert np.abs(place - _rest_place(model, int(model.skin_bonebodyid[bone]))).max() < 1e-5
            total[model.skin_vertadr[skin] + model.skin_bonevertid[held]] += model.skin_bonevertweight[held]
    assert np.abs(total - 1).max() < 1e-5
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    wood = model.geom_type == mujoco.mjtGeom.mjGEOM_CAPSULE
    assert wood.sum() >= FEW
    assert data.geom_xpos[wood, 2].max() < float(tree.table.metadata["height_m"])


def _rest_place(model: Any, body: int) -> Any:
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    return data.xpos[body]


def test_a_table_without_leaves_has_their_mass_removed(tmp_path: Path) -> None:
    bare = exported(tmp_path, FEW, ".bare")
    # of the finite element model without leaves, as the report of the build has it
    assert bare.told["mass_kg"] == pytest.approx(82.94, rel=0.02)
    given = np.array(bare.table.metadata["frequencies_hz"][:MODES])
    assert np.abs(bare.linear.frequency_hz[:MODES] / given - 1).max() < FREQUENCY
    assert not any("leaves" in path.name for path in tmp_path.iterdir())


def test_a_ball_that_hits_the_stem_is_stopped_and_moves_the_tree(tree: Tree) -> None:
    spec = mujoco.MjSpec.from_file(str(tree.folder / "tree.xml"))
    ball = spec.worldbody.add_body(name="ball", pos=[-2.0, 0.0, 4.0], gravcomp=1.0)
    ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.3, 0.0, 0.0], mass=20.0)
    for axis in np.eye(3):
        ball.add_joint(type=mujoco.mjtJoint.mjJNT_SLIDE, axis=axis.tolist())
    model = spec.compile()
    data = mujoco.MjData(model)
    first = int(model.body("ball").jntadr[0])
    moves = slice(int(model.jnt_dofadr[first]), int(model.jnt_dofadr[first]) + 3)
    data.qvel[moves] = [2.0, 0.0, 0.0]
    mujoco.mj_forward(model, data)
    rest_m, farthest_m = data.body("tree").subtree_com.copy(), 0.0
    while data.time < 3.0:
        mujoco.mj_step(model, data)
        away_m = float(np.linalg.norm(data.body("tree").subtree_com - rest_m))
        farthest_m = max(farthest_m, away_m)
    assert float(np.linalg.norm(data.qvel[moves])) < 1.0
    assert float(data.body("ball").xpos[0]) < 0.5
    assert 1e-3 < farthest_m < 0.5
    assert not any(warning.number for warning in data.warning)


def test_the_code_of_the_page_runs(
    tree: Tree, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    page = Path(__file__).parents[4].joinpath("docs/how-to/export-mujoco.md").read_text(encoding="utf-8")
    first, second = (block.partition("```")[0] for block in page.split("```python\n")[1:])
    assert first.count("tree-mjcf/") == 2 and first.count("< 20") == 1
    assert second.count('"tree.gwt"') == 1 and second.count("< 60") == 1
    monkeypatch.chdir(tree.folder)
    names = dict[str, Any]()
    exec(first.replace("tree-mjcf/", "").replace("< 20", "< 0.1"), names)
    exec(second.replace('"tree.gwt"', f'"{SHIPPED}"').replace("< 60", "< 0.1"), names)
    for line in capsys.readouterr().out.splitlines():
        height_m = float(line.strip(" []").split()[2])
        assert 0 < height_m < float(np.ptp(tree.rest_m[:, 1]))
    assert np.abs(names["data"].xfrc_applied).max() > 0.01


@pytest.mark.long
def test_forces_deflect_it_as_they_do_the_finite_elements(tmp_path: Path) -> None:
    whole = exported(tmp_path, 256)
    solid = Solid(decode_compliance(read_compliance(SHIPPED) or b""))
    print("seed", SEED)
    rng = np.random.default_rng(SEED)
    rings = wood_rings(whole.table, solid.binding, 1, 50, rng)
    yields = solid.response(np.stack([solid.binding[ring].toarray()[0] for ring in rings]))
    off = deflection_errors(whole.model, whole.linear, whole.table, whole.rest_m, rings, yields, rng)
    # dents in the wood around a force are no part of rigid bodies
    assert np.median(off) < DEFLECTION
    assert (off < DEFLECTION).sum() >= 40


def test_without_a_compliance_file_it_says_what_is_missing_and_writes_nothing(tmp_path: Path) -> None:
    table, glb = decode(SHIPPED.read_bytes()), SHIPPED.with_suffix(".glb").read_bytes()
    with pytest.raises(ExportError, match="compliance file"):
        write_export(table, glb, "mjcf", tmp_path / "out", "tree")
    with pytest.raises(ExportError, match="cannot be read"):
        write_export(table, glb, "mjcf", tmp_path / "out", "tree", compliance=b"damaged")
    other = read_compliance(SHIPPED.with_name("maple.table"))
    with pytest.raises(ExportError, match="another tree"):
        write_export(table, glb, "mjcf", tmp_path / "out", "tree", compliance=other)
    assert not (tmp_path / "out").exists()


def test_the_command_finds_the_file_beside_the_table(tmp_path: Path) -> None:
    loaded = galewood.load(SHIPPED)
    assert loaded.compliance is not None
    loaded.save(tmp_path / "mine.gwt")
    again = galewood.load(tmp_path / "mine.gwt")
    assert again.compliance == loaded.compliance
    run = CliRunner().invoke(app, ["export", str(tmp_path / "mine.gwt"), "--to", "mjcf", "--bones", "12"])
    assert run.exit_code == 0, run.output
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "mine-mjcf/mine.xml")).nv == 36
    (tmp_path / "mine.compliance.gz").unlink()
    run = CliRunner().invoke(app, ["export", str(tmp_path / "mine.gwt"), "--to", "mjcf"])
    assert run.exit_code == 1
    assert "compliance" in run.output

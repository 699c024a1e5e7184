"""The players of spec/player, written from the format documents alone, against the golden files."""

from __future__ import annotations

import ast
import hashlib
import importlib
import itertools
import json
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.motion.wind import Wind, WindField, parse_wind
from galewood.player import WindDrivenForest, WindDrivenTrees
from galewood.table import Table, decode
from galewood.util import Floats
from galewood_server.stream.forest import GroupStepper

from tests.golden import GOLDEN_FOLDER

ROOT = Path(__file__).parents[2]
PLAYER = ROOT / "spec" / "player"
POLE = str(GOLDEN_FOLDER / "pole.safetensors")
FRAME_S = 1 / 30
FRAMES = 300
"""Frames that are compared of longer golden motions."""
MM = 1e-3
"""Largest difference of a node, mm; the golden numbers have nine digits."""

sys.path.insert(0, str(PLAYER))
player: Any = importlib.import_module("reference_player")
winds: Any = importlib.import_module("reference_wind")
noise: Any = importlib.import_module("reference_noise")
MODELS = {
    "cosine": winds.cosine,
    "perlin": noise.perlin,
    "spectral": winds.spectral,
    "navier-stokes": noise.navier_stokes,
    "recorded": winds.recorded,
}


def golden(name: str) -> Any:
    return json.loads((GOLDEN_FOLDER / name).read_text())


def trees_of(trees: dict[str, list[float]], table: str = POLE) -> list[Any]:
    return [
        player.Tree(table, yaw, scale) for yaw, scale in zip(trees["yaw_rad"], trees["scale"], strict=True)
    ]


def places_of(trees: dict[str, list[float]]) -> tuple[Floats, Floats]:
    return np.array(trees["x_m"]), np.array(trees["z_m"])


def millimetres(basis: Floats, found: Any, expected: Any) -> float:
    """Largest distance of a node between poses q."""
    q = np.reshape(found, (-1, basis.shape[2])) - np.reshape(expected, (-1, basis.shape[2]))
    return float(1e3 * np.linalg.norm(np.einsum("nik,tk->tni", basis, q), axis=2).max())


def pole_basis(path: str = POLE) -> Floats:
    return player.read(path)[1]["nodes.basis"]


def test_the_players_are_short_and_use_numpy_only() -> None:
    assert len((PLAYER / "reference_player.py").read_text().splitlines()) <= 200
    for name in ("player", "wind", "noise", "joints"):
        parsed = ast.parse((PLAYER / f"reference_{name}.py").read_text())
        imports = {node.module for node in ast.walk(parsed) if isinstance(node, ast.ImportFrom)}
        imports |= {
            part.name for node in ast.walk(parsed) if isinstance(node, ast.Import) for part in node.names
        }
        allowed = {
            "numpy",
            "json",
            "struct",
            "math",
            "base64",
            "itertools",
            "pathlib",
            "typing",
            "__future__",
        }
        assert imports <= allowed | {"collections.abc", "reference_wind", "reference_joints"}


def test_velocities_and_pressures_are_the_golden_ones() -> None:
    models = golden("wind_models.json")
    times = [frame * models["frame_s"] for frame in models["frames"]]
    compared = 0
    for one in models["models"]:
        velocity = MODELS[one["wind"]["model"]](one["wind"])
        found = [
            [velocity(x, z, time) for x, z in zip(models["x_m"], models["z_m"], strict=True)]
            for time in times
        ]
        found = np.array(found).transpose(0, 2, 1).reshape(len(times), -1)
        np.testing.assert_allclose(found, one["velocity_m_s"], atol=1e-9)
        compared += 1
    assert compared == len(models["models"])
    for row in golden("wind.json"):
        velocity = winds.cosine(row["wind"])
        for i in range(len(row["x_m"])):
            w = velocity(row["x_m"][i], row["z_m"][i], row["time_s"])
            pressure = w * winds.pressure(winds.size(w), row["exponent"]) / max(winds.size(w), 1e-30)
            np.testing.assert_allclose(
                pressure, (row["pressure_x_pa"][i], row["pressure_z_pa"][i]), rtol=1e-6, atol=1e-6
            )


@pytest.mark.parametrize("index", range(4))
def test_both_methods_walk_as_the_golden_trees(index: int) -> None:
    said = golden("walks.json")
    walk, (x, z), basis = said["walks"][index], places_of(said["trees"]), pole_basis()
    modal, paper = trees_of(said["trees"]), trees_of(said["trees"])
    field, out, records = WindField(parse_wind(walk["wind"])), np.zeros((2, len(x))), hashlib.sha256()
    worst_mm = 0.0
    for frame in range(FRAMES):
        field.pressure(x, z, frame * said["frame_s"], out[0], out[1], modal[0].exponent)
        acting = np.floor(out.T * said["steps_per_pa"] + 0.5) / said["steps_per_pa"]
        q = [tree.advance(said["frame_s"], p) for tree, p in zip(modal, acting, strict=True)]
        for tree, p in zip(paper, acting, strict=True):
            tree.advance(said["frame_s"], p, paper=True)
        records.update(np.array([tree.record for tree in paper], "<i4").tobytes())
        row, rest = divmod(frame, said["every"])
        if rest == said["every"] - 1:
            assert records.hexdigest()[:16] == walk["records"][row]
            worst_mm = max(worst_mm, millimetres(basis, q, walk["poses"][row]))
    print(f"{walk['wind']['model']}: modal within {worst_mm:.1e} mm, the paper's records equal")
    assert worst_mm < MM


@pytest.mark.parametrize("index", (0, 1))
def test_the_search_eases_and_restarts_as_the_golden_trees(index: int) -> None:
    walk, basis = golden("walk.json")[index], pole_basis()
    trees, worst_mm = trees_of(walk["trees"]), 0.0
    x, z = (values.astype(np.float32) for values in places_of(walk["trees"]))
    for tree in trees:
        tree.easing = walk["pose_easing"]
    out, velocity = np.zeros(2), winds.cosine(walk["wind_from_frame"]["0"])
    for frame, records in enumerate(walk["records"]):
        if str(frame) in walk["wind_from_frame"]:
            velocity = winds.cosine(walk["wind_from_frame"][str(frame)])
        q = []
        for i, tree in enumerate(trees):
            w = velocity(float(x[i]), float(z[i]), frame * walk["frame_s"])
            p = winds.pressure(winds.size(w), tree.exponent)
            out[:] = np.float32(w * p / max(winds.size(w), 1e-30))
            q.append(tree.advance(walk["frame_s"], out, paper=True))
        assert [tree.record for tree in trees] == records
        if frame % walk["every"] == 0:
            worst_mm = max(worst_mm, millimetres(basis, q, walk["poses"][frame // walk["every"]]))
    print(f"easing {walk['pose_easing']}: within {worst_mm:.1e} mm")
    assert worst_mm < MM


@pytest.mark.parametrize(("name", "table"), [("sway", "pole"), ("sway-linear", "pole-linear")])
def test_the_modal_model_sways_as_the_golden_trees(name: str, table: str) -> None:
    said, path = golden(f"{name}.json"), str(GOLDEN_FOLDER / f"{table}.safetensors")
    trees, (x, z), basis = trees_of(said["trees"], path), places_of(said["trees"]), pole_basis(path)
    for frame in range(FRAMES):
        strength = 12.0 * (1 + 0.5 * np.cos(0.013 * frame))
        px, pz = strength * (1 + np.cos(0.05 * frame + x)), 12.0 * np.cos(0.031 * frame + z)
        q = [tree.advance(said["frame_s"], p) for tree, p in zip(trees, np.transpose([px, pz]), strict=True)]
        row, rest = divmod(frame, said["every"])
        if rest == said["every"] - 1:
            assert millimetres(basis, q, said["poses"][row]) < 5 * MM  # pressures are float32 there


def test_gusts_within_crowns_are_the_golden_ones() -> None:
    said, basis = golden("gusts.json"), pole_basis()
    wind, trees = said["winds"][0], trees_of(said["trees"])
    places = list(zip(*places_of(said["trees"]), strict=True))
    field, pressures = winds.crown_field(wind["seed"]), ((9.0, 4.5), (40.0, 20.0))
    for tree, (x, z), p, row in zip(
        trees[1:], places[1:], pressures, np.reshape(said["gusts"], (3, -1))[1:], strict=True
    ):
        found = winds.crown_gusts(
            wind, field, tree.places(tree.t["modal.place"], x, z), p, 7.25, tree.exponent
        )
        np.testing.assert_allclose(found.ravel(), row, atol=1e-12)
    frames = said["frames"] // len(said["winds"])
    velocity = winds.spectral(wind)
    played = [
        list(itertools.islice(player.play(tree, wind, velocity, x, z, said["frame_s"]), frames))
        for tree, (x, z) in zip(trees, places, strict=True)
    ]
    for row in range(frames // said["every"]):
        q = [poses[(row + 1) * said["every"] - 1] for poses in played]
        assert millimetres(basis, q, said["poses"][row]) < MM


def field_velocity(wind: Wind) -> Callable[[float, float, float], Floats]:
    """The velocity of any model, of Galewood."""
    field, out = WindField(wind), np.zeros((2, 1))

    def velocity(x: float, z: float, time_s: float) -> Floats:
        field.velocity(np.array([x]), np.array([z]), time_s, out[0], out[1])
        return out[:, 0].copy()

    return velocity


def random_winds(seed: int = 5) -> list[Wind]:
    """A wind of every model; the third is far beyond the sampled range."""
    rng = np.random.default_rng(seed)
    print(f"seed {seed}")
    return [
        Wind(
            model=model, mean_speed_m_s=float(rng.uniform(3, 10) * (4 if k == 2 else 1)),
            direction_deg=float(rng.uniform(-180, 180)), gustiness=float(rng.uniform(0.3, 1.0)),
            convection_speed_m_s=float(rng.uniform(4, 12)), seed=int(rng.integers(2**32)),
            length_scale_m=20.0 if model == "cosine" else float(rng.uniform(10, 60)),
        )
        for k, model in enumerate(("cosine", "perlin", "spectral", "navier-stokes"))
    ]  # fmt: skip


@pytest.mark.parametrize("index", range(4))
def test_trees_in_random_winds_move_as_those_of_galewood(index: int) -> None:
    wind, table = random_winds()[index], decode(Path(POLE).read_bytes())
    rows = np.array([[-11.5, 4.0, 0.5, 0.75], [30.25, -9.75, -2.25, 1.0], [18.0, 120.5, 3.0, 1.5]])
    velocity = field_velocity(wind)
    own = MODELS[wind.model](wind.document())
    modal = [
        player.play(player.Tree(POLE, yaw, scale), wind.document(), own, x, z, FRAME_S)
        for x, z, yaw, scale in rows
    ]
    worst = {
        "modal": _largest_mm(table, wind, rows, "modal", lambda frame: [next(one) for one in modal]),
        "paper": _largest_mm(table, wind, rows, "paper", _searching(rows, wind, velocity)),
    }
    print(f"{wind.model}: " + ", ".join(f"{method} {mm:.1e} mm" for method, mm in worst.items()))
    assert max(worst.values()) < MM


def _largest_mm(table: Table, wind: Wind, rows: Floats, method: Any, step: Callable[[int], Any]) -> float:
    theirs, field, basis = WindDrivenTrees(table, rows, method), WindField(wind), pole_basis()
    worst_mm, largest_mm = 0.0, 0.0
    for frame in range(1, FRAMES + 1):
        theirs.step(field, frame * FRAME_S, FRAME_S)
        worst_mm = max(worst_mm, millimetres(basis, step(frame), theirs.q))
        largest_mm = max(largest_mm, millimetres(basis, theirs.q, np.zeros(theirs.q.shape)))
    assert largest_mm > 20
    return worst_mm


def _searching(rows: Floats, wind: Wind, velocity: Callable[[float, float, float], Floats]) -> Any:
    """Steps of the reference player by the paper's search, under pressures limited as wind.md says."""
    trees = [player.Tree(POLE, yaw, scale) for _, _, yaw, scale in rows]

    def step(frame: int) -> list[Any]:
        q = []
        for tree, (x, z, _, scale) in zip(trees, rows, strict=True):
            height = tree.metadata["height_m"] * scale / wind.reference_height_m
            w = height**wind.height_exponent * velocity(x, z, frame * FRAME_S)
            p = w * winds.pressure(winds.size(w), tree.exponent) / max(winds.size(w), 1e-30)
            p = p * min(1.0, tree.metadata["peak_pressure_pa"] / max(winds.size(p), 1e-30))
            q.append(tree.advance(FRAME_S, p, paper=True))
        return q

    return step


@pytest.mark.parametrize("name", ["maple", "poplar-forest"])
def test_built_in_trees_move_as_those_that_the_server_streams(name: str) -> None:
    """Up to the rounding of the stream, which wire.md bounds."""
    path = ROOT / "assets" / "species" / "shipped" / f"{name}.table"
    table, wind = decode(path.read_bytes()), random_winds()[2]
    rows = np.array([[-11.5, 4.0, 0.5, 0.75], [18.0, 120.5, 3.0, 1.5]], np.float32)
    stepper, field = GroupStepper(table, rows, None, "modal"), WindField(wind)
    forest = WindDrivenForest([stepper.trees])
    count, modes, quantum = stepper.shape
    unit_m, sent = quantum * table.mode_scale.astype(np.float64), np.zeros((count, modes), np.int32)
    velocity, basis = winds.spectral(wind.document()), table.node_basis.astype(np.float64)
    played = [
        player.play(player.Tree(str(path), yaw, scale), wind.document(), velocity, x, z, FRAME_S)
        for x, z, yaw, scale in rows.tolist()
    ]
    bound_mm = 1e3 * np.linalg.norm(np.abs(0.5 * unit_m * basis).sum(2), axis=1).max()
    worst_mm = 0.0
    for frame in range(1, 121):
        forest.step(field, frame * FRAME_S, FRAME_S)
        stepper.write_poses(sent)
        q = [next(one) for one in played]
        worst_mm = max(worst_mm, millimetres(basis, q, sent * unit_m))
        # half a unit, and float32 of up to 2^15 units
        assert np.abs(np.array(q) - sent * unit_m).max() < 0.501 * unit_m.max()
    print(f"{name}: the stream rounds by up to {worst_mm:.2f} mm, at worst {bound_mm:.2f} mm")
    assert worst_mm < bound_mm < 0.92


def test_vertices_are_drawn_as_galewood_draws_them() -> None:
    for row in golden("drawn.json"):
        q, rest = row["factor"] * np.array(row["q"]), np.array(row["rest_m"])
        table = str(GOLDEN_FOLDER / "pole-table.safetensors")
        found = player.Tree(table).vertices(rest, q, 0.0, 0.0)
        np.testing.assert_allclose(found, row["drawn_m"], atol=1e-9)

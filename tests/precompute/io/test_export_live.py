"""A live GLB in Babylon.js, and in the player of its extension, against the linear model of its table."""

from __future__ import annotations

import copy
import importlib
import json
import math
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import jsonschema
import numpy as np
import pytest
from galewood.io.export import ExportOptions, write_export
from galewood.io.export.live.gusts import live_gusts
from galewood.io.export.live.model import LiveModel, live_model
from galewood.motion.modal import drag_inputs
from galewood.motion.wind import Wind, WindField, dynamic_pressure
from galewood.player import WindDrivenTrees
from galewood.solid.skinning import vertex_rows
from galewood.table import Table, decode

from tests.golden import GOLDEN_FOLDER
from tests.precompute.fixtures.gltf_reading import Glb
from tests.precompute.io.behaviour_graph import Graph

REPOSITORY = Path(__file__).parents[3]
SHIPPED = REPOSITORY / "assets/species/shipped/apricot-forest.table"
PLAYER = Path(__file__).with_name("babylonLive.mjs")
SCHEMA = REPOSITORY / "spec/formats/EXT_modal_dynamics.schema.json"
EXTENSION = "EXT_modal_dynamics"
WIND = Wind(mean_speed_m_s=8.0, gustiness=0.5, seed=3)
FRAME_S, FRAMES = 1 / 60, 1200
ALLOWED_PERCENT = 1e-3
"""Distance of vertices in float32 from the linear model, in % of the height."""

sys.path.insert(0, str(REPOSITORY / "spec/player"))
reference: Any = importlib.import_module("reference_modal_dynamics")
has_babylon = pytest.mark.skipif(
    not (REPOSITORY / "node_modules/@babylonjs/loaders").exists() or not shutil.which("node"),
    reason="needs the page's node_modules",
)


@dataclass(frozen=True)
class Live:
    """A live export, and the linear model of its table."""

    path: Path
    told: dict[str, Any]
    table: Table
    model: LiveModel

    @property
    def document(self) -> dict[str, Any]:
        return Glb(self.path).document

    def vertices(self, weights: Any) -> Any:
        """(v, 3) what the linear model draws."""
        rest_m = Glb(self.path).attribute("POSITION").astype(np.float64)
        rows = vertex_rows(self.table, rest_m)[:, :, self.told["modes"]]
        return rest_m + rows @ (weights * np.array(self.told["scale_m"]))

    def percent(self, found: Any, expected: Any) -> float:
        apart_m = np.linalg.norm(np.asarray(found) - expected, axis=1).max()
        return 100 * float(apart_m) / float(self.table.metadata["height_m"])


@pytest.fixture(scope="module")
def live(tmp_path_factory: pytest.TempPathFactory) -> Live:
    folder, table = tmp_path_factory.mktemp("live"), decode(SHIPPED.read_bytes())
    options = ExportOptions(wind=WIND, seconds=2.0, fps=12.0)
    told = write_export(table, SHIPPED.with_suffix(".glb").read_bytes(), "live", folder, "tree", options)
    model = live_model(table, np.array(told["modes"]), np.array(told["scale_m"]))
    return Live(folder / "tree.glb", told, table, model)


def gusty_winds() -> Any:
    """(FRAMES, 2) a wind that rises, turns and falls beyond what the table has sampled, m/s."""
    time_s = np.arange(FRAMES) * FRAME_S
    speed = 8.0 * (1.0 + 0.5 * np.sin(0.7 * time_s) + 0.3 * np.sin(2.3 * time_s))
    speed[900:] *= 2.0
    heading = 0.5 + 0.6 * np.sin(0.4 * time_s)
    return np.stack([speed * np.cos(heading), speed * np.sin(heading)], axis=1)


def in_babylon(live: Live, folder: Path, **request: Any) -> dict[str, Any]:
    path = folder / "request.json"
    path.write_text(json.dumps({"frame_s": FRAME_S, "frames": FRAMES, "vertices": [], **request}))
    done = subprocess.run(
        ["node", str(PLAYER), str(live.path), str(path)], capture_output=True, text=True, cwd=REPOSITORY
    )
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@has_babylon
@pytest.mark.parametrize("event", [None, "galewood_wind"])
def test_babylon_moves_the_tree_as_the_linear_model(live: Live, tmp_path: Path, event: str | None) -> None:
    """By variables and by the event, 20 s in a wind that the program gives it."""
    winds = gusty_winds()
    vertices = np.linspace(0, live.table.metadata["primitives"][0]["vertices"] - 1, 200).astype(int).tolist()
    found = in_babylon(live, tmp_path, winds=winds.tolist(), vertices=vertices, event=event)
    weights = np.array(found["weights"])
    assert weights.shape == (FRAMES, len(live.document["meshes"]), len(live.told["modes"]))
    assert np.array_equal(weights, np.repeat(weights[:, :1], weights.shape[1], axis=1))
    expected = live.model.played(winds, FRAME_S)
    assert np.abs(expected).max() > 0.5
    np.testing.assert_allclose(weights[:, 0], expected, rtol=0, atol=1e-9)
    assert found["playing"] == 0, "the loop stands still, as the graph moves the tree"
    drawn = live.vertices(expected[-1])[vertices]
    assert live.percent(found["places"], drawn) < ALLOWED_PERCENT


@has_babylon
def test_babylon_makes_the_gusts_of_the_file(live: Live, tmp_path: Path) -> None:
    found = in_babylon(live, tmp_path)
    gusts = live_gusts(WIND, float(live.table.metadata["height_m"]))
    winds = np.array([gusts.at(FRAME_S * (k + 1)) for k in range(FRAMES)])
    expected = live.model.played(winds, FRAME_S)
    np.testing.assert_allclose(np.array(found["weights"])[:, 0], expected, rtol=0, atol=1e-9)
    assert expected[FRAMES // 2 :].std(axis=0).max() > 0.05


def test_the_gusts_of_the_file_are_the_cosine_wind_of_the_document() -> None:
    field, gusts = WindField(WIND), live_gusts(WIND, WIND.reference_height_m)
    for time_s in (0.0, 1.7, 33.3, 1234.5):
        x, z = np.zeros((2, 1))
        field.velocity(np.zeros(1), np.zeros(1), time_s, x, z)
        np.testing.assert_allclose(gusts.at(time_s), (x[0], z[0]), rtol=1e-9)


def test_the_player_of_the_extension_agrees_with_the_linear_model(live: Live) -> None:
    asset = reference.Asset.read(str(live.path))
    winds = gusty_winds()
    expected = live.model.played(winds, FRAME_S)
    for frame, wind in enumerate(winds):
        asset.advance(FRAME_S, wind)
        np.testing.assert_allclose(asset.models[0].shown, expected[frame], rtol=0, atol=1e-9)
    found = np.concatenate([asset.vertices(node) for node in asset.moved()])
    assert live.percent(found, live.vertices(expected[-1])) < ALLOWED_PERCENT


def test_without_a_wind_the_player_makes_the_gusts_of_the_file(live: Live) -> None:
    asset = reference.Asset.read(str(live.path))
    gusts = live_gusts(WIND, float(live.table.metadata["height_m"]))
    for frame in range(100):
        asset.advance(0.1)
        np.testing.assert_allclose(asset.models[0].own_wind(), gusts.at(0.1 * (frame + 1)), atol=1e-9)
    assert np.abs(asset.models[0].shown).max() > 0.01


def test_the_model_is_the_linear_part_of_the_table() -> None:
    """Without drag, polynomials and gusts within the crown, the table steps as the live model."""
    table = decode((GOLDEN_FOLDER / "pole-linear.safetensors").read_bytes())
    nothing = {
        "modal_drag_point": table.modal_drag_point[:0],
        "modal_drag_shape": table.modal_drag_shape[:, :0],
    }
    bare = copy.copy(table)
    for name, value in {**nothing, "modal_drag_place": table.modal_drag_place[:0]}.items():
        object.__setattr__(bare, name, value)
    modes = np.arange(len(table.modal_step))
    model = live_model(bare, modes, np.ones(len(modes)))
    assert not model.drag.any()
    wind = Wind(mean_speed_m_s=5.0, gustiness=0.5, height_exponent=0.0)
    field, gusts, dt_s = WindField(wind), live_gusts(wind, 4.0), model.dt_s
    tree = WindDrivenTrees(bare, [[0.0, 0.0, 0.0, 1.0]])
    times_s = [dt_s * (k + 1) for k in range(300)]
    expected = model.played(np.array([gusts.at(time_s) for time_s in times_s]), dt_s)
    for k, time_s in enumerate(times_s):
        tree.step(field, time_s, dt_s * (1 + 1e-12))
        np.testing.assert_allclose(tree.q[0], expected[k], rtol=0, atol=1e-6 * np.abs(expected).max())


def test_the_damping_by_the_air_is_that_of_the_drag_points(live: Live) -> None:
    """Against the table's law, differentiated numerically and averaged over the directions of the wind."""
    table, d = live.table, len(live.table.modal_step)
    area, share = table.modal_drag_point.astype(float).T
    shape, n = table.modal_drag_shape.astype(float), table.streamlined_exponent
    mode = 0
    assert live.told["modes"][mode] < drag_inputs(d)
    tip = shape[:, :, live.told["modes"][mode]]
    strength = share * float(dynamic_pressure(8.0, n))
    speed = 5.0 * (strength / 15.0) ** (1.0 / np.where(strength <= 15.0, 2.0, n))

    def force(u: float, angle: float) -> float:
        ahead = np.stack([np.cos(angle) * speed, 0 * speed, np.sin(angle) * speed]) - tip * u
        size = np.linalg.norm(ahead, axis=0)
        pressed = np.where(size <= 5.0, 0.6 * size**2, 15.0 * (np.maximum(size, 1e-9) / 5.0) ** n)
        return float((area * (pressed / size * ahead * tip).sum(axis=0)).sum())

    angles = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)
    slopes = [(force(-1e-4, angle) - force(1e-4, angle)) / 2e-4 for angle in angles]
    mean = float((area * strength / speed).sum() / area.sum())
    rest = 4 / 3 * mean * float(table.modal_drag_rest[live.told["modes"][mode]])
    kappa = float(dynamic_pressure(8.0, n)) / 8.0
    assert kappa * live.model.drag[mode] == pytest.approx(np.mean(slopes) + rest, rel=1e-3)


def test_storms_do_not_tear_the_tree(live: Live) -> None:
    """The drag, which is added step by step, stays stable in the strongest wind of a document."""
    winds = np.zeros((3000, 2))
    winds[:1500, 0] = 60.0
    weights = live.model.played(winds, live.model.dt_s)
    steady = weights[1400:1500]
    assert np.ptp(steady, axis=0).max() < 1e-3 * np.abs(steady).max()
    assert np.abs(weights[-1]).max() < np.abs(steady).max()


def test_the_loop_needs_no_extension(live: Live) -> None:
    document = live.document
    assert set(document["extensionsUsed"]) >= {"KHR_interactivity", EXTENSION}
    assert not {"KHR_interactivity", EXTENSION} & set(document.get("extensionsRequired", []))
    (animation,) = document["animations"]
    assert animation["name"] == "tree_sway"
    assert {channel["target"]["path"] for channel in animation["channels"]} == {"weights"}
    assert live.told["measured"]["loop_error_percent_of_height"] < 8.0


def test_the_description_states_the_distance_from_the_table(live: Live) -> None:
    measured = live.told["measured"]
    assert 0.2 < measured["live_rms_percent_of_height"] < 0.06 * measured["sway_percent_of_height"]
    assert measured["live_error_percent_of_height"] < 0.3 * measured["sway_percent_of_height"]


def test_the_graph_keeps_the_rules_of_its_specification(live: Live) -> None:
    """Values come from nodes before, flows lead to nodes behind, and no declaration is unused."""
    graph = live.document["extensions"]["KHR_interactivity"]["graphs"][0]
    nodes, used = graph["nodes"], set[int]()
    for index, node in enumerate(nodes):
        used.add(node["declaration"])
        for given in node.get("values", {}).values():
            assert ("node" in given) != ("value" in given)
            assert given.get("node", -1) < index
            assert given.get("type", 0) < len(graph["types"])
        for flow in node.get("flows", {}).values():
            assert index < flow["node"] < len(nodes)
    assert used == set(range(len(graph["declarations"])))
    names = [variable["extras"]["name"] for variable in graph["variables"]]
    assert names[:2] == ["wind_m_s", "gustiness"] and len(set(names)) == len(names)


def test_by_the_text_of_the_specification_the_graph_makes_the_same_steps(live: Live) -> None:
    """In ticks of unequal length, the first of which has none, in the gusts and then in another wind."""
    graph = Graph(live.document["extensions"]["KHR_interactivity"]["graphs"][0])
    asset = reference.Asset.read(str(live.path))
    graph.tick(0.0, math.nan)
    assert set(graph.weights.values()) == {0.0}
    lengths_s = np.random.default_rng(5).choice([0.004, 1 / 60, 0.05, 0.4], 300)
    wind = None
    for k, dt_s in enumerate(lengths_s.tolist()):
        if k == 150:
            wind = (3.0, -11.0)
            graph.hear(x_m_s=wind[0], z_m_s=wind[1])
        graph.tick(0.0, dt_s)
        asset.advance(dt_s, wind)
        for node in asset.moved():
            found = [graph.weights[f"/nodes/{node}/weights/{i}"] for i in range(len(live.model.drag))]
            np.testing.assert_allclose(found, asset.models[0].shown, rtol=0, atol=1e-9)
    assert np.abs(asset.models[0].shown).max() > 0.1


def test_the_extension_keeps_its_schema(live: Live) -> None:
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    jsonschema.Draft202012Validator.check_schema(schema)
    check = jsonschema.Draft202012Validator(schema)
    about = live.document["extensions"][EXTENSION]
    check.validate(about)
    for_nodes = jsonschema.Draft202012Validator({**schema["$defs"]["node"], "$defs": schema["$defs"]})
    for node in live.document["nodes"]:
        for_nodes.validate(node["extensions"][EXTENSION])
    for damage in ({"timeStep": 0}, {"oscillators": []}, {"oscillators": [{"load": [1, 0]}]}):
        assert not check.is_valid({"models": [{**about["models"][0], **damage}]})


POLE: dict[str, Any] = {
    "extensions": {
        EXTENSION: {
            "models": [
                {
                    "timeStep": 0.025,
                    "oscillators": [{"angularFrequency": 3.0, "dampingRatio": 0.1, "load": [0.5, 0]}],
                }
            ]
        }
    },
    "nodes": [
        {
            "translation": [1, 2, 3],
            "extensions": {EXTENSION: {"model": 0, "translation": [[0.2, 0, 0]], "rotation": [[0, 0, -0.3]]}},
        }
    ],
}


def test_a_joint_swings_as_the_exact_solution() -> None:
    """A step of wind: e(t) = p/ω² (1 − e^(−ζωt) (cos νt + ζω/ν sin νt))."""
    asset, w, z, load = reference.Asset(POLE), 3.0, 0.1, 0.5 * 0.6 * 4.0**2
    v = w * np.sqrt(1 - z * z)
    for step in range(1, 200):
        asset.advance(0.025, (4.0, 0.0))
        t = 0.025 * step
        exact = load / w**2 * (1 - np.exp(-z * w * t) * (np.cos(v * t) + z * w / v * np.sin(v * t)))
        assert asset.models[0].e[0] == pytest.approx(exact, abs=1e-9)
    shown = float(asset.models[0].shown[0])
    place, turn = asset.pose(0)
    np.testing.assert_allclose(place, [1 + 0.2 * shown, 2, 3])
    np.testing.assert_allclose(turn, [0, 0, np.sin(-0.15 * shown), np.cos(-0.15 * shown)], atol=1e-12)


def test_the_player_refuses_what_the_extension_does() -> None:
    both, growing, short = (copy.deepcopy(POLE) for _ in range(3))
    oscillator = both["extensions"][EXTENSION]["models"][0]["oscillators"][0]
    oscillator["step"] = [0, 0, 0, 0, 0, 0]
    growing["extensions"][EXTENSION]["models"][0]["oscillators"] = [
        {"step": [0.1, 0, 0, 0, 0, 0], "load": [0, 0]}
    ]
    short["nodes"][0]["extensions"][EXTENSION]["rotation"] = []
    for damaged, message in ((both, "either"), (growing, "contract"), (short, "one target")):
        with pytest.raises(ValueError, match=message):
            reference.Asset(damaged)

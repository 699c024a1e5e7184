"""The motion of an exported GLB, evaluated as in a glTF viewer, against the table."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from galewood.io.export import ExportError, ExportOptions, write_export
from galewood.io.export.looped import looped
from galewood.motion.wind import Wind, WindField
from galewood.player import PERIOD_START_S, WindDrivenTrees
from galewood.table.format import Table, decode
from galewood.tree.render_mesh import render_glb
from galewood.tree.types import RenderPrimitive, TreeMesh

from tests.golden import GOLDEN_FOLDER

GOLDEN = GOLDEN_FOLDER / "pole.safetensors"
GUSTY = Wind(mean_speed_m_s=9.0, gustiness=0.8)
WIDTH = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}


@pytest.fixture(scope="module")
def table() -> Table:
    return decode(GOLDEN.read_bytes())


@pytest.fixture(scope="module")
def mesh(table: Table) -> bytes:
    """A mesh with vertices at their nodes; its faces are arbitrary."""
    primitives: list[RenderPrimitive] = []
    for described, nodes in zip(table.metadata["primitives"], nodes_by_mesh(table), strict=True):
        first = np.arange(len(nodes) - 2, dtype=np.int32)
        faces = np.stack([first, first + 1, first + 2], axis=1)
        places = table.node_rest_m[nodes].astype(np.float64)
        primitives.append(RenderPrimitive(described["name"], described["kind"], places, faces))
    empty = np.zeros((0, 3))
    return render_glb(TreeMesh(primitives, empty, empty.astype(np.int32), 4.0, None, {}))


def nodes_by_mesh(table: Table) -> list[Any]:
    counts = [int(primitive["vertices"]) for primitive in table.metadata["primitives"]]
    return np.split(table.vertex_node, np.cumsum(counts)[:-1])


def read(glb: bytes) -> tuple[dict[str, Any], Any]:
    """The JSON document and a reader of its accessors, according to the glTF 2.0 specification."""
    assert glb[:4] == b"glTF"
    assert int.from_bytes(glb[8:12], "little") == len(glb)
    size = int.from_bytes(glb[12:16], "little")
    document, start = json.loads(glb[20 : 20 + size]), 28 + size
    assert int.from_bytes(glb[20 + size : 24 + size], "little") >= document["buffers"][0]["byteLength"]

    def accessor(index: int) -> Any:
        about = document["accessors"][index]
        view = document["bufferViews"][about["bufferView"]]
        assert view["byteOffset"] % 4 == 0
        width = WIDTH[about["type"]]
        values = np.frombuffer(glb, "<f4", about["count"] * width, start + view["byteOffset"])
        assert values.nbytes == view["byteLength"]
        values = values.reshape(-1, width)
        assert np.allclose(values.min(axis=0), about["min"])
        assert np.allclose(values.max(axis=0), about["max"])
        return values

    return document, accessor


@pytest.mark.parametrize("closed", [True, False])
def test_every_frame_of_the_animation_matches_the_table(
    table: Table, mesh: bytes, tmp_path: Path, closed: bool
) -> None:
    options = ExportOptions(wind=GUSTY, seconds=3.0, fps=20.0, loop=closed)
    told = write_export(table, mesh, "glb", tmp_path, "pole", options)
    assert told["loop"] == closed
    assert ("seam_percent_of_height" in told["measured"]) == closed
    q = looped(table, GUSTY, 3.0, 20.0, closed=closed).keys()
    document, accessor = read((tmp_path / "pole.glb").read_bytes())
    animation = document["animations"][0]
    assert animation["name"] == "pole_sway"
    time = accessor(animation["samplers"][0]["input"])[:, 0]
    weights = accessor(animation["samplers"][0]["output"]).reshape(len(time), -1)
    assert np.allclose(time, np.arange(61) / 20, atol=1e-5)
    assert np.array_equal(weights[0], weights[-1]) == closed
    moved = {channel["target"]["node"] for channel in animation["channels"]}
    assert moved == set(range(len(document["nodes"])))
    largest = 0.0
    for of_mesh, node in zip(document["meshes"], nodes_by_mesh(table), strict=True):
        primitive = of_mesh["primitives"][0]
        targets = np.stack([accessor(target["POSITION"]) for target in primitive["targets"]])
        for frame in range(0, len(q), 7):
            shown = np.tensordot(weights[frame], targets, 1)
            exact = table.node_basis[node] @ q[frame]
            largest = max(largest, float(np.abs(exact).max()))
            assert np.abs(shown - exact).max() < 1e-3 * largest + 1e-3
    assert largest > 0.01


def test_without_a_loop_the_motion_is_what_the_player_shows(table: Table) -> None:
    """From the same moment of the wind at which a loop begins, with the pose at the end."""
    loop = looped(table, GUSTY, 2.0, 30.0, closed=False)
    tree, field, dt_s = (
        WindDrivenTrees(table, [[0.0, 0.0, 0.0, 1.0]]),
        WindField(GUSTY),
        table.metadata["dt_s"],
    )
    first = round(PERIOD_START_S / dt_s)
    shown = list[Any]()
    for k in range(first + len(loop.steps) + 1):
        tree.step(field, dt_s * (k + 1), dt_s * (1 + 1e-12))
        shown.append(tree.q[0].copy())
    assert np.array_equal(loop.steps, shown[first:-1])
    assert np.array_equal(loop.end, shown[-1])
    assert np.array_equal(loop.keys()[-1], shown[-1])
    assert loop.seconds == pytest.approx(2.0)


def test_the_mesh_of_another_tree_is_refused(table: Table, mesh: bytes, tmp_path: Path) -> None:
    other = decode(GOLDEN.read_bytes())
    other.metadata["primitives"][0]["vertices"] += 1
    short = ExportOptions(seconds=1.0)
    with pytest.raises(ExportError, match="vertices of the mesh differ"):
        write_export(other, mesh, "glb", tmp_path, "pole", short)
    for junk in (b"", b"glTF", mesh[:40], b"PK" + mesh[2:]):
        with pytest.raises(ExportError):
            write_export(table, junk, "glb", tmp_path, "pole", short)

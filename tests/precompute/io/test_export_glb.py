"""The motion of an exported GLB, evaluated as in a glTF viewer, against the table."""

import json
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from galewood.io.export import ExportError, animated_glb, coordinates_in_wind, recorded_coordinates
from galewood.motion.wind.evaluation import Wind
from galewood.table.format import Table, decode
from galewood.tree.render_mesh import render_glb
from galewood.tree.types import RenderPrimitive, TreeMesh

from tests.golden import GOLDEN_FOLDER

GOLDEN = GOLDEN_FOLDER / "pole.safetensors"
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


def test_every_frame_of_the_animation_matches_the_table(table: Table, mesh: bytes) -> None:
    q = coordinates_in_wind(table, Wind(mean_speed_m_s=9.0, gustiness=0.8), 3.0)
    document, accessor = read(animated_glb(table, mesh, q))
    animation = document["animations"][0]
    time = accessor(animation["samplers"][0]["input"])[:, 0]
    weights = accessor(animation["samplers"][0]["output"]).reshape(len(time), -1)
    assert np.allclose(np.diff(time), table.metadata["dt_s"], atol=1e-6)
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


def test_a_loop_has_no_seam(table: Table) -> None:
    q = coordinates_in_wind(table, Wind(mean_speed_m_s=9.0, gustiness=0.8), 4.0, loop=True)
    steps = np.abs(np.diff(q, axis=0)).max()
    assert np.abs(q[-1] - q[0]).max() < 1e-12
    assert np.abs(q[1] - q[-2]).max() < 3 * steps
    assert np.abs(np.diff(q[[-2, -1]], axis=0)).max() < 2 * steps


def test_a_sampled_run_has_the_poses_of_the_table(table: Table) -> None:
    named = {**table.records.metadata, "winds": ["still", "breeze"]}
    table = replace(table, paper=replace(table.records, metadata=named))
    q = recorded_coordinates(table, "breeze")
    first, last = int(table.records.trajectory[1]), int(table.records.trajectory[2])
    assert np.array_equal(q, table.recorded_q_m[first:last])
    with pytest.raises(KeyError, match="no run"):
        recorded_coordinates(table, "hurricane")


def test_the_mesh_of_another_tree_is_refused(table: Table, mesh: bytes) -> None:
    other = decode(GOLDEN.read_bytes())
    other.metadata["primitives"][0]["vertices"] += 1
    with pytest.raises(ExportError, match="vertices of the mesh differ"):
        animated_glb(other, mesh, np.zeros((2, len(table.mode_scale))))
    for junk in (b"", b"glTF", mesh[:40], b"PK" + mesh[2:]):
        with pytest.raises(ExportError):
            animated_glb(table, junk, np.zeros((2, len(table.mode_scale))))

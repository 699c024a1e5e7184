"""End-to-end tests with real processes: builds, a cancelled one, and crashes of workers and servers."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import httpx
import msgpack
import numpy as np
import psutil
import pytest
from galewood.pipeline.sampling.recording import is_whole
from galewood.table import format as table_format
from galewood_server.stream import wire

from tests.server.api.test_rest_api import assert_problem, progress, upload
from tests.server.jobs.test_jobs import gone, state
from tests.server.stream.test_forest_stream import BREEZE, Client
from tests.server.support import sample_meshes
from tests.server.support.server_process import Server, command_line, wait_until

SMALL = {"target_tets": 500, "sampled_elements": 5, "frames": 20}
LONG_S = 600.0  # timeout for steps that take seconds on an idle machine


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    data_dir = tmp_path_factory.mktemp("real") / "data"
    data_dir.mkdir()
    server = Server(data_dir, "galewood_server.cli.main").start("serve")
    yield server
    server.stop()


@pytest.fixture
def api(server: Server) -> Iterator[httpx.Client]:
    with server.client() as client:
        yield client


def begin(api: httpx.Client, height_m: float) -> tuple[dict[str, Any], dict[str, Any]]:
    # A tall pole sways slowly, and its simulation needs few steps.
    pole = sample_meshes.pole_obj(height_m, radius_m=0.03 * height_m)
    answer = upload(api, pole, "pole.obj", species="poplar")
    assert answer.status_code == 201, answer.text
    tree = answer.json()
    return tree, compute(api, tree)


def compute(api: httpx.Client, tree: dict[str, Any]) -> dict[str, Any]:
    """Start the build of a tree; its job."""
    return api.post("/api/jobs", json={"tree_id": tree["id"], "settings": SMALL}).json()


def sampling(api: httpx.Client, job: dict[str, Any]) -> None:
    """Wait until some trajectories are finished, but not all."""
    for now in progress(api, job["id"]):
        assert now["state"] in ("queued", "running"), now["error"]
        if now["stage"] == "sampling" and (now["samples_done"] or 0) >= 2:
            return


def trajectories(server: Server) -> dict[Path, int]:
    folder = server.data_dir / "cache" / "trajectories"
    return {path: path.stat().st_mtime_ns for path in folder.rglob("*.npz")}


def workers(server: Server) -> list[psutil.Process]:
    """Child processes of the cluster process."""
    (cluster,) = [
        one for one in server.family() if "galewood_server.jobs.cluster.dask_cluster" in command_line(one)
    ]
    return [one for one in cluster.children(recursive=True) if "spawn_main" in " ".join(command_line(one))]


def idle(server: Server) -> bool:
    before = trajectories(server)
    busy = sum(one.cpu_percent(0.3) for one in workers(server))
    return busy < 30 and trajectories(server) == before


def cancel(server: Server, api: httpx.Client, job: dict[str, Any]) -> None:
    """Cancel a job that simulates: its process ends, and so do its simulations."""
    running = [one for one in server.family() if job["id"] in command_line(one)]
    api.post(f"/api/jobs/{job['id']}/cancel")
    wait_until(lambda: state(api, job) == "cancelled" and gone(running), LONG_S)
    wait_until(lambda: idle(server), LONG_S)
    assert len(trajectories(server)) < 36  # the build has not finished


@pytest.mark.long
@pytest.mark.timeout(1800)
def test_a_build_survives_a_cancel_and_worker_cluster_and_server_crashes(
    server: Server, api: httpx.Client
) -> None:
    tree, job = begin(api, 12.0)
    sampling(api, job)
    cancel(server, api, job)
    before = trajectories(server)
    job = compute(api, tree)
    wait_until(lambda: len(trajectories(server)) > len(before), LONG_S)
    workers(server)[0].kill()
    finished = trajectories(server) | before  # the earlier time of each
    wait_until(lambda: len(trajectories(server)) > len(finished), LONG_S)
    finished = trajectories(server) | finished
    (cluster,) = [
        one for one in server.family() if "galewood_server.jobs.cluster.dask_cluster" in command_line(one)
    ]
    cluster.kill()  # including its scheduler
    wait_until(lambda: len(trajectories(server)) > len(finished), LONG_S)
    finished = trajectories(server) | finished
    family = server.family()
    server.kill()
    wait_until(lambda: gone(family), LONG_S)
    server.start("serve")
    pictures, states = follow(api, tree["id"], job["id"])
    assert api.get(f"/api/jobs/{job['id']}").json()["state"] == "done"
    later = trajectories(server)
    assert {path: later[path] for path in finished} == finished  # none was computed twice
    assert all(is_whole(path) for path in later)
    assert "preliminary" in states
    for name in pictures:
        picture = api.get(f"/api/jobs/{job['id']}/pictures/{name}")
        assert picture.content.startswith(b"\x89PNG") and picture.headers["content-type"] == "image/png"
    assert set(pictures) == {"tetrahedra.png", "skeleton.png"}
    tree = api.get(f"/api/trees/{tree['id']}").json()
    assert tree["state"] == "ready"
    json.dumps(tree["report"], allow_nan=False)
    table = table_format.decode(api.get(f"/api/tables/{tree['table_sha256']}").content)
    assert table.metadata["mesh_sha256"] == tree["mesh_sha256"]
    assert api.get(f"/api/meshes/{tree['mesh_sha256']}").content[:4] == b"glTF"
    assert_sways(server, tree["table_sha256"])
    assert_compares(api, tree, table)
    assert_evaluates(api, server, tree, table)


def follow(api: httpx.Client, tree_id: str, job_id: str) -> tuple[dict[str, str], set[str]]:
    """The job's final pictures and the states of its tree until then."""
    states: set[str] = set()
    pictures: dict[str, str] = {}
    for now in progress(api, job_id):
        states.add(api.get(f"/api/trees/{tree_id}").json()["state"])
        pictures = now["pictures"]
    return pictures, states


def assert_compares(api: httpx.Client, tree: dict[str, Any], table: table_format.Table) -> None:
    """A comparison finishes, its tracks are valid, and the modal model is close to the reference solution."""
    place = {"x_m": 3.0, "z_m": -2.0, "yaw_rad": 0.7, "frames": 90}
    answer = api.post(
        f"/api/trees/{tree['id']}/comparisons",
        json={"wind": BREEZE | {"model": "perlin", "length_scale_m": 24.0}, **place},
    )
    assert answer.status_code == 202, answer.text
    url = answer.headers["location"]
    wait_until(lambda: api.get(url).json()["state"] not in ("queued", "running"), LONG_S, 0.5)
    found = api.get(url).json()
    assert found["state"] == "done", found["error"]
    tracks = msgpack.unpackb(api.get(found["tracks"]).content)
    assert (tracks["format"], tracks["version"], tracks["frames"]) == ("galewood-comparison", 1, 90)
    shape = (90, tracks["modes"])
    q = {name: np.frombuffer(data, "<f4").reshape(shape) for name, data in tracks["tracks"].items()}
    basis = table.node_basis.astype(np.float64)
    shown = {name: np.einsum("nik,tk->tni", basis, track) / tracks["height_m"] for name, track in q.items()}
    gap = np.linalg.norm(shown["modal"] - shown["fem"], axis=2).max(axis=1)
    told, left_out = np.array(tracks["error"]["modal"]["max"]), np.array(tracks["left_out"])
    assert np.all(np.abs(gap - told) <= left_out + 1e-6)
    sway = np.linalg.norm(shown["fem"], axis=2).max()
    assert abs(sway - max(tracks["sway"])) <= left_out.max() + 1e-6
    assert found["result"]["max_error"]["modal"] < 0.5 * found["result"]["reference_sway"]
    uniform = tracks["uniform"]
    assert [len(uniform["sway"]), len(uniform["error"]["modal"]["max"])] == [90, 90]
    assert found["result"]["uniform"]["max_error"]["modal"] == max(uniform["error"]["modal"]["max"])
    assert max(uniform["error"]["modal"]["max"]) < 0.25 * max(uniform["sway"])
    assert tracks["sway"] != uniform["sway"]  # the gusts of a breeze differ within the crown


def assert_evaluates(
    api: httpx.Client, server: Server, tree: dict[str, Any], table: table_format.Table
) -> None:
    """An evaluation finishes and reuses the existing training runs."""
    before = trajectories(server)
    answer = api.post(f"/api/trees/{tree['id']}/evaluations", json={"speed_m_s": 4.0, "frames": 60})
    assert answer.status_code == 202, answer.text
    url = answer.headers["location"]
    wait_until(lambda: api.get(url).json()["state"] not in ("queued", "running"), LONG_S, 0.5)
    found = api.get(url).json()
    assert found["state"] == "done", found["error"]
    assert trajectories(server) == before  # none was computed twice
    report = api.get(found["report"]).json()
    assert report["frames"] == 60 and len(report["uniform"]) == 7
    assert list(report["gusts"]) == ["7 m/s", "18 m/s", "10 % sway", "20 % sway"]
    for wind, case in report["gusts"].items():
        shown = found["result"]["gusts"][wind]
        assert shown["sway"] == case["reference_sway"] > 0
        assert shown["methods"]["modal"]["branches"] == case["modal"]["branches"]
        assert shown["methods"]["modal"]["max_error"] == max(case["modal"]["error_by_frame"])
    assert report["design_speed_m_s"] == table.metadata["design_speed_m_s"]
    for wind, figures in report["uniform"].items():
        shown = found["result"]["uniform"][wind]
        assert shown["sway"] == figures["rest-pose"]["reference_sway"] > 0
        once = wind in ("step", "gust-then-still", "square-at-first-frequency")
        assert len(figures["modal"]["error_by_frame"]) == (60 if once else 90)
        assert shown["methods"]["modal"]["max_error"] == max(figures["modal"]["error_by_frame"])
        # the error of a tree at rest is its full sway
        assert shown["methods"]["rest-pose"]["max_error"] == pytest.approx(shown["sway"], rel=1e-6)
        assert shown["methods"]["modal"]["max_error"] < 0.5 * shown["sway"]
    picture = api.get(found["plot"])
    assert picture.content.startswith(b"\x89PNG") and picture.headers["content-type"] == "image/png"
    assert not list((server.data_dir / "cache" / "analyses").glob("*"))


def assert_sways(server: Server, table_sha256: str) -> None:
    rows = np.array([[0, 0, 0, 1], [30, 5, 2, 0.8]], np.float32)
    groups = (wire.Group(table_sha256, 2),)
    with Client(server) as client:
        client.send(wire.Forest("stream", groups, BREEZE, 0.0, None, rows))
        assert any(
            poses[0].any() for _, poses in zip(range(90), (p for _, p in client.frames()), strict=False)
        )


def test_builtin_trees_are_registered_and_computed_once(
    start_server: Callable[..., Server], tmp_path: Path
) -> None:
    folder = tmp_path / "species"
    folder.mkdir()
    (folder / "small.obj").write_bytes(sample_meshes.pole_obj(3.0))
    entry = {"id": "small", "name": "Small", "file": "small.obj", "species": "maple", "height_m": 3.0}
    (folder / "species.json").write_text(json.dumps([entry]))
    environment = {"GALEWOOD_BUILTIN_TREES": "true", "GALEWOOD_SPECIES_DIR": str(folder)}
    environment |= {"GALEWOOD_SCHEDULER_URL": "tcp://127.0.0.1:9"}
    server = start_server(FAKE_STEP_S="0.01", **environment)
    with server.client() as api:
        wait_until(lambda: api.get("/api/trees/small").json().get("state") == "ready", LONG_S)
        first = api.get("/api/trees/small").json()
        assert first["builtin"] and first["species"] == "maple"
        # The tree is ready before its job has ended; an unfinished job would go on with the changed mesh.
        wait_until(lambda: api.get(f"/api/jobs/{first['job_id']}").json()["state"] == "done", LONG_S)
        assert_problem(api.delete("/api/trees/small"), 403, "builtin-tree")
    server.stop()
    again = start_server(FAKE_STEP_S="0.01", **environment)
    with again.client() as api:
        assert api.get("/api/trees/small").json()["job_id"] == first["job_id"]
    again.stop()
    (folder / "small.obj").write_bytes(sample_meshes.pole_obj(3.1))
    (tmp_path / "data" / "cache" / "steps-small.obj").unlink()
    changed = start_server(FAKE_STEP_S="0.01", **environment)
    with changed.client() as api:
        wait_until(lambda: api.get("/api/trees/small").json()["job_id"] != first["job_id"], LONG_S)

"""Exports of computed trees over REST."""

from __future__ import annotations

import gzip
import io
import json
import zipfile
from collections.abc import Callable
from pathlib import Path

import httpx
import pytest
from galewood.pipeline.results import BuildResult, ShippedTree, build_key, write_shipped

from tests.golden import GOLDEN_FOLDER
from tests.server.support.server_process import NO_CLUSTER, REPOSITORY, Server

StartServer = Callable[..., Server]
SHIPPED = REPOSITORY / "assets" / "species" / "shipped"
SOURCE = b"mesh of a small tree"
SHORT = {"seconds": "1", "fps": "10"}


COMPLIANCE = gzip.decompress((SHIPPED / "apricot-forest.compliance.gz").read_bytes())


@pytest.fixture
def server(start_server: StartServer, tmp_path: Path) -> Server:
    return with_one_tree(start_server, tmp_path, COMPLIANCE)


def with_one_tree(start_server: StartServer, tmp_path: Path, compliance: bytes | None) -> Server:
    """A server with one computed tree, "small"."""
    folder = tmp_path / "species"
    folder.mkdir()
    small = {"id": "small", "name": "Small", "file": "small.obj", "species": "apricot", "height_m": 12.0}
    (folder / "small.obj").write_bytes(SOURCE)
    (folder / "species.json").write_text(json.dumps([small]))
    tree = ShippedTree(
        BuildResult(
            table=(SHIPPED / "apricot-forest.table").read_bytes(),
            records=(GOLDEN_FOLDER / "pole-records.safetensors").read_bytes(),
            render_glb=(SHIPPED / "apricot-forest.glb").read_bytes(),
            report={},
            compliance=compliance,
        ),
        tets=b"tetrahedra",
        tets_name="tets-abc.npz",
    )
    key = build_key(SOURCE, {"species": "apricot", "height_m": 12})
    write_shipped(folder / "shipped", "small", key, tree)
    environment = {"GALEWOOD_BUILTIN_TREES": "true", "GALEWOOD_SPECIES_DIR": str(folder)}
    return start_server(FAKE_STEP_S="0.01", **environment, **NO_CLUSTER)


def test_an_export_is_made_once_and_kept_and_what_cannot_be_exported_is_said(server: Server) -> None:
    with server.client() as api:
        address = "/api/trees/small/exports"
        assert problem(api.get(f"{address}/fbx")) == (422, "invalid-request")
        assert problem(api.get(f"{address}/vat", params={"seconds": "0"})) == (422, "invalid-request")
        assert problem(api.get(f"{address}/vat", params={"speed": "3"})) == (422, "unknown-parameter")
        long = {"seconds": "120", "fps": "60"}
        assert problem(api.get(f"{address}/vat", params=long)) == (422, "invalid-request")
        assert problem(api.get(f"{address}/vat", params={"wind": "hurricane"})) == (422, "bad-wind")
        assert problem(api.get(f"{address}/vat", params={"wind": '{"version": 1}'})) == (422, "bad-wind")
        assert problem(api.get("/api/trees/nobody/exports/vat"))[0] == 404

        answer = api.get(f"{address}/bones", params=SHORT, timeout=120)
        assert answer.status_code == 200, answer.text
        assert answer.headers["content-type"] == "application/zip"
        assert 'filename="Small-bones.zip"' in answer.headers["content-disposition"]
        with zipfile.ZipFile(io.BytesIO(answer.content)) as files:
            assert set(files.namelist()) == {"Small.glb", "Small.json", "Small.wind.json"}
            told = json.loads(files.read("Small.json"))
        assert told["frames"] == 10
        assert told["measured"]["seam_percent_of_height"] < 0.05
        several = {**SHORT, "winds": "breeze,storm-front", "levels": "2"}
        assert problem(api.get(f"{address}/bones", params={"winds": "breeze,gale"})) == (422, "bad-wind")
        assert problem(api.get(f"{address}/usd", params=several)) == (422, "export-failed")
        (kept,) = (server.data_dir / "cache" / "exports").iterdir()
        written = kept.stat().st_mtime_ns
        again = api.get(f"{address}/bones", params=SHORT)
        assert again.content == answer.content
        assert kept.stat().st_mtime_ns == written
        tag = {"if-none-match": answer.headers["etag"]}
        assert api.get(f"{address}/bones", params=SHORT, headers=tag).status_code == 304


def test_a_rigged_tree_has_a_clip_for_each_wind_and_a_file_for_each_level(server: Server) -> None:
    several = {**SHORT, "winds": "breeze,storm-front", "levels": "2"}
    with server.client() as api:
        answer = api.get("/api/trees/small/exports/bones", params=several, timeout=120)
        assert answer.status_code == 200, answer.text
        with zipfile.ZipFile(io.BytesIO(answer.content)) as files:
            assert set(files.namelist()) == {"Small.glb", "Small_lod1.glb", "Small.json", "Small.wind.json"}
            told = json.loads(files.read("Small.json"))
        assert [clip["animation"] for clip in told["clips"]] == ["Small_breeze", "Small_storm-front"]


def test_pictures_of_a_tree_are_of_the_asked_size(server: Server) -> None:
    with server.client() as api:
        answer = api.get("/api/trees/small/exports/impostor", params={"pixels": "256"}, timeout=120)
        assert answer.status_code == 200, answer.text
        with zipfile.ZipFile(io.BytesIO(answer.content)) as files:
            pictures = {"Small_base_color.png", "Small_normal_depth.png"}
            assert set(files.namelist()) == {"Small.json", *pictures}
            assert json.loads(files.read("Small.json"))["view_pixels"] == 32
        too_large = api.get("/api/trees/small/exports/impostor", params={"pixels": "16384"})
        assert problem(too_large) == (422, "invalid-request")


@pytest.mark.parametrize(("kind", "ending"), [("mjcf", "xml"), ("urdf", "urdf")])
def test_a_tree_of_rigid_bodies_is_fitted_to_its_compliance(server: Server, kind: str, ending: str) -> None:
    with server.client() as api:
        answer = api.get(f"/api/trees/small/exports/{kind}", params={"bones": "12"})
        assert answer.status_code == 200, answer.text
        with zipfile.ZipFile(io.BytesIO(answer.content)) as files:
            assert {f"Small.{ending}", "Small.json"} < set(files.namelist())


@pytest.mark.parametrize("kind", ["mjcf", "urdf"])
def test_a_tree_without_compliance_is_refused_as_rigid_bodies(
    start_server: StartServer, tmp_path: Path, kind: str
) -> None:
    with with_one_tree(start_server, tmp_path, None).client() as api:
        answer = api.get(f"/api/trees/small/exports/{kind}")
        assert problem(answer) == (409, "no-compliance")
        assert kind in answer.json()["title"]
        assert "computation" in answer.json()["hint"]


def problem(answer: httpx.Response) -> tuple[int, str]:
    return answer.status_code, answer.json()["code"]

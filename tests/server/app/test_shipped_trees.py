"""Built-in trees whose tables are distributed with the software."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import httpx
import pytest
from galewood.motion.wind import Wind
from galewood.pipeline.results import BuildResult, ShippedTree, build_key, read_shipped, write_shipped
from galewood.table import decode, encode

from tests.golden import GOLDEN_FOLDER
from tests.server.support.server_process import NO_CLUSTER, Server, wait_until

StartServer = Callable[..., Server]
SOURCE = b"mesh of a small tree"
SHIPPED = ShippedTree(
    BuildResult(
        table=(GOLDEN_FOLDER / "pole-table.safetensors").read_bytes(),
        records=(GOLDEN_FOLDER / "pole-records.safetensors").read_bytes(),
        render_glb=b"glTF of the small tree",
        report={"import": {"species": "maple"}},
    ),
    tets=b"tetrahedra",
    tets_name="tets-abc.npz",
    pictures={"skeleton.png": b"\x89PNG of the skeleton"},
)


def sha256(data: bytes) -> str:
    return hashlib.sha256(data).hexdigest()


@pytest.fixture
def species(tmp_path: Path) -> Path:
    """A folder with one built-in tree and its shipped table."""
    folder = tmp_path / "species"
    folder.mkdir()
    (folder / "small.obj").write_bytes(SOURCE)
    entry = {"id": "small", "name": "Small", "file": "small.obj", "species": "maple", "height_m": 3.0}
    (folder / "species.json").write_text(json.dumps([entry]))
    ship(folder, SOURCE)
    return folder


def ship(folder: Path, source: bytes, shipped: ShippedTree = SHIPPED) -> None:
    write_shipped(folder / "shipped", "small", key_of(source), shipped)


def key_of(source: bytes) -> str:
    return build_key(source, {"species": "maple", "height_m": 3})


def start(start_server: StartServer, species: Path) -> Server:
    environment = {"GALEWOOD_BUILTIN_TREES": "true", "GALEWOOD_SPECIES_DIR": str(species)}
    return start_server(FAKE_STEP_S="0.01", **environment, **NO_CLUSTER)


def test_a_light_mesh_is_served_with_its_pictures(start_server: StartServer, species: Path) -> None:
    """Pictures never change; a mesh is asked for again, as another version may compress it differently."""
    render, light = SHIPPED.result.render_glb, species / "light"
    (light / "pictures").mkdir(parents=True)
    (light / "index.json").write_text(json.dumps({sha256(render): "small.glb"}))
    (light / "small.glb").write_bytes(b"glTF, compressed")
    (light / "pictures" / "maple-bark.0123456789ab.webp").write_bytes(b"WebP")
    with start(start_server, species).client() as api:
        mesh = api.get(f"/api/light-meshes/{sha256(render)}")
        assert (mesh.content, mesh.headers["content-type"]) == (b"glTF, compressed", "model/gltf-binary")
        assert mesh.headers["cache-control"] == "no-cache"
        known = {"if-none-match": mesh.headers["etag"]}
        assert api.get(f"/api/light-meshes/{sha256(render)}", headers=known).status_code == 304
        picture = api.get("/api/light-meshes/pictures/maple-bark.0123456789ab.webp")
        assert (picture.content, picture.headers["content-type"]) == (b"WebP", "image/webp")
        assert "immutable" in picture.headers["cache-control"]
        for other in (
            "pictures/maple-bark.ffffffffffff.webp",
            "pictures/index.json",
            "pictures/..%2Findex.json",
        ):
            assert api.get(f"/api/light-meshes/{other}").status_code == 404
        assert api.get(f"/api/light-meshes/{sha256(b'another')}").status_code == 404


def test_a_shipped_tree_is_ready_at_the_first_request(start_server: StartServer, species: Path) -> None:
    server = start(start_server, species)
    with server.client() as api:
        tree = api.get("/api/trees/small").json()
        assert (tree["state"], tree["report"]) == ("ready", SHIPPED.result.report)
        assert tree["table_sha256"] == sha256(SHIPPED.result.table)
        assert api.get(f"/api/records/{tree['records_sha256']}").content == SHIPPED.result.records
        assert api.get(f"/api/meshes/{tree['mesh_sha256']}").content == SHIPPED.result.render_glb
        light = api.get(f"/api/light-meshes/{tree['mesh_sha256']}")  # none is shipped: the mesh itself
        assert light.content == SHIPPED.result.render_glb
        (job,) = api.get("/api/jobs").json()["jobs"]
        assert (job["state"], job["id"]) == ("done", tree["job_id"])
        picture = api.get(f"/api/jobs/{job['id']}/pictures/skeleton.png")
        assert picture.content == SHIPPED.pictures["skeleton.png"]
        # the same table is not computed again
        assert api.post("/api/jobs", json={"tree_id": "small"}).status_code == 200
    assert (server.data_dir / "cache" / "tets" / "tets-abc.npz").read_bytes() == SHIPPED.tets


def test_a_restart_does_not_install_it_again(start_server: StartServer, species: Path) -> None:
    server = start(start_server, species)
    with server.client() as api:
        before = api.get("/api/trees/small").json()
    server.stop()
    with start(start_server, species).client() as api:
        assert api.get("/api/trees/small").json() == before
        assert api.get("/api/jobs").json()["total"] == 1


def test_another_mesh_is_computed(start_server: StartServer, species: Path) -> None:
    (species / "small.obj").write_bytes(b"another mesh")
    with start(start_server, species).client() as api:
        tree = ready(api)
        assert tree["table_sha256"] == sha256(b"table of another mesh")


def test_a_damaged_shipped_table_is_computed(start_server: StartServer, species: Path) -> None:
    (species / "shipped" / "small.table").write_bytes(b"damaged")
    with start(start_server, species).client() as api:
        assert ready(api)["table_sha256"] == sha256(b"table of " + SOURCE)


def ready(api: httpx.Client) -> dict[str, str]:
    address = "/api/trees/small"
    found: dict[str, str] = wait_until(lambda: (now := api.get(address).json())["state"] == "ready" and now)
    return found


def test_a_shipped_table_replaces_an_older_one(start_server: StartServer, species: Path) -> None:
    ship(species, b"of a later mesh")
    server = start(start_server, species)
    with server.client() as api:
        old = ready(api)
    server.stop()
    (species / "small.obj").write_bytes(b"of a later mesh")
    with start(start_server, species).client() as api:
        tree = api.get("/api/trees/small").json()
        assert tree["table_sha256"] == sha256(SHIPPED.result.table) != old["table_sha256"]
        assert tree["state"] == "ready" and tree["job_id"] != old["job_id"]


def bare_table() -> bytes:
    pole = decode(SHIPPED.result.table)
    return encode(replace(pole, metadata={**pole.metadata, "foliage": "bare"}))


def with_bare_table() -> ShippedTree:
    return replace(SHIPPED, result=replace(SHIPPED.result, bare_table=bare_table()))


def test_shipped_files_have_a_bare_table_or_not(tmp_path: Path) -> None:
    for shipped in (SHIPPED, with_bare_table()):
        write_shipped(tmp_path, "small", "key", shipped)
        assert read_shipped(tmp_path, "small", "key") == shipped
    (tmp_path / "small.bare.table").write_bytes(b"damaged")
    assert read_shipped(tmp_path, "small", "key") is None


def test_a_shipped_bare_table_is_installed_and_served(start_server: StartServer, species: Path) -> None:
    ship(species, SOURCE, with_bare_table())
    with start(start_server, species).client() as api:
        tree = api.get("/api/trees/small").json()
        bare = tree["bare_table_sha256"]
        assert bare == sha256(bare_table()) != tree["table_sha256"] == sha256(SHIPPED.result.table)
        assert api.get(f"/api/tables/{bare}").content == bare_table()
        assert api.get(f"/api/tables/{bare}/metadata").json()["metadata"]["foliage"] == "bare"
        (listed,) = api.get("/api/tables").json()["tables"]
        assert (listed["sha256"], listed["bare_table_sha256"]) == (tree["table_sha256"], bare)


def test_a_built_in_tree_that_is_not_shipped_is_computed_with_and_without_leaves(
    start_server: StartServer, species: Path
) -> None:
    (species / "small.obj").write_bytes(b"another mesh")
    with start(start_server, species).client() as api:
        tree = ready(api)
        # The bare table follows; on a busy machine it may be there before the tree is first seen.
        expected = sha256(b"bare table of another mesh")
        assert tree["form"] == "open" and tree["bare_table_sha256"] in (None, expected)
        bare = wait_until(lambda: api.get("/api/trees/small").json()["bare_table_sha256"])
        assert bare == expected


def test_the_forms_of_a_species_are_trees(start_server: StartServer, species: Path) -> None:
    (entry,) = json.loads((species / "species.json").read_text())
    (species / "slender.obj").write_bytes(b"a slender tree")
    slender = {**entry, "id": "small-forest", "file": "slender.obj", "form": "forest"}
    (species / "species.json").write_text(json.dumps([entry, slender]))
    with start(start_server, species).client() as api:
        trees = {tree["id"]: tree for tree in api.get("/api/trees").json()["trees"]}
        assert {name: (tree["species"], tree["form"]) for name, tree in trees.items()} == {
            "small": ("maple", "open"),
            "small-forest": ("maple", "forest"),
        }


def test_a_shipped_tree_can_be_compared(start_server: StartServer, species: Path) -> None:
    with start(start_server, species).client() as api:
        answer = api.post("/api/trees/small/comparisons", json={"wind": Wind().document()})
        assert answer.status_code == 202, answer.text
        url = answer.headers["location"]
        wait_until(lambda: api.get(url).json()["state"] == "done")
        settings = api.get(url).json()["settings"]
        assert SHIPPED.result.records
        assert settings["records_sha256"] == sha256(SHIPPED.result.records)
        assert settings["model_sha256"] is None

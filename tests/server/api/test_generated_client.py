"""A client that openapi-python-client makes from the OpenAPI document, used with a running service."""

from __future__ import annotations

import io
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from pkgutil import walk_packages
from types import ModuleType
from typing import Any

import httpx
import openapi_python_client
import pytest
from galewood_server.access.keys import new_key
from openapi_python_client.config import Config, ConfigFile, MetaType

from tests.server.support.server_process import FAKE_JOB, FAKE_SERVER, NO_CLUSTER, Server, wait_until

PACKAGE = "generated_galewood_client"
# The generator knows text, JSON, forms and application/octet-stream; it must be told to keep others as bytes.
AS_BYTES = ("application/msgpack", "application/zip", "image/png", "image/webp", "model/gltf-binary")
KEY, KEY_HASH = new_key()
MESH = b"v 0 0 0 of an oak"


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    data_dir = tmp_path_factory.mktemp("generated") / "data"
    data_dir.mkdir()
    fake = {"GALEWOOD_JOB_MODULE": FAKE_JOB, "FAKE_STEP_S": "0.01", **NO_CLUSTER}
    keys = {"GALEWOOD_API_KEYS": KEY_HASH, "GALEWOOD_LOCAL_WRITES": "false"}
    server = Server(data_dir, FAKE_SERVER, {**fake, **keys}).start()
    yield server
    server.stop()


@pytest.fixture(scope="module")
def document(server: Server) -> dict[str, Any]:
    return httpx.get(f"{server.url}/openapi.json").json()


@pytest.fixture(scope="module")
def generated(server: Server, tmp_path_factory: pytest.TempPathFactory) -> Iterator[ModuleType]:
    """The package of the generated client, made without a warning."""
    folder = tmp_path_factory.mktemp("client")
    options = ConfigFile(
        post_hooks=[], content_type_overrides=dict.fromkeys(AS_BYTES, "application/octet-stream")
    )
    address, target = f"{server.url}/openapi.json", folder / PACKAGE
    config = Config.from_sources(options, MetaType.NONE, address, "utf-8", False, target)
    complaints = openapi_python_client.generate(config=config)
    assert [(one.header, one.detail) for one in complaints] == []
    sys.path.insert(0, str(folder))
    yield import_module(PACKAGE)
    sys.path.remove(str(folder))
    for name in [name for name in sys.modules if name.split(".")[0] == PACKAGE]:
        del sys.modules[name]


def operation(name: str) -> Any:
    """The module of an operation, such as "trees.list_trees"."""
    return import_module(f"{PACKAGE}.api.{name}")


def model(name: str) -> Any:
    return getattr(import_module(f"{PACKAGE}.models"), name)


def upload(client: Any, mesh: bytes, **query: Any) -> Any:
    types = import_module(f"{PACKAGE}.types")
    file = types.File(payload=io.BytesIO(mesh), file_name="oak.obj", mime_type="model/obj")
    body = model("UploadTreeBody")(file=file, species="maple", height_m=7.5)
    return operation("trees.upload_tree").sync_detailed(client=client, body=body, **query)


def test_every_operation_has_a_function(generated: ModuleType, document: dict[str, Any]) -> None:
    folder = str(Path(generated.__file__ or "").parent)
    modules = [import_module(one.name) for one in walk_packages([folder], f"{PACKAGE}.")]
    functions = {one.__name__.rpartition(".")[2] for one in modules if hasattr(one, "sync_detailed")}
    described = [one["operationId"] for path in document["paths"].values() for one in path.values()]
    assert functions == set(described) and len(described) > 30


def test_upload_compute_and_download(generated: Any, server: Server) -> None:
    client = generated.AuthenticatedClient(base_url=server.url, token=KEY, raise_on_unexpected_status=True)
    before = operation("trees.list_trees").sync(client=client)
    assert (before.trees, before.total, before.next_) == ([], 0, None)

    answer = upload(client, MESH, build=True)
    tree = answer.parsed
    assert answer.status_code == 201 and answer.headers["location"] == f"/api/trees/{tree.id}"
    assert isinstance(tree, model("TreeOut"))
    assert (tree.name, tree.species, tree.height_m) == ("oak", "maple", 7.5)

    def job() -> Any:
        return operation("jobs.get_job").sync(tree.job_id, client=client)

    done = wait_until(lambda: (now := job()).state.value in ("done", "failed") and now)
    assert (done.state.value, done.fraction, done.tree_id) == ("done", 1.0, tree.id)
    events = operation("events.job_events").sync(done.id, client=client)
    assert "event: progress" in events and '"state":"done"' in events

    ready = operation("trees.get_tree").sync(tree.id, client=client)
    table = operation("artefacts.get_table").sync(ready.table_sha256, client=client)
    mesh = operation("artefacts.get_mesh").sync(ready.mesh_sha256, client=client)
    assert table.payload.read() == b"table of " + MESH
    assert mesh.payload.read() == b"glTF" + MESH
    assert operation("trees.list_trees").sync(client=client).total == 1
    assert upload(client, MESH).status_code == 200


def test_errors_are_problems(generated: Any, server: Server) -> None:
    problem = model("ProblemOut")
    writer = generated.AuthenticatedClient(base_url=server.url, token=KEY, raise_on_unexpected_status=True)
    reader = generated.Client(base_url=server.url, raise_on_unexpected_status=True)
    for answer, expected in (
        (operation("trees.get_tree").sync_detailed("nobody", client=reader), (404, "no-such-tree")),
        (operation("trees.list_trees").sync_detailed(client=reader, limit=0), (422, "invalid-request")),
        (operation("artefacts.get_mesh").sync_detailed("0" * 64, client=reader), (404, "no-such-mesh")),
        (upload(writer, b""), (400, "empty-file")),
        (upload(reader, MESH), (401, None)),
    ):
        assert isinstance(answer.parsed, problem), answer
        assert answer.parsed.status == answer.status_code == expected[0]
        assert answer.parsed.title and answer.parsed.code == (expected[1] or answer.parsed.code)

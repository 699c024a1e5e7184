"""Names of files and trees that cannot be encoded or pretend to be others harm no list of trees."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest

from tests.precompute.fixtures.untrusted_text import NASTY, document_of, glb_of, rich_gltf, with_value
from tests.server.support.server_process import NO_CLUSTER, Server


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    folder = tmp_path_factory.mktemp("names")
    server = Server(folder, "galewood_server.cli.main", dict(NO_CLUSTER)).start("serve")
    with server.client() as client:
        yield client
    server.stop()


@pytest.mark.parametrize("name", [NASTY[0], NASTY[2], NASTY[4]])
def test_a_nasty_name_in_a_file_is_stored_and_listed(api: httpx.Client, name: str) -> None:
    document, binary = document_of(rich_gltf())
    for key in ("nodes", "meshes", "materials"):
        document = with_value(document, (key, 0, "name"), name)
    files = {"file": ("bark\u202egnp.glb", glb_of(document, binary))}
    answer = api.post("/api/trees", files=files)
    assert answer.status_code in (200, 201), answer.text
    tree = answer.json()
    assert "\u202e" not in answer.text
    assert tree["name"] == "bark<U+202E>gnp"
    for path in ("/api/trees", f"/api/trees/{tree['id']}"):
        assert api.get(path).status_code == 200


def test_a_name_given_to_a_tree_cannot_pretend_to_be_another(api: httpx.Client) -> None:
    document, binary = document_of(rich_gltf())
    tree = api.post("/api/trees", files={"file": ("a.glb", glb_of(document, binary))}).json()
    renamed = api.patch(f"/api/trees/{tree['id']}", json={"name": " oak\u202e\u200b "})
    assert renamed.json()["name"] == "oak<U+202E><U+200B>"

"""Choices of pieces and trees over REST, with the real import."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import pytest

from tests.precompute.fixtures.labelled.trees import labelled_file
from tests.server.support.server_process import NO_CLUSTER, Server


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    environment = {**NO_CLUSTER, "GALEWOOD_PREPARE": "true"}  # many imports: loading the readers once pays
    server = Server(tmp_path_factory.mktemp("pieces"), "galewood_server.cli.main", environment).start("serve")
    with server.client() as client:
        yield client
    server.stop()


def test_pieces_can_be_chosen_and_restored(api: httpx.Client) -> None:
    file = labelled_file("pot", 41)
    tree = api.post("/api/trees", files={"file": (file.filename, file.data)}).json()
    pot = next(p for p in tree["report"]["pieces"] if p.get("what") == "pot")
    assert any("pot" in warning for warning in tree["report"]["warnings"])
    path = f"/api/trees/{tree['id']}"
    kept = api.patch(path, json={"wood_parts": [pot["id"]]}).json()
    assert [p["kind"] for p in kept["report"]["pieces"] if p["id"] == pot["id"]] == ["wood"]
    assert kept["mesh_sha256"] != tree["mesh_sha256"]
    restored = api.patch(path, json={"wood_parts": None}).json()
    assert restored["mesh_sha256"] == tree["mesh_sha256"]
    refused = api.patch(path, json={"drop": ["99.0"]})
    assert (refused.status_code, refused.json()["code"]) == (422, "no-such-piece")
    assert pot["id"] in refused.json()["hint"]


def test_nothing_is_computed_before_questions_are_answered_or_accepted(api: httpx.Client) -> None:
    file = labelled_file("garden_scene", 41)
    sent = {"file": (file.filename, file.data)}
    asked = api.post("/api/trees?build=true", files=sent).json()
    assert (asked["state"], asked["job_id"]) == ("uploaded", None)
    assert asked["report"]["needs_review"] and "rock" in asked["report"]["questions"][0]
    accepted = api.post("/api/trees?build=true", files=sent, data={"accept": "true"}).json()
    assert accepted["job_id"] is not None and not accepted["report"]["needs_review"]
    api.post(f"/api/jobs/{accepted['job_id']}/cancel")
    plain = [p["id"] for p in asked["report"]["pieces"] if p["kind"] == "other"]
    answered = api.patch(f"/api/trees/{asked['id']}", json={"drop": plain}).json()
    assert answered["report"]["questions"] == []


def test_every_tree_of_a_file_can_be_an_upload_of_its_own(api: httpx.Client) -> None:
    file = labelled_file("two_trees", 41)
    trees = [
        api.post("/api/trees", files={"file": (file.filename, file.data)}, data={"tree": str(number)}).json()
        for number in (1, 2)
    ]
    assert trees[0]["id"] != trees[1]["id"]
    assert [[t["taken"] for t in tree["report"]["trees"]] for tree in trees] == [[True, False], [False, True]]
    form = {"drop": "w, 1.0", "complete": "false"}
    refused = api.post("/api/trees", files={"file": (file.filename, file.data)}, data=form)
    assert (refused.status_code, refused.json()["code"]) == (422, "no-wood")


def test_all_pieces_can_be_fetched_to_choose_from(api: httpx.Client) -> None:
    file = labelled_file("pot", 41)
    tree = api.post("/api/trees", files={"file": (file.filename, file.data)}).json()
    answer = api.post(f"/api/trees/{tree['id']}/pieces")
    assert (answer.status_code, answer.headers["content-type"]) == (200, "model/gltf-binary")
    assert answer.content[:4] == b"glTF"
    painted = api.patch(f"/api/trees/{tree['id']}", json={"drop": ["1.1-2"]}).json()["report"]["pieces"]
    assert [(p["ranges"], p["kind"]) for p in painted if "ranges" in p] == [
        (["1.1-1"], "other"),
        (["1.2-2"], "other"),
    ]
    assert api.post("/api/trees/none/pieces").status_code == 404


def test_another_tree_of_a_file_is_imported_without_sending_it_again(api: httpx.Client) -> None:
    file = labelled_file("three_trees_plain", 41)
    first = api.post("/api/trees", files={"file": (file.filename, file.data)}, data={"up_axis": "y"}).json()
    path = f"/api/trees/{first['id']}/copies"
    made = api.post(path, json={"tree": 2, "name": "second"})
    assert made.status_code == 201
    second = made.json()
    assert made.headers["location"] == f"/api/trees/{second['id']}"
    assert (second["name"], second["report"]["up_axis"]["reason"]) == ("second", "given")
    assert [t["taken"] for t in second["report"]["trees"]] == [False, True, False]
    again = api.post(path, json={"tree": 2})
    assert (again.status_code, again.json()["id"]) == (200, second["id"])
    refused = api.post(path, json={"tree": 9})
    assert (refused.status_code, refused.json()["code"]) == (422, "no-such-tree")
    assert api.delete(f"/api/trees/{first['id']}").status_code == 204
    assert api.patch(f"/api/trees/{second['id']}", json={"height_m": 7.0}).status_code == 200

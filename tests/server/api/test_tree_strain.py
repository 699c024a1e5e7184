"""The strain of a tree over REST: that of the library, for the mesh that is drawn."""

from __future__ import annotations

from collections.abc import Iterator

import httpx
import numpy as np
import pytest
from galewood.options import ImportRequest
from galewood.solid.strain import CAUTION_TEXT, strain_in_wind, wind_rods
from galewood.tree import read_tree
from galewood.wood import wood_of_species
from galewood_server.api.tree_strain import TreeStrainOut

from tests.server.api.test_structures import NAME, SPECIES, species_folder
from tests.server.support.server_process import NO_CLUSTER, Server

PATH = f"/api/trees/{NAME}/strain"


@pytest.fixture(scope="module")
def api(tmp_path_factory: pytest.TempPathFactory) -> Iterator[httpx.Client]:
    folder = tmp_path_factory.mktemp("strain")
    environment = {"GALEWOOD_BUILTIN_TREES": "true", "GALEWOOD_SPECIES_DIR": str(species_folder(folder))}
    (folder / "data").mkdir()
    server = Server(folder / "data", "galewood_server.cli.main", {**environment, **NO_CLUSTER}).start("serve")
    try:
        with server.client() as client:
            yield client
    finally:
        server.stop()


def test_the_answer_is_the_strain_of_the_library(api: httpx.Client) -> None:
    answer = api.get(PATH, params={"speed_m_s": 20, "direction_deg": 30, "foliage": "bare"}, timeout=300)
    assert answer.status_code == 200, answer.text
    found = answer.json()
    glb = (SPECIES / "shipped" / f"{NAME}.glb").read_bytes()
    tree, wood = read_tree(glb, "tree.glb", ImportRequest(species=NAME)), wood_of_species(NAME)
    own = strain_in_wind(wind_rods(tree, wood, leaves=False), 20, 30)[0]
    assert found["breast_height_strain"] == pytest.approx(own.breast_height_strain, rel=1e-6)
    told = np.array([one for one in found["strain"] if one is not None])
    np.testing.assert_allclose(np.sort(told), np.sort(own.strain), rtol=1e-6)
    assert found["caution"] == CAUTION_TEXT
    assert TreeStrainOut.model_validate(found).model_dump(mode="json") == found
    points, parent = np.array(found["points_m"]), np.array(found["parent"])
    assert parent[0] == -1 and (parent[1:] < np.arange(1, len(parent))).all()
    middle = (points + points[np.maximum(parent, 0)]) / 2
    at = int(np.argmin([np.inf if one is None else abs(one - own.strain[3]) for one in found["strain"]]))
    np.testing.assert_allclose(middle[at], own.place_m[3], atol=1e-3)


def test_a_bare_tree_strains_less_than_one_in_leaf(api: httpx.Client) -> None:
    leaf, bare = (
        api.get(PATH, params={"speed_m_s": 5, "foliage": foliage}, timeout=300).json()["base_moment_nm"]
        for foliage in ("leaf", "bare")
    )
    assert leaf > 1.5 * bare


@pytest.mark.parametrize(
    ("path", "query", "status", "code"),
    [
        (PATH, {"speed_m_s": 0}, 422, "invalid-request"),
        (PATH, {"speed_m_s": "nan"}, 422, "invalid-request"),
        (PATH, {"direction_deg": 1e9}, 422, "invalid-request"),
        (PATH, {"foliage": "autumn"}, 422, "invalid-request"),
        ("/api/trees/nothing/strain", {}, 404, "no-such-tree"),
    ],
)
def test_what_is_wrong_is_said(
    api: httpx.Client, path: str, query: dict[str, str], status: int, code: str
) -> None:
    answer = api.get(path, params=query)
    assert (answer.status_code, answer.json()["code"]) == (status, code), answer.text

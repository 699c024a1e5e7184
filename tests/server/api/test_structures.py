"""The tetrahedra and the skeleton of a tree over REST."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import TYPE_CHECKING, Any

import anyio
import numpy as np
import pytest

from tests.server.support.fake_server import fake_importer
from tests.server.support.in_process import application
from tests.server.support.server_process import NO_CLUSTER, REPOSITORY, Server

if TYPE_CHECKING:
    from galewood.options import ImportRequest

SPECIES = REPOSITORY / "assets" / "species"
NAME = "apricot"


def species_folder(parent: Path) -> Path:
    """A folder with one built-in tree and what is shipped of it."""
    folder = parent / "species"
    (folder / "shipped").mkdir(parents=True)
    entries = [e for e in json.loads((SPECIES / "species.json").read_bytes()) if e["id"] == NAME]
    (folder / "species.json").write_text(json.dumps(entries))
    shutil.copy(SPECIES / entries[0]["file"], folder / entries[0]["file"])
    for path in (SPECIES / "shipped").glob(f"{NAME}.*"):
        shutil.copy(path, folder / "shipped" / path.name)
    return folder


def test_the_structure_is_that_of_the_build(tmp_path: Path) -> None:
    species = species_folder(tmp_path)
    environment = {"GALEWOOD_BUILTIN_TREES": "true", "GALEWOOD_SPECIES_DIR": str(species)}
    data_dir = tmp_path / "data"
    data_dir.mkdir()
    server = Server(data_dir, "galewood_server.cli.main", {**environment, **NO_CLUSTER}).start("serve")
    try:
        check(server, species)
    finally:
        server.stop()


def check(server: Server, species: Path) -> None:
    address = f"/api/trees/{NAME}/structure"
    with server.client() as api:
        report = api.get(f"/api/trees/{NAME}").json()["report"]
        answer = api.get(address)
        structure = answer.json()
        with np.load(species / "shipped" / f"{NAME}.tets.npz") as kept:
            np.testing.assert_allclose(structure["vertices_m"], kept["vertices"], atol=1e-4)
            np.testing.assert_array_equal(structure["tets"], kept["tets"])
        points, parent = np.array(structure["skeleton"]["points_m"]), structure["skeleton"]["parent"]
        assert len(points) == report["skeleton"]["points"] == len(structure["skeleton"]["radius_m"])
        assert parent[0] == -1 and all(above < at for at, above in enumerate(parent))
        length_m = np.linalg.norm(points[1:] - points[parent[1:]], axis=1).sum()
        assert length_m == pytest.approx(report["skeleton"]["length_m"], rel=1e-3)
        current = api.get(address, headers={"if-none-match": answer.headers["etag"]})
        assert current.status_code == 304

        shutil.rmtree(server.data_dir / "cache")
        missing = api.get(address)
        assert (missing.status_code, missing.json()["code"]) == (404, "no-structure")
        assert api.get("/api/trees/none/structure").status_code == 404


def test_the_structure_of_an_upload_that_is_not_built_costs_nothing(tmp_path: Path) -> None:
    imported: list[str] = []

    def importer(data: bytes, filename: str, options: ImportRequest) -> Any:
        imported.append(filename)
        return fake_importer(data, filename, options)

    async def run() -> None:
        async with application(tmp_path, importer) as (_, api):
            tree = (await api.post("/api/trees", files={"file": ("a.obj", b"a tree")})).json()
            for _ in range(3):
                answer = await api.get(f"/api/trees/{tree['id']}/structure")
                assert (answer.status_code, answer.json()["code"]) == (404, "no-structure")
            assert imported == ["a.obj"]

    anyio.run(run)

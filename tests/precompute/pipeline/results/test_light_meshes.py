"""The light copies of the shipped render meshes, compared with those, and what a browser downloads."""

from __future__ import annotations

import hashlib
import io
import json
from pathlib import Path
from typing import Any

import meshopt
import numpy as np
import pytest
from galewood.check.evaluation.source import read_mesh
from galewood.formats.beside import mesh_with_companions
from galewood.options import ImportRequest
from galewood.pipeline.results import LIGHT_FOLDER, light_mesh, write_light
from galewood.table import decode
from galewood.tree.importer import read_tree
from PIL import Image

from tests.precompute.fixtures.shared_tets import small_tree_glb

SPECIES = Path(__file__).parents[4] / "assets" / "species"
SHIPPED, LIGHT = SPECIES / "shipped", SPECIES / LIGHT_FOLDER
TREES = [(entry["id"], entry["species"]) for entry in json.loads((SPECIES / "species.json").read_bytes())]
MESHOPT = "EXT_meshopt_compression"
MOST_BYTES_OF_A_SPECIES, MOST_BYTES_OF_A_MESH = 660_000, 290_000
"""Of both forms with their pictures, on average, and of one mesh without its pictures."""


def document_of(glb: bytes) -> tuple[dict[str, Any], bytes]:
    size = int.from_bytes(glb[12:16], "little")
    return json.loads(glb[20 : 20 + size]), glb[20 + size + 8 :]


def rows_of(glb: bytes, accessor: int) -> np.ndarray:
    """Values of an accessor, read without the importer: by the specifications and meshopt's own decoder."""
    document, body = document_of(glb)
    entry = document["accessors"][accessor]
    view = document["bufferViews"][entry["bufferView"]]
    kind = {5120: "i1", 5121: "u1", 5123: "<u2", 5125: "<u4", 5126: "<f4"}[entry["componentType"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[entry["type"]]
    packed = view.get("extensions", {}).get(MESHOPT)
    source = packed or view
    content = body[source["byteOffset"] :][: source["byteLength"]]
    if packed:
        stride, scheme = packed["byteStride"], packed.get("filter", "NONE")
        content = meshopt.decode_gltf_buffer(
            content, packed["count"], stride, packed["mode"], scheme
        ).tobytes()
    rows = np.frombuffer(content, kind).reshape(entry["count"], -1)[:, :width]
    return rows / np.iinfo(rows.dtype).max if entry.get("normalized") else rows


def primitives_of(glb: bytes) -> dict[str, dict[str, np.ndarray]]:
    """Attributes and triangles of every mesh by its name."""
    found: dict[str, dict[str, np.ndarray]] = {}
    for mesh in document_of(glb)[0]["meshes"]:
        (primitive,) = mesh["primitives"]
        accessors = primitive["attributes"] | {"triangles": primitive["indices"]}
        found[mesh["name"]] = {name: rows_of(glb, accessor) for name, accessor in accessors.items()}
    return found


def angles_deg(some: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Angles between vectors in rows."""
    cosines = (
        np.einsum("ij,ij->i", some, others) / np.linalg.norm(some, axis=1) / np.linalg.norm(others, axis=1)
    )
    return np.degrees(np.arccos(np.clip(cosines, -1, 1)))


def triangles(corners: np.ndarray) -> np.ndarray:
    """(n, 3) triangles, each from its lowest vertex on: the codec may begin with another corner."""
    rows = corners.reshape(-1, 3).astype(np.int64)
    first = rows.argmin(axis=1)[:, None]
    return np.take_along_axis(rows, (first + np.arange(3)) % 3, axis=1)


@pytest.mark.parametrize("name", [name for name, _ in TREES])
def test_a_light_mesh_has_the_vertices_and_triangles_of_the_render_mesh_in_its_order(name: str) -> None:
    render = (SHIPPED / f"{name}.glb").read_bytes()
    light = light_mesh(LIGHT, hashlib.sha256(render).hexdigest())
    assert light is not None, "`galewood ship` writes the light copies of new render meshes"
    expected, found = primitives_of(render), primitives_of(light)
    assert list(found) == list(expected)
    for mesh, attributes in expected.items():
        assert found[mesh].keys() == attributes.keys()
        assert np.abs(found[mesh]["POSITION"] - attributes["POSITION"]).max() < 0.2e-3  # m
        assert angles_deg(found[mesh]["NORMAL"], attributes["NORMAL"]).max() < 1.5  # twice rounded to 8 bits
        assert np.array_equal(triangles(found[mesh]["triangles"]), triangles(attributes["triangles"]))
        if "TEXCOORD_0" in attributes:  # of a picture that is 768 texels high, less than half a texel
            assert np.abs(found[mesh]["TEXCOORD_0"] - attributes["TEXCOORD_0"]).max() < 0.4 / 768
        if "COLOR_0" in attributes:
            assert np.abs(found[mesh]["COLOR_0"] - attributes["COLOR_0"]).max() < 1e-6


def test_light_meshes_are_compressed_share_pictures_and_stay_small() -> None:
    files = [path for path in LIGHT.rglob("*") if path.is_file()]
    most = MOST_BYTES_OF_A_SPECIES * len({species for _, species in TREES})
    assert sum(path.stat().st_size for path in files) < most
    used: dict[str, list[list[str]]] = {}
    sprays: dict[str, list[str]] = {}
    for name, species in TREES:
        glb = (LIGHT / f"{name}.glb").read_bytes()
        document, _ = document_of(glb)
        assert len(glb) < MOST_BYTES_OF_A_MESH
        assert all(MESHOPT in view["extensions"] for view in document["bufferViews"])
        used.setdefault(species, []).append([image["uri"] for image in document["images"]])
        (leaves,) = (material for material in document["materials"] if material["name"] == "leaves")
        sprays.setdefault(species, []).append(leaves["extras"]["sprays"])
        drawn = SPECIES / f"{species}.sprays.json"  # none of needles
        assert leaves["extras"].get("drawn_sprays") == (
            json.loads(drawn.read_bytes()) if drawn.is_file() else None
        )
    for first, second in used.values():
        assert first == second
        assert len(set(first)) == 3
    assert all(first == second for first, second in sprays.values())
    named = {uri for forms in used.values() for uri in forms[0]} | {uri for uri, _ in sprays.values()}
    assert {path.relative_to(LIGHT).as_posix() for path in files if path.suffix == ".webp"} == named
    assert {path.suffix for path in files} == {".glb", ".webp", ".json"}


def test_the_pictures_of_a_light_mesh_look_like_those_of_the_render_mesh() -> None:
    for name in ("poplar", "maple", "oak"):
        document, body = document_of((SHIPPED / f"{name}.glb").read_bytes())
        light, _ = document_of((LIGHT / f"{name}.glb").read_bytes())
        for texture, drawn in zip(document["textures"], light["textures"], strict=True):
            view = document["bufferViews"][document["images"][texture["source"]]["bufferView"]]
            content = body[view["byteOffset"] :][: view["byteLength"]]
            uri = light["images"][drawn["extensions"]["EXT_texture_webp"]["source"]]["uri"]
            with Image.open(io.BytesIO(content)) as before, Image.open(LIGHT / uri) as after:
                assert (before.size, before.mode, after.format) == (after.size, after.mode, "WEBP")
                old, new = (np.asarray(picture).astype(float) for picture in (before, after))
            assert np.sqrt(np.mean((old[..., :3] - new[..., :3]) ** 2)) < 9  # of 255
            assert np.array_equal(old[..., 3:], new[..., 3:])


@pytest.mark.parametrize(
    ("name", "fuller"),
    [("spruce", 1.4), ("larch-forest", 1.4), ("apricot", 1.05), ("sycamore-forest", 1.05)],
)
def test_browsers_draw_fuller_shoots_where_a_species_has_them(name: str, fuller: float) -> None:
    light, _ = document_of((LIGHT / f"{name}.glb").read_bytes())
    (uri,) = (image["uri"] for image in light["images"] if "-leaves." in image["uri"])
    species = name.partition("-")[0]
    with Image.open(LIGHT.parent / f"{species}.shoots.png") as drawn, Image.open(LIGHT / uri) as packed:
        assert (drawn.size, drawn.mode, packed.format) == (packed.size, packed.mode, "WEBP")
        old, new = (np.asarray(picture).astype(float) for picture in (drawn, packed))
    assert np.array_equal(old[..., 3], new[..., 3])
    # The mesh keeps the leaf area that its table was made with.
    document, body = document_of((SHIPPED / f"{name}.glb").read_bytes())
    (leaves,) = (material for material in document["materials"] if material["name"] == "leaves")
    source = document["textures"][leaves["pbrMetallicRoughness"]["baseColorTexture"]["index"]]["source"]
    view = document["bufferViews"][document["images"][source]["bufferView"]]
    with Image.open(io.BytesIO(body[view["byteOffset"] :][: view["byteLength"]])) as of_mesh:
        covered = (np.asarray(of_mesh)[..., 3] > 127).mean()
    assert (new[..., 3] > 127).mean() > fuller * covered


def test_a_light_mesh_is_read_with_its_pictures_and_fits_the_table() -> None:
    path = LIGHT / "apricot-forest.glb"
    tree = read_tree(mesh_with_companions(path), path.name, ImportRequest(species="apricot", height_m=12.0))
    pictures = [len(primitive.material.images) for primitive in tree.primitives if primitive.material]
    assert (pictures, tree.report["warnings"]) == ([2, 0, 1], [])
    table = decode((SHIPPED / "apricot-forest.table").read_bytes())
    assert len(read_mesh(table, path).primitives) == len(table.metadata["primitives"])


def test_light_meshes_that_are_no_longer_shipped_are_removed(tmp_path: Path) -> None:
    glb = small_tree_glb()
    assert write_light(tmp_path, [("old", "maple", glb)], {})
    (tmp_path / "pictures" / "maple-bark.0123456789ab.webp").write_bytes(b"of another version")
    assert write_light(tmp_path, [("new", "maple", glb)], {})
    assert not write_light(tmp_path, [("new", "maple", glb)], {})
    assert {path.name for path in tmp_path.rglob("*") if path.is_file()} == {"new.glb", "index.json"}
    light = light_mesh(tmp_path, hashlib.sha256(glb).hexdigest())
    assert light is not None
    assert primitives_of(light).keys() == primitives_of(glb).keys()
    assert light_mesh(tmp_path, "0" * 64) is None

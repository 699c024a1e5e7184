"""Names in files of every format can be stored and sent, and wrong values anywhere in a glTF are refused."""

import json
import unicodedata
from typing import Any

import numpy as np
import pytest
from galewood.options import ImportRequest
from galewood.tree.importer import read_tree, render_glb
from galewood.tree.sandboxed import pack_tree
from galewood.util import MeshError
from pydantic import BaseModel

from tests.precompute.fixtures.untrusted_text import (
    NASTY,
    WRONG,
    document_of,
    files_named,
    glb_of,
    named,
    places_of,
    rich_gltf,
    with_value,
)
from tests.precompute.util.test_shown_text import UNFIT, random_texts

DOCUMENT, BINARY = document_of(rich_gltf())
PLACES = list(places_of(DOCUMENT))


class Stored(BaseModel):
    """As the service sends a report."""

    report: dict[str, Any]


def texts_in(value: Any) -> list[str]:
    if isinstance(value, str):
        return [value]
    if isinstance(value, dict):
        return [text for key, inner in value.items() for text in [key, *texts_in(inner)]]
    return [text for inner in value for text in texts_in(inner)] if isinstance(value, list) else []


def read_or_refused(data: bytes, name: str, options: ImportRequest | None = None) -> Any:
    """The report, or the error's texts; everything can be encoded, stored and shown."""
    try:
        tree = read_tree(data, name, options)
        pack_tree(tree)
        render_glb(tree)
        report: Any = tree.report
    except MeshError as error:
        report = {"code": error.code, "title": error.title, "hint": error.hint}
    assert json.dumps(report, ensure_ascii=False, allow_nan=False).encode()
    assert Stored(report=report).model_dump_json().encode()
    for text in texts_in(report):
        assert not UNFIT & {unicodedata.category(char) for char in text}, repr(text)
        assert len(text) < 5000
    return report


def test_a_tree_with_everything_is_read():
    report = read_or_refused(glb_of(DOCUMENT, BINARY), "rich.glb")
    assert {name for part in report["parts"] for name in part["names"]} >= {"bark", "crown", "tree", "leaves"}


@pytest.mark.parametrize("name", NASTY, ids=lambda name: repr(name)[:20])
def test_one_nasty_name_is_read(name):
    for key in ("nodes", "meshes", "materials"):
        report = read_or_refused(glb_of(with_value(DOCUMENT, (key, 0, "name"), name), BINARY), "a.glb")
        assert report["parts"], report


@pytest.mark.parametrize("seed", range(4))
def test_nasty_names_everywhere_are_read(seed):
    random = np.random.default_rng(seed)
    names = NASTY if seed == 0 else tuple(random_texts(seed, 40))
    for _ in range(8):
        report = read_or_refused(glb_of(named(DOCUMENT, random, names), BINARY), names[seed])
        assert report["parts"], f"seed {seed}: {report}"


@pytest.mark.parametrize("name", NASTY, ids=lambda name: repr(name)[:20])
def test_nasty_names_in_other_formats_can_be_stored(name):
    for filename, data in files_named(name):
        read_or_refused(data, filename)


def test_names_that_differ_stay_different_parts():
    names = ("n" * 300 + "a", "n" * 300 + "b", "wo\u200bod", "wood")
    document = DOCUMENT
    for index, name in zip((0, 2, 3, 4), names, strict=True):
        document = with_value(document, ("nodes", index, "name"), name)
    found = read_or_refused(glb_of(document, BINARY), "a.glb")["pieces"]
    shown = {name for piece in found for name in piece["names"]}
    assert len([name for name in shown if name.startswith("nnn")]) == 2
    assert {"wo<U+200B>od", "wood"} <= shown


def test_a_part_is_chosen_by_its_name_as_in_the_file_or_as_shown():
    document = with_value(DOCUMENT, ("nodes", 3, "name"), "odd\u200bpart")
    for name in ("odd\u200bpart", "odd<U+200B>part"):
        report = read_or_refused(glb_of(document, BINARY), "a.glb", ImportRequest(drop=[name]))
        kinds = {piece["kind"] for piece in report["pieces"] if "odd<U+200B>part" in piece["names"]}
        assert kinds == {"other"}, report


def test_uris_in_messages_can_be_stored():
    for name in NASTY:
        image = with_value(DOCUMENT, ("images", 0), {"uri": name})
        assert read_or_refused(glb_of(image, BINARY), "a.glb")["warnings"]
        buffer = with_value(DOCUMENT, ("buffers", 0, "uri"), name)
        assert read_or_refused(glb_of(buffer, BINARY), "a.glb")["code"] == "external-buffers"


@pytest.mark.parametrize("seed", range(4))
def test_a_wrong_value_anywhere_is_refused_or_ignored(seed):
    """Every place of a document in turn holds a value of a wrong type or size."""
    random = np.random.default_rng(seed)
    for place in PLACES[seed::4]:
        value = WRONG[int(random.integers(len(WRONG)))]
        document = with_value(DOCUMENT, place, value)
        try:
            read_or_refused(glb_of(document, BINARY), "a.glb")
        except Exception as error:
            raise AssertionError(f"seed {seed}: {value!r} at {place}") from error


@pytest.mark.parametrize(
    ("place", "value"),
    [
        (("materials", 0, "pbrMetallicRoughness", "baseColorFactor"), "red"),
        (("materials", 1, "pbrMetallicRoughness", "baseColorFactor"), {"r": 1}),
        (("materials", 1, "pbrMetallicRoughness", "baseColorFactor"), [1, 1]),
        (("materials", 1, "pbrMetallicRoughness"), [1]),
        (("materials", 1, "alphaCutoff"), float("nan")),
        (("materials", 0, "emissiveFactor"), [[0], 0, 0]),
        (("nodes", 0, "scale"), [1, 1, "1"]),
        (("samplers", 0, "wrapS"), "repeat"),
    ],
)
def test_the_message_says_which_value_is_wrong(place, value):
    found = read_or_refused(glb_of(with_value(DOCUMENT, place, value), BINARY), "a.glb")
    assert found["code"] == "gltf-structure"
    assert ".".join(map(str, place)) in found["title"]


@pytest.mark.parametrize(
    ("path", "value"),
    [
        (("materials", 0, "pbrMetallicRoughness", "baseColorFactor"), [0.2, 0.1, 0.1]),
        (("materials", 0, "pbrMetallicRoughness", "baseColorFactor"), [0.2, 0.1, 0.1, 1.0, 1.0]),
        (("materials", 0, "alphaMode"), None),
        (("nodes", 0, "children"), None),
        (("meshes", 0, "primitives", 0, "targets"), None),
        (("accessors", 0, "byteOffset"), 0.0),
    ],
)
def test_what_exporters_write_beside_the_specification_is_read(path: tuple[Any, ...], value: Any) -> None:
    written = with_value(DOCUMENT, path, value)
    read_tree(glb_of(written, BINARY), "tree.glb")

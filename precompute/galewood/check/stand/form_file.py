"""The bending of the built-in trees, which is distributed with them: half a minute of work for every report.

A JSON file with ``key`` (hash of what the forms were made from) and ``forms``: by foliage and name of the
tree, the fields of a TreeForm, with the species of its wood for the wood.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any, get_args

import numpy as np

from galewood.check.stand.forms import TreeForm
from galewood.packaged import species_folder
from galewood.pipeline.results import forms_path
from galewood.pipeline.stages import BuiltinMesh, builtin_meshes
from galewood.table import Foliage
from galewood.util import write_atomically
from galewood.wood import wood_of_species

FORMS_VERSION = 2
"""Increases when the same meshes and woods give another bending."""
DIGIT_COUNT = 7

Bend = Callable[[BuiltinMesh, Foliage], TreeForm]


def shipped_forms(foliage: Foliage, folder: Path | None = None) -> dict[str, TreeForm]:
    """The built-in trees, bent in winds of all speeds, by name: "maple" and "maple-forest" and so on.

    ``folder`` has their meshes. Raises FileNotFoundError if it has no file of forms.
    """
    path = forms_path(folder or species_folder())
    if not path.is_file():
        raise FileNotFoundError(f"{path} is missing: run `galewood ship`")
    return forms_in(path.read_bytes(), foliage)


def forms_in(content: bytes, foliage: Foliage) -> dict[str, TreeForm]:
    """The same, in the content of such a file."""
    given: dict[str, dict[str, Any]] = json.loads(content)["forms"][foliage]
    return {name: _form(name, document) for name, document in given.items()}


def ship_forms(folder: Path, bend: Bend) -> bool:
    """Write the forms of the built-in trees of a folder, unless they are up to date; whether it did."""
    meshes = builtin_meshes(folder)
    key = forms_key(meshes)
    if shipped_key(folder) == key:
        return False
    forms = {
        foliage: {mesh.name: _document(bend(mesh, foliage), str(mesh.options["species"])) for mesh in meshes}
        for foliage in get_args(Foliage)
    }
    text = json.dumps({"key": key, "forms": forms}, separators=(",", ":")) + "\n"
    write_atomically(forms_path(folder), text.encode())
    return True


def shipped_key(folder: Path) -> str:
    """The hash of what the forms of a folder were made from; empty if it has none."""
    path = forms_path(folder)
    return str(json.loads(path.read_bytes())["key"]) if path.is_file() else ""


def forms_key(meshes: Iterable[BuiltinMesh]) -> str:
    """Hash of everything that the forms are made from."""
    parts = [(mesh.name, mesh.key, asdict(wood_of_species(str(mesh.options["species"])))) for mesh in meshes]
    return hashlib.sha256(json.dumps([FORMS_VERSION, parts], sort_keys=True).encode()).hexdigest()


def _document(form: TreeForm, species: str) -> dict[str, object]:
    values = {field.name: getattr(form, field.name) for field in fields(TreeForm) if field.name != "name"}
    return {name: species if name == "wood" else _rounded(value) for name, value in values.items()}


def _rounded(value: Any) -> float | list[float]:
    if isinstance(value, np.ndarray):
        return [_rounded_number(one) for one in value]
    return _rounded_number(value)


def _rounded_number(value: float) -> float:
    return float(f"{value:.{DIGIT_COUNT}g}")


def _form(name: str, document: dict[str, Any]) -> TreeForm:
    values: dict[str, Any] = {"name": name, "wood": wood_of_species(str(document["wood"]))}
    for key, value in document.items():
        values.setdefault(key, np.array(value) if isinstance(value, list) else value)
    return TreeForm(**values)

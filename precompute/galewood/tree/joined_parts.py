"""Parts that a file splits although they are one: the same names and material, so that pieces stay whole."""

from __future__ import annotations

import json
from dataclasses import replace
from hashlib import sha256
from typing import Any

import numpy as np

from galewood.formats import Material, RawPart, pack_material
from galewood.util import Floats, MeshError

EXTRAS = ("normals", "uv", "colours")
MAX_PARTS = 10_000  # each costs about a millisecond


def joined_parts(parts: list[RawPart]) -> list[RawPart]:
    """Parts with the same labels, material and attributes as one each, in the order of their first ones.

    Raises MeshError if they are more than MAX_PARTS.
    """
    materials = _numbered([part.material for part in parts])
    groups: dict[Any, list[RawPart]] = {}
    for part, material in zip(parts, materials, strict=True):
        attributes = tuple(getattr(part, name) is None for name in EXTRAS)
        groups.setdefault((part.labels, material, attributes), []).append(part)
    if len(groups) > MAX_PARTS:
        raise MeshError(
            "too-many-parts",
            "too-large",
            f"The file has {len(groups)} parts of different names or materials; the limit is {MAX_PARTS}.",
            "Join the objects of the tree (in Blender: Object > Join) and export it again.",
        )
    return [_joined(group) for group in groups.values()]


def _numbered(materials: list[Material | None]) -> list[int]:
    """A number for each material, the same for equal ones; each is serialised once, so the cost is linear."""
    number_of: dict[str, int] = {}
    known: dict[int, int] = {}
    for material in materials:
        if id(material) not in known:
            known[id(material)] = number_of.setdefault(_fingerprint(material), len(number_of))
    return [known[id(material)] for material in materials]


def _fingerprint(material: Material | None) -> str:
    head, images = pack_material(material)
    digests = {key: sha256(content).hexdigest() for key, content in images.items()}
    return json.dumps([head, digests], sort_keys=True)


def _joined(parts: list[RawPart]) -> RawPart:
    if len(parts) == 1:
        return parts[0]
    offsets = np.cumsum([0, *(len(part.positions) for part in parts[:-1])])

    def rows(name: str) -> Floats | None:
        return None if getattr(parts[0], name) is None else np.concatenate([getattr(p, name) for p in parts])

    return replace(
        parts[0],
        positions=np.concatenate([part.positions for part in parts]),
        faces=np.concatenate([p.faces + o for p, o in zip(parts, offsets, strict=True)]).astype(np.int32),
        normals=rows("normals"),
        uv=rows("uv"),
        colours=rows("colours"),
    )

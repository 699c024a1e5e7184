"""Texture coordinates: a material's texture set and transform are applied, so that one plain set remains.

Source: extension KHR_texture_transform.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from galewood.formats.companions import Source
from galewood.formats.gltf.material import SLOTS
from galewood.formats.types import Material
from galewood.util import Floats

Json = dict[str, Any]
EXTENSION_NAME = "KHR_texture_transform"
MAX_SETS = 8


@dataclass(frozen=True)
class UvChoice:
    """A set of texture coordinates, and how it is transformed (3, 3), in rows (u, v, 1)."""

    texture_set: int
    matrix: Floats

    def applied(self, uv: Floats) -> Floats:
        """The transformed coordinates (n, 2)."""
        return uv[:, :2] @ self.matrix[:2, :2].T + self.matrix[:2, 2]


def choose_uv(material: Material, source: Source) -> UvChoice:
    """The texture coordinates of the base colour, or of the first texture; other sets are not drawn.

    The transforms are removed from the material, and so are textures that need other coordinates; they are
    reported.
    """
    chosen: UvChoice | None = None
    for group, slot in SLOTS:
        holder = material.json.get(group, {}) if group else material.json
        if slot not in holder:
            continue
        wanted = _wanted(holder[slot])
        if chosen is None:
            chosen = wanted
        if wanted.texture_set != chosen.texture_set or not np.allclose(wanted.matrix, chosen.matrix):
            del holder[slot]
            source.warn(
                f"The {slot} of the material {material.json.get('name', '')!r} has other texture "
                "coordinates and is not drawn."
            )
            continue
        holder[slot] = _plain(holder[slot])
    return chosen or UvChoice(0, np.eye(3))


def _wanted(info: Json) -> UvChoice:
    transform = info.get("extensions", {}).get(EXTENSION_NAME, {})
    texture_set = int(transform.get("texCoord", info.get("texCoord", 0)))
    if not 0 <= texture_set < MAX_SETS:
        raise IndexError(f"texture set {texture_set}")
    angle = float(transform.get("rotation", 0.0))
    cos, sin = np.cos(angle), np.sin(angle)
    su, sv = (float(c) for c in transform.get("scale", (1.0, 1.0)))
    tu, tv = (float(c) for c in transform.get("offset", (0.0, 0.0)))
    # the extension's matrices: translation · rotation · scale
    return UvChoice(texture_set, np.array([[cos * su, sin * sv, tu], [-sin * su, cos * sv, tv], [0, 0, 1]]))


def _plain(info: Json) -> Json:
    return {key: value for key, value in info.items() if key not in ("extensions", "texCoord")}

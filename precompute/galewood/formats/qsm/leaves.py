"""Leaf cards along the thin branches of a scanned tree: two crossed squares with a sprig on each.

Assumption: the one-sided leaf area is 4,000 times the basal area (the cross-section of the trunk at breast
height). A closed broadleaved stand with a leaf area index of 5 and a basal area of 20 m²/ha has a ratio of
2,500; dense crowns have up to twice as much. Chosen towards the measured ratio of the frequencies in leaf and
bare (docs/physics.md).
"""

from __future__ import annotations

import numpy as np

from galewood.formats.gltf.material import alpha_coverage
from galewood.formats.qsm.branches import Line
from galewood.formats.qsm.leaf_texture import sprig_png
from galewood.formats.types import Material, RawPart
from galewood.util import Floats

LEAF_AREA_PER_BASAL_AREA = 4000.0
LARGEST_CARD_M = 0.4
CARD_PER_HEIGHT = 0.05
"""Size of a card relative to the height of the tree, at most."""
WIDEST_SPREAD = 0.05
"""Standard deviation of the distance of clusters from their place, relative to the height, at most."""
MOST_CLUSTERS = 5000
LEAFY_RADIUS_M = 0.02
"""Leaves hang where a branch is thinner than this, and at its tip."""
LEAFY_SHARE = 0.6
"""Largest share of the length of a branch that has leaves."""
LEAF_SPACING = 0.025
"""Distance of the places of leaves along a branch, relative to the height of the tree."""
TEXTURE_NAME = "sprig"
LEAF_MATERIAL = {
    "name": "leaves",
    "pbrMetallicRoughness": {
        "baseColorTexture": {"index": TEXTURE_NAME},
        "metallicFactor": 0.0,
        "roughnessFactor": 0.9,
    },
    "alphaMode": "MASK",
    "alphaCutoff": 0.4,
    "doubleSided": True,
}


def leafy_end(line: Line, height_m: float) -> tuple[Floats, Floats]:
    """Places (k, 3) along the thin outer part of a branch, its tip first, and directions (k, 3) outwards."""
    length = np.linalg.norm(np.diff(line.points_m, axis=0), axis=1)
    from_tip = np.append(np.cumsum(length[::-1])[::-1], 0.0)
    thin = line.radius_m < LEAFY_RADIUS_M
    reach = min(float(from_tip[thin].max(initial=0.0)), LEAFY_SHARE * float(length.sum()))
    at = np.arange(0.0, reach + 1e-9, LEAF_SPACING * height_m)
    place = np.column_stack([np.interp(at, from_tip[::-1], line.points_m[::-1, k]) for k in range(3)])
    step = np.clip(np.searchsorted(-from_tip, -at, side="left") - 1, 0, len(length) - 1)
    return place, np.diff(line.points_m, axis=0)[step]


def leaf_cards(places_m: Floats, direction: Floats, trunk_diameter_m: float, height_m: float) -> RawPart:
    """Leaves at places (k, 3) that point in the directions (k, 3), unit vectors; k is at least 1."""
    material = Material(LEAF_MATERIAL, {TEXTURE_NAME: (sprig_png(), "image/png")}, {TEXTURE_NAME: {}})
    area_m2 = LEAF_AREA_PER_BASAL_AREA * np.pi / 4 * trunk_diameter_m**2 / alpha_coverage(material)
    largest_m = min(LARGEST_CARD_M, CARD_PER_HEIGHT * height_m)
    needed = int(np.ceil(area_m2 / (2 * largest_m**2)))
    count = min(max(len(places_m), needed), max(MOST_CLUSTERS, len(places_m)))
    size_m = float(np.sqrt(area_m2 / (2 * count)))
    at = np.arange(count) % len(places_m)
    random = np.random.default_rng(0)
    spread_m = min(0.5 * size_m * np.cbrt(count / len(places_m) - 1), WIDEST_SPREAD * height_m)
    scatter = random.normal(size=(count, 3)) * spread_m
    return _crossed(places_m[at] + scatter, _leaning(direction[at], random), size_m, material)


def _leaning(direction: Floats, random: np.random.Generator) -> Floats:
    """Unit vectors (k, 3) about the directions."""
    leaning = direction + 0.4 * random.normal(size=direction.shape)
    return leaning / np.maximum(np.linalg.norm(leaning, axis=1, keepdims=True), 1e-9)


def _crossed(base: Floats, up: Floats, size_m: float, material: Material) -> RawPart:
    """Two squares for each base (k, 3), which contain the direction up (k, 3) and cross at right angles."""
    side: Floats = np.cross(up, np.eye(3)[np.argmin(np.abs(up), axis=1)])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    sides: Floats = np.stack([side, np.cross(up, side)], axis=1)  # (k, 2, 3)
    uv = np.array([[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]])
    across, along = uv[:, 0] - 0.5, 1.0 - uv[:, 1]
    corner = across[:, None] * sides[:, :, None] + along[:, None] * up[:, None, None]
    positions: Floats = (base[:, None, None] + size_m * corner).reshape(-1, 3)
    normals: Floats = np.repeat(np.cross(sides, up[:, None]).reshape(-1, 3), 4, axis=0)
    first = 4 * np.arange(2 * len(base))[:, None, None]
    faces = (first + np.array([[0, 1, 2], [0, 2, 3]])).reshape(-1, 3).astype(np.int32)
    return RawPart(
        labels=("leaves",),
        positions=positions,
        faces=faces,
        normals=normals,
        uv=np.tile(uv, (2 * len(base), 1)),
        material=material,
    )

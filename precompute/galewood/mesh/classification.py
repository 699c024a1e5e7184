"""Classification of parts as wood, twigs or foliage: names, alpha, flat cards, colour, shape and position.

The first criterion that applies decides. Only names tell twigs from other wood.
"""

from __future__ import annotations

import re
from dataclasses import dataclass, replace

import numpy as np
from scipy.spatial import KDTree

from galewood.mesh.gltf_material import greenness, is_cut_out
from galewood.mesh.repair import Surface, face_components, weld
from galewood.mesh.types import ImportOptions, Kind, RawPart
from galewood.util import Floats, Ints

WOOD_NAMES = re.compile(
    r"wood|bark|trunk|branch|stem|timber|stump|\blogs?\b|limb|tronc|stamm|holz|rinde|\bast\b", re.I
)
TWIG_NAMES = re.compile(r"twig|zweig|brindille", re.I)
LEAF_NAMES = re.compile(
    r"leaf|leaves|foliage|frond|needle|blossom|flower|petal|fruit|crown|canopy|green|grass|bush|feuill|blatt|laub",
    re.I,
)
CARD_FACES = 8
CARD_FLATNESS = 0.02
GREEN = 0.08
TOUCHES_GROUND = 0.03
TALL = 0.25
BLOB = 0.35  # ratio of the smallest to the largest principal extent
BLOB_SIZE = 0.12  # relative to the height


@dataclass(frozen=True)
class ClassifiedPart:
    """A part that is entirely of one kind, and the reason."""

    part: RawPart
    kind: Kind
    reason: str


def classify_parts(parts: list[RawPart], options: ImportOptions) -> tuple[list[ClassifiedPart], list[str]]:
    """Classify all parts (y up, any unit); mixed parts are split. Also returns warnings."""
    if options.wood is not None:
        return [_classify_by_option(part, options.wood) for part in parts], []
    low = min(float(part.positions[:, 1].min()) for part in parts)
    height = max(float(part.positions[:, 1].max()) for part in parts) - low
    result = [piece for part in parts for piece in _classify_part(part, low, height)]
    if not any(piece.kind == "wood" for piece in result):
        result = [_thick(piece) for piece in result]
    if any(piece.kind == "wood" for piece in result) or not _has_solid(result):
        return result, []
    warning = (
        "No wood was recognised; the whole mesh is treated as wood. To change this, name the wood materials."
    )
    return [ClassifiedPart(p, "wood", "no wood was recognised") for p in parts], [warning]


def _classify_by_option(part: RawPart, wood: tuple[str, ...]) -> ClassifiedPart:
    if any(label in wood for label in part.labels):
        return ClassifiedPart(part, "wood", "named as wood")
    if any(_named_kind(label) == "twigs" for label in part.labels):
        return ClassifiedPart(part, "twigs", "its name, and not named as wood")
    return ClassifiedPart(part, "leaves", "not named as wood")


def _thick(piece: ClassifiedPart) -> ClassifiedPart:
    """Twigs of a tree without thicker wood are its wood."""
    if piece.kind != "twigs":
        return piece
    return ClassifiedPart(piece.part, "wood", f"{piece.reason}, and there is no thicker wood")


def _named_kind(label: str) -> Kind | None:
    """What a name says; None if it says nothing, or both wood and leaves. Branches and twigs are wood."""
    is_wood, is_leaf = WOOD_NAMES.search(label), LEAF_NAMES.search(label)
    if is_wood and is_leaf:
        return None
    if is_wood or is_leaf:
        return "wood" if is_wood else "leaves"
    return "twigs" if TWIG_NAMES.search(label) else None


def _has_solid(pieces: list[ClassifiedPart]) -> bool:
    """Whether there is anything other than flat cards, which cannot be wood."""
    return any(piece.reason != "flat cards" for piece in pieces)


def _classify_part(part: RawPart, low: float, height: float) -> list[ClassifiedPart]:
    for label in part.labels:  # material names take precedence over node and mesh names
        kind = _named_kind(label)
        if kind:
            return [ClassifiedPart(part, kind, f"its name {label!r}")]
    if is_cut_out(part.material):
        return [ClassifiedPart(part, "leaves", "its material has alpha cut-outs")]
    return _classify_by_shape(part, low, height)


def _classify_by_shape(part: RawPart, low: float, height: float) -> list[ClassifiedPart]:
    welded, origin = _welded_with_origin(part)
    count, of_face = face_components(welded.faces, len(welded.vertices))
    green = greenness(part.material)
    classes = _component_classes(welded, of_face, count, low, height, green is not None and green > GREEN)
    pieces: list[ClassifiedPart] = []
    kinds: tuple[Kind, ...] = ("wood", "leaves")
    for kind in kinds:
        chosen = np.array([v[0] == kind for v in classes])[of_face]
        if not chosen.any():
            continue
        reasons = dict.fromkeys(reason for other, reason in classes if other == kind)
        pieces.append(ClassifiedPart(sub_part(part, origin[chosen]), kind, "; ".join(reasons)))
    return pieces


def _welded_with_origin(part: RawPart) -> tuple[Surface, Ints]:
    """The welded part, and the original face index of each of its faces."""
    surface = Surface(part.positions, part.faces)
    welded = weld_keeping_faces(surface)
    return welded, np.arange(len(part.faces), dtype=np.int32)


def weld_keeping_faces(surface: Surface) -> Surface:
    """Weld seams for connectivity; all faces, even degenerate ones, keep their order."""
    scale = float(np.ptp(surface.vertices, axis=0).max()) or 1.0
    rounded = np.round(surface.vertices / (scale * 1e-6)).astype(np.int64)
    _, first, inverse = np.unique(rounded, axis=0, return_index=True, return_inverse=True)
    return Surface(surface.vertices[first], inverse.reshape(-1)[surface.faces].astype(np.int32))


def _component_classes(
    surface: Surface, of_face: Ints, count: int, low: float, height: float, is_green: bool
) -> list[tuple[Kind, str]]:
    order = np.argsort(of_face, kind="stable")
    bounds = np.searchsorted(of_face[order], np.arange(count + 1))
    return [
        _component_class(surface, surface.faces[order[bounds[k] : bounds[k + 1]]], low, height, is_green)
        for k in range(count)
    ]


def _component_class(
    surface: Surface, faces: Ints, low: float, height: float, is_green: bool
) -> tuple[Kind, str]:
    points = surface.vertices[np.unique(faces)]
    extents = principal_extents(points)
    if len(faces) <= CARD_FACES and extents[2] <= CARD_FLATNESS * extents[0]:
        return "leaves", "flat cards"
    bottom, top = float(points[:, 1].min()), float(points[:, 1].max())
    grounded = bottom <= low + TOUCHES_GROUND * height
    if grounded and top - bottom >= TALL * height:
        return "wood", "tall, standing on the ground"
    if is_green:
        return "leaves", "its colour is green"
    if not grounded and extents[2] > BLOB * extents[0] and extents[0] > BLOB_SIZE * height:
        return "leaves", "a rounded mass above the ground"
    return "wood", "a solid that is neither a card nor a crown"


def principal_extents(points: Floats) -> Floats:
    """Extents (3,) along the principal axes, in descending order."""
    centred = points - points.mean(axis=0)
    _, axes = np.linalg.eigh(centred.T @ centred)
    return np.sort(np.ptp(centred @ axes, axis=0))[::-1]


def sub_part(part: RawPart, faces: Ints) -> RawPart:
    """The part restricted to the given faces; vertices keep their order."""
    used, inverse = np.unique(part.faces[faces], return_inverse=True)

    def pick(rows: Floats | None) -> Floats | None:
        return None if rows is None else rows[used]

    return replace(
        part,
        positions=part.positions[used],
        faces=inverse.reshape(-1, 3).astype(np.int32),
        normals=pick(part.normals),
        uv=pick(part.uv),
        colours=pick(part.colours),
    )


def welded_wood(pieces: list[ClassifiedPart]) -> Surface:
    """All wood as one welded surface."""
    vertices, faces, offset = [], [], 0
    for piece in pieces:
        if piece.kind == "wood":
            vertices.append(piece.part.positions)
            faces.append(piece.part.faces + offset)
            offset += len(piece.part.positions)
    return weld(Surface(np.concatenate(vertices), np.concatenate(faces).astype(np.int32)))


def without_strays(pieces: list[ClassifiedPart], kept: Floats, strays: Floats) -> list[ClassifiedPart]:
    """Remove faces of wood or leaves that are nearer to a discarded body than to the tree."""
    if not len(strays):
        return pieces
    near, far = KDTree(kept), KDTree(strays)
    result: list[ClassifiedPart] = []
    for piece in pieces:
        middle = piece.part.positions[piece.part.faces].mean(axis=1)
        own = np.flatnonzero(near.query(middle)[0] <= far.query(middle)[0])
        if len(own):
            result.append(replace(piece, part=sub_part(piece.part, own)))
    return result

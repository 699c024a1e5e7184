"""Up axis and unit of files that do not define them; every choice is returned with its reason."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.mesh.piece_evidence import is_tube, own_evidence
from galewood.mesh.pieces import Pieces
from galewood.mesh.types import Axis, ImportOptions
from galewood.util import Floats, Ints

AXES: dict[Axis, int] = {"x": 0, "y": 1, "z": 2}
BASE_SLAB = 0.04  # share of the height regarded as the base
SAMPLES = 20_000
# plausible tree heights in each unit; the ranges do not overlap
UNIT_BANDS: tuple[tuple[str, float, float, float], ...] = (
    ("m", 1.5, 40.0, 1.0),
    ("cm", 150.0, 4_000.0, 0.01),
    ("mm", 4_000.0, 60_000.0, 0.001),
)
SPECIES_HEIGHT_M = {"poplar": 12.0, "maple": 10.0, "apricot": 5.0}
DEFAULT_HEIGHT_M = 10.0


STATED_Y = {
    "glb": "glTF is +Y up", "gltf": "glTF is +Y up",
    "fbx": "the file states its up axis", "dae": "the file states its up axis",
}  # fmt: skip
"""Formats whose files are +Y up, or are turned to it when they are read."""
CONVENTIONS: dict[str, dict[Axis, float]] = {
    "glb": {"y": 3.2}, "gltf": {"y": 3.2}, "obj": {"y": 0.4, "z": 0.2}, "fbx": {"y": 3.2}, "dae": {"y": 3.2},
    "ply": {"z": 0.3, "y": 0.2}, "stl": {"z": 0.3, "y": 0.2},
}  # fmt: skip
"""What each format says: glTF demands +Y, FBX and DAE state it, others leave it open. Log odds, as below."""
BASE_WEIGHT = 0.8  # per factor e of the base's score
BASE_MOST = 2.0  # a scene with other objects has misleading bases
SYMMETRY_WEIGHT = 1.5  # between a crown as long as wide, and a line
TRUNK_WEIGHT = 2.0
GROUND_WEIGHT = 5.0
ORDER_WEIGHT = 8.0  # per height between the centres of wood and leaves
SURE, CERTAIN = 0.8, 0.85
FOOT = 0.1  # a trunk begins within this share of the height from the bottom


@dataclass(frozen=True)
class Choice:
    """A chosen value, the reason for it, and whether it is an assumption, or even a guess."""

    value: str
    reason: str
    assumed: bool
    unsure: bool = False
    confidence: float = 1.0


def choose_up_axis(
    vertices: Floats, faces: Ints, pieces: Pieces, file_format: str, options: ImportOptions
) -> Choice:
    """The up axis: the given one, else the one that most indicators favour.

    The convention of the format, the foot of the tree, the symmetry of the crown around the vertical, a trunk
    that stands on the ground and is thicker there, wood below leaves, and flat ground each add to a score.
    """
    if options.up_axis is not None:
        return Choice(options.up_axis, "given", assumed=False)
    if file_format in ("treeqsm", "csv"):
        return Choice("z", "cylinder models are +Z up", assumed=False)
    points = surface_points(vertices, faces)
    weights = indicators(points, vertices[faces], pieces, file_format)
    totals: dict[Axis, float] = {axis: sum(w[axis] for w in weights.values()) for axis in AXES}
    best = max(AXES, key=lambda axis: totals[axis])
    confidence = 1.0 / sum(float(np.exp(np.clip(total - totals[best], -50, 0))) for total in totals.values())
    favouring = [
        words
        for words, w in weights.items()
        if w[best] >= max(w.values()) and w[best] > min(w.values()) + 0.2
    ]
    against = [words for words, w in weights.items() if w[best] < max(w.values()) - 0.5]
    if stated := STATED_Y.get(file_format):
        if best == "y" or confidence < CERTAIN:
            unsure = best != "y"
            reason = stated + (f", but its shape suggests +{best.upper()}" if unsure else "")
            return Choice("y", reason, assumed=unsure, unsure=unsure, confidence=1.0 - confidence * unsure)
        against = [stated]
    reason = ", ".join(favouring) or "no indicator favours another"
    reason += f"; but {', '.join(against)} would suggest another" if against else ""
    return Choice(best, reason, assumed=True, unsure=confidence < SURE, confidence=confidence)


def indicators(
    points: Floats, corners: Floats, pieces: Pieces, file_format: str
) -> dict[str, dict[Axis, float]]:
    """The score that each indicator, in words, gives each axis.

    `points` (k, 3) are distributed over the surface, `corners` (m, 3, 3) are all faces.
    """
    given = CONVENTIONS.get(file_format, {})
    score = own_evidence(pieces).score
    base: dict[Axis, float] = {axis: base_score(points, AXES[axis]) for axis in AXES}
    largest = max(*base.values(), 1e-9)
    return {
        "the convention of the format": {axis: given.get(axis, 0.0) for axis in AXES},
        "a large, compact base": {
            axis: max(BASE_WEIGHT * float(np.log(max(b, 1e-9) / largest)), -BASE_MOST)
            for axis, b in base.items()
        },
        "a symmetric crown": {axis: SYMMETRY_WEIGHT * _symmetry(points, AXES[axis]) for axis in AXES},
        "a trunk from the ground, thicker there": {
            axis: TRUNK_WEIGHT * _trunk(corners, pieces, score, AXES[axis]) for axis in AXES
        },
        "wood below the leaves": {axis: ORDER_WEIGHT * _order(pieces, score, AXES[axis]) for axis in AXES},
        "flat ground": {axis: GROUND_WEIGHT * _ground(corners, AXES[axis]) for axis in AXES},
    }


def _symmetry(points: Floats, axis: int) -> float:
    """Ratio of the smaller to the larger spread perpendicular to an axis."""
    spread = np.linalg.eigvalsh(np.cov(np.delete(points, axis, axis=1).T))
    return float(np.sqrt(max(spread[0], 0.0) / max(spread[1], 1e-300)))


def _trunk(corners: Floats, pieces: Pieces, score: Floats, axis: int) -> float:
    """1 for a trunk along an axis, standing on the ground; less if it leans or is thinner there; 0: none."""
    s = pieces.shapes
    low, high = float(s.low[:, axis].min()), float(s.high[:, axis].max())
    tall = (s.high - s.low)[:, axis]
    extent = max(high - low, 1e-300)
    fit = is_tube(s) & (score > 0) & (s.low[:, axis] <= low + FOOT * extent) & (tall > 0.2 * extent)
    fit &= s.thickness < 0.25 * extent
    best = 0.0
    for k in np.argsort(-np.where(fit, tall, 0.0))[:3].tolist():
        if fit[k]:
            own = corners[np.concatenate(pieces.of_face) == k].reshape(-1, 3)
            lower = _width(own, axis, float(s.low[k, axis]), 0.2 * float(tall[k]))
            upper = _width(own, axis, float(s.low[k, axis] + 0.6 * tall[k]), 0.2 * float(tall[k]))
            standing = 1.0 if abs(float(s.axis[k, axis])) > 0.6 else 0.5
            best = max(best, standing * (1.0 if lower >= 0.95 * upper else 0.3))
    return best


def _width(points: Floats, axis: int, start: float, span: float) -> float:
    """Spread of the points of a slab, perpendicular to the axis."""
    inside = (points[:, axis] >= start) & (points[:, axis] <= start + span)
    if not inside.any():
        return 0.0
    return float(np.ptp(np.delete(points[inside], axis, axis=1), axis=0).max())


def _order(pieces: Pieces, score: Floats, axis: int) -> float:
    """Height of what looks like leaves above what looks like wood, of the extent along the axis; ±0.5."""
    s = pieces.shapes
    wood, leaf = score > 0, score < 0
    if not wood.any() or not leaf.any():
        return 0.0
    height = s.centre[:, axis]
    above = np.average(height[leaf], weights=s.area[leaf]) - np.average(height[wood], weights=s.area[wood])
    return float(
        np.clip(above / max(float(np.ptp(np.stack([s.low, s.high])[:, :, axis])), 1e-300), -0.5, 0.5)
    )


def _ground(corners: Floats, axis: int) -> float:
    """1 if wide flat ground lies at the bottom of the axis, −1 if at its top, else 0."""
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1)
    level = np.abs(normal[:, axis]) > 0.6 * size
    centre = corners.mean(axis=1)
    low, extent = float(corners[:, :, axis].min()), max(float(np.ptp(corners[:, :, axis])), 1e-300)
    width = np.delete(np.ptp(corners.reshape(-1, 3), axis=0), axis)
    found = 0.0
    for sign, there in (
        (1.0, centre[:, axis] < low + 0.12 * extent),
        (-1.0, centre[:, axis] > low + 0.88 * extent),
    ):
        flat = corners[level & there].reshape(-1, 3)
        share = float(size[level & there].sum()) / max(float(size[there].sum()), 1e-300)
        if not len(flat) or share < 0.6:
            continue
        # the side of a crown faces outwards, ground faces the tree
        inwards = float(size[level & there & (sign * normal[:, axis] > 0)].sum())
        if inwards < 0.4 * float(size[level & there].sum()):
            continue
        across = np.delete(np.ptp(flat, axis=0), axis)
        covered = float(size[level & there].sum()) / 2 / max(float(np.prod(width)), 1e-300)
        if (across > 0.7 * width).all() and covered > 0.4:
            found += sign
    return found


def surface_points(vertices: Floats, faces: Ints) -> Floats:
    """SAMPLES points (k, 3) distributed uniformly by area (fixed seed)."""
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    total = area.sum()
    if not total > 0:
        return corners.reshape(-1, 3)
    random = np.random.default_rng(0)
    face = random.choice(len(faces), SAMPLES, p=area / total)
    uv = random.random((SAMPLES, 2))
    uv[uv.sum(axis=1) > 1] = 1 - uv[uv.sum(axis=1) > 1]
    a, b, c = np.moveaxis(corners[face], 1, 0)
    return a + uv[:, :1] * (b - a) + uv[:, 1:] * (c - a)


def base_score(points: Floats, axis: int) -> float:
    """Score of the hypothesis that the tree stands on its base along `axis`; higher is more likely.

    It is high if much of the surface lies in the lowest slab, that part is compact, and the tree is tall. The
    foot of a trunk has a large and compact surface; the tip of a twig is only compact, the side of a crown
    only large.
    """
    height = points[:, axis]
    low, extent = float(height.min()), float(np.ptp(height))
    diagonal = float(np.linalg.norm(np.ptp(points, axis=0)))
    in_base = height <= low + BASE_SLAB * extent
    base = np.delete(points, axis, axis=1)[in_base]
    spread = float(np.sqrt(((base - np.median(base, axis=0)) ** 2).sum(axis=1).mean())) / diagonal
    return float(in_base.mean()) * extent / diagonal / (spread + 0.01) ** 2


def to_y_up(axis: str) -> Floats:
    """Rotation matrix (3, 3) that maps the given axis to +Y."""
    if axis == "z":
        return np.array([[1.0, 0, 0], [0, 0, 1], [0, -1, 0]])
    if axis == "x":
        return np.array([[0.0, -1, 0], [1, 0, 0], [0, 0, 1]])
    return np.eye(3)


def choose_scale(raw_height: float, species: str | None, options: ImportOptions) -> tuple[float, Choice]:
    """Metres per file unit, and the reason for the choice."""
    if options.height_m is not None:
        return options.height_m / raw_height, Choice(
            "given", f"scaled to the given {options.height_m:g} m", False
        )
    for unit, low, high, metres in UNIT_BANDS:
        if low <= raw_height <= high:
            return metres, Choice(
                unit, f"a height of {raw_height:.4g} is plausible for a tree in {unit}", assumed=True
            )
    height_m = SPECIES_HEIGHT_M.get(species or "", DEFAULT_HEIGHT_M)
    kind = species or "unknown species"
    reason = f"a height of {raw_height:.4g} is not plausible in any unit; scaled to {height_m:g} m ({kind})"
    return height_m / raw_height, Choice("unknown", reason, assumed=True)

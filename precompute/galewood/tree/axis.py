"""Up axis of files that do not define it, or define it wrongly; the choice is returned with its reason."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from galewood.options import Axis, ImportRequest
from galewood.tree import upright
from galewood.tree.pieces.detection.pieces import Pieces
from galewood.tree.pieces.evidence import own_evidence
from galewood.util import Floats, Ints

MAX_SAMPLES = 20_000
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
UPSIDE_DOWN = -1.0  # few exporters use a negative axis
BASE_WEIGHT = 0.8  # per factor e of the base's score
BASE_MOST = 2.0  # a scene with other objects has misleading bases
SYMMETRY_WEIGHT = 1.5  # between a crown as long as wide, and a line
TRUNK_WEIGHT = 2.0
TAPER_WEIGHT = 2.0  # for wood three times as thick below as above
GROUND_WEIGHT = 5.0
ORDER_WEIGHT = 8.0  # per height between the centres of wood and leaves
SURE_CONFIDENCE, CERTAIN_CONFIDENCE = 0.8, 0.85
CONTRARY_CONFIDENCE = 0.97  # from which another axis than the stated one is taken without asking
LEAST_LEAD = 1.0  # of +Y over other axes by shape alone; with less, a format that demands +Y is doubted
CONVENTION_REASON = "the convention of the format"

AXES: tuple[Axis, ...] = ("y", "z", "x", "-y", "-z", "-x")
ROTATIONS: dict[str, tuple[tuple[float, ...], ...]] = {
    "y": ((1, 0, 0), (0, 1, 0), (0, 0, 1)),
    "z": ((1, 0, 0), (0, 0, 1), (0, -1, 0)),
    "x": ((0, -1, 0), (1, 0, 0), (0, 0, 1)),
    "-y": ((1, 0, 0), (0, -1, 0), (0, 0, -1)),
    "-z": ((1, 0, 0), (0, 0, -1), (0, 1, 0)),
    "-x": ((0, 1, 0), (-1, 0, 0), (0, 0, 1)),
}
"""Rotation that turns each axis to +Y."""


@dataclass(frozen=True)
class Choice:
    """A chosen value, the reason for it, and whether it is an assumption, or even a guess."""

    value: str
    reason: str
    assumed: bool
    unsure: bool = False
    confidence: float = 1.0


def to_y_up(axis: str) -> Floats:
    """Rotation matrix (3, 3) that maps the given axis to +Y."""
    return np.array(ROTATIONS[axis], dtype=np.float64)


def signed(axis: str) -> str:
    """An axis in words: +Z, −Z."""
    return f"−{axis[1:].upper()}" if axis.startswith("-") else f"+{axis.upper()}"


def choose_up_axis(
    vertices: Floats, faces: Ints, pieces: Pieces, file_format: str, options: ImportRequest
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
    return decided(indicators(points, vertices[faces], pieces, file_format), file_format)


def decided(weights: dict[str, dict[Axis, float]], file_format: str) -> Choice:
    """The choice that follows from the scores of all indicators."""
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
        if best == "y" or confidence < CERTAIN_CONFIDENCE:
            return _as_stated(stated, weights, totals)
        against = [stated]
    reason = ", ".join(favouring) or "no evidence for another axis"
    reason += f"; but {', '.join(against)} suggest another" if against else ""
    least = CONTRARY_CONFIDENCE if stated else SURE_CONFIDENCE
    unsure = confidence < least or bool(stated and best.startswith("-"))
    return Choice(best, reason, assumed=True, unsure=unsure, confidence=confidence)


def _as_stated(stated: str, weights: dict[str, dict[Axis, float]], totals: dict[Axis, float]) -> Choice:
    """+Y, as the format says; unsure if the shape alone speaks for another axis."""
    shape = {axis: totals[axis] - weights[CONVENTION_REASON][axis] for axis in AXES}
    rival = max(AXES[1:], key=lambda axis: shape[axis])
    if shape["y"] >= shape[rival] + LEAST_LEAD:
        return Choice("y", stated, assumed=False)
    doubt = 1.0 / (1.0 + float(np.exp(np.clip(shape["y"] - shape[rival], -50, 50))))
    reason = f"{stated}, but its shape suggests {signed(rival)}"
    return Choice("y", reason, assumed=True, unsure=True, confidence=1.0 - doubt)


def indicators(
    points: Floats, corners: Floats, pieces: Pieces, file_format: str
) -> dict[str, dict[Axis, float]]:
    """The score that each indicator, in words, gives each axis.

    `points` (k, 3) are distributed over the surface, `corners` (m, 3, 3) are all faces.
    """
    given = CONVENTIONS.get(file_format, {})
    score = own_evidence(pieces).score
    seen: dict[Axis, _Seen] = {axis: _upright(points, corners, pieces, score, to_y_up(axis)) for axis in AXES}
    largest = max(*(one.base for one in seen.values()), 1e-9)
    return {
        CONVENTION_REASON: {
            axis: given.get(axis, UPSIDE_DOWN if axis.startswith("-") else 0.0) for axis in AXES
        },
        "a large, compact base": {
            axis: max(BASE_WEIGHT * float(np.log(max(one.base, 1e-9) / largest)), -BASE_MOST)
            for axis, one in seen.items()
        },
        "a symmetric crown": {axis: SYMMETRY_WEIGHT * one.symmetry for axis, one in seen.items()},
        "a trunk from the ground, thicker there": {
            axis: TRUNK_WEIGHT * one.trunk for axis, one in seen.items()
        },
        "wood that is thicker below": {axis: TAPER_WEIGHT * one.taper for axis, one in seen.items()},
        "wood below the leaves": {axis: ORDER_WEIGHT * one.order for axis, one in seen.items()},
        "flat ground": {axis: GROUND_WEIGHT * one.ground for axis, one in seen.items()},
    }


@dataclass(frozen=True)
class _Seen:
    """What each indicator says of a tree that is turned y up."""

    base: float
    symmetry: float
    trunk: float
    taper: float
    order: float
    ground: float


def _upright(points: Floats, corners: Floats, pieces: Pieces, score: Floats, rotation: Floats) -> _Seen:
    turned, around = pieces.turned(rotation), corners @ rotation.T
    points = points @ rotation.T
    return _Seen(
        upright.base(points),
        upright.symmetry(points),
        upright.trunk(around, turned, score),
        upright.taper(around, turned, score),
        upright.order(turned, score),
        upright.ground(around),
    )


def surface_points(vertices: Floats, faces: Ints) -> Floats:
    """SAMPLES points (k, 3) distributed uniformly by area (fixed seed)."""
    corners = vertices[faces]
    area = np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1)
    total = area.sum()
    if not total > 0:
        return corners.reshape(-1, 3)
    random = np.random.default_rng(0)
    face = random.choice(len(faces), MAX_SAMPLES, p=area / total)
    uv = random.random((MAX_SAMPLES, 2))
    uv[uv.sum(axis=1) > 1] = 1 - uv[uv.sum(axis=1) > 1]
    a, b, c = np.moveaxis(corners[face], 1, 0)
    return a + uv[:, :1] * (b - a) + uv[:, 1:] * (c - a)

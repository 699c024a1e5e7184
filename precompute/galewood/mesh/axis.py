"""Up axis and unit of files that do not define them; every choice is returned with its reason."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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


@dataclass(frozen=True)
class Choice:
    """A chosen value, the reason for it, and whether it is an assumption."""

    value: str
    reason: str
    assumed: bool


def choose_up_axis(vertices: Floats, faces: Ints, file_format: str, options: ImportOptions) -> Choice:
    """The up axis: the given one, else that of the format, else +Y or +Z: where the base is more compact."""
    if options.up_axis is not None:
        return Choice(options.up_axis, "given", assumed=False)
    if file_format in ("glb", "gltf"):
        return Choice("y", "glTF is +Y up", assumed=False)
    if file_format in ("fbx", "dae"):
        return Choice("y", "the file names its up axis", assumed=False)
    if file_format in ("treeqsm", "csv"):
        return Choice("z", "cylinder models are +Z up", assumed=False)
    points = surface_points(vertices, faces)
    scores = {axis: base_score(points, AXES[axis]) for axis in ("y", "z")}
    best = max(scores, key=lambda axis: scores[axis])
    other = "z" if best == "y" else "y"
    reason = f"its base is large and compact (score {scores[best]:.2g}; along {other} {scores[other]:.2g})"
    return Choice(best, reason, assumed=True)


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

"""Ground that is connected with the tree, as in scans: faces near the terrain around the trunk are cut off.

The terrain is the lowest surface in each cell of a grid. It is ground only if it spreads much wider than the
trunk above it; what stands within reach of the trunk stays with the tree.
"""

from __future__ import annotations

import numpy as np

from galewood.formats import RawPart
from galewood.tree.pieces.detection.pieces import Pieces, with_new_pieces
from galewood.util import Floats

LEAST_FACES = 300
MAX_GRID_CELLS = 48
CELLS_PER_ROOT_FACE = 0.6  # a coarse mesh has few faces for the cells
LARGE_AREA_SHARE = 0.25  # of the area of all pieces
FOOT_HEIGHT_SHARE = 0.12  # the ground is in this lowest share of a piece's height
MIN_WIDENING_RATIO = 2.5  # ground is so much wider than the trunk just above it
MIN_COVERED_SHARE = 0.3  # of the cells of the ground's extent
GROUND_LIFT_SHARE = 0.025  # of the height: faces this near the terrain are ground
MIN_LEVELNESS = 0.5  # least Σ a n_y² / Σ a of the ground: terrain faces up, branches and trunks do not


def without_ground(parts: list[RawPart], pieces: Pieces) -> Pieces:
    """The pieces (y up), with the ground that is connected with a tree as pieces of its own."""
    s = pieces.shapes
    total = float(s.area.sum())
    for k in np.flatnonzero((s.area > LARGE_AREA_SHARE * total) & (s.faces >= LEAST_FACES)).tolist():
        part = int(pieces.part[k])
        own = np.flatnonzero(pieces.of_face[part] == k)
        ground = ground_faces(parts[part].positions[parts[part].faces[own]])
        if ground is not None and ground.any() and not ground.all():
            pieces = with_new_pieces(pieces, parts, part, own[ground])
    return pieces


def ground_faces(corners: Floats) -> np.ndarray | None:
    """Which faces (m, 3, 3) of one surface are the ground around a tree; None if there is none."""
    centre = corners.mean(axis=1)
    low, height = float(corners[:, :, 1].min()), float(np.ptp(corners[:, :, 1]))
    plan = centre[:, [0, 2]]
    start, size = plan.min(axis=0), max(float(np.ptp(plan, axis=0).max()), 1e-300)
    if not height > 0:
        return None
    in_foot = centre[:, 1] <= low + FOOT_HEIGHT_SHARE * height
    above = (centre[:, 1] > low + FOOT_HEIGHT_SHARE * height) & (
        centre[:, 1] <= low + 2 * FOOT_HEIGHT_SHARE * height
    )
    if in_foot.sum() < 50 or above.sum() < 3:
        return None
    axis = np.median(plan[above], axis=0)
    reach = np.linalg.norm(plan[above] - axis, axis=1)
    trunk = float(np.quantile(reach, 0.8))
    spread = float(np.quantile(np.linalg.norm(plan[in_foot] - axis, axis=1), 0.8))
    cells = int(min(MAX_GRID_CELLS, CELLS_PER_ROOT_FACE * np.sqrt(in_foot.sum()) + 1))
    cell = np.minimum(((plan - start) / size * cells).astype(np.intp), cells - 1)
    terrain = np.full((cells, cells), np.inf)
    np.minimum.at(terrain, (cell[in_foot, 0], cell[in_foot, 1]), centre[in_foot, 1])
    covered = float(np.isfinite(terrain).mean()) * size**2 / max(float(np.prod(np.ptp(plan, axis=0))), 1e-300)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    level = float((normal[in_foot, 1] ** 2 / area[in_foot]).sum() / area[in_foot].sum())
    if spread < MIN_WIDENING_RATIO * trunk or covered < MIN_COVERED_SHARE or level < MIN_LEVELNESS:
        return None
    smooth = _filled(terrain)
    floor = smooth[cell[:, 0], cell[:, 1]]
    away = np.linalg.norm(plan - axis, axis=1)
    near = 1.3 * trunk + GROUND_LIFT_SHARE * height
    ground = (centre[:, 1] <= floor + GROUND_LIFT_SHARE * height) | (in_foot & (away > 2.5 * near))
    return ground & ((away > near) | (centre[:, 1] < floor + 0.2 * GROUND_LIFT_SHARE * height))


def _filled(terrain: Floats) -> Floats:
    """The terrain without gaps and spikes, smoothed."""
    from scipy.ndimage import gaussian_filter, median_filter  # slow to load, and few files have ground

    known = np.isfinite(terrain)
    middle = float(np.median(terrain[known]))
    value = median_filter(np.where(known, terrain, middle), 3)
    weight = np.asarray(gaussian_filter(known.astype(np.float64), 1.5))
    filled = np.asarray(gaussian_filter(np.where(known, value, 0.0), 1.5)) / np.maximum(weight, 1e-9)
    return np.where(weight > 1e-3, filled, middle)

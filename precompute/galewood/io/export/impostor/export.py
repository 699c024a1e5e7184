"""`--to impostor`: pictures of a tree from 64 directions, from which an engine draws it far away.

A texel stands for RAYS_PER_SIDE² rays. Colour, normal and depth are means of what they meet, coverage the
share that meets anything; texels of no coverage repeat those nearest to them, so that filtering blends in no
background.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.impostor.layout import VIEWS_PER_SIDE, view_axes, view_directions
from galewood.io.export.impostor.raster import NOTHING_M, Seen
from galewood.io.export.impostor.surfaces import Surface, srgb_of, surfaces_of
from galewood.io.export.options import ExportOptions
from galewood.table import Table
from galewood.util import Floats

RAYS_PER_SIDE = 4
"""Rays along each side of a texel."""
MARGIN_TEXELS = 2
"""At least, around the tree in every view: filtering does not reach the next one."""
LAYOUT_NOTE = (
    "hemi-octahedral: column and row (from the top) of a view are 0 to views_per_side - 1; "
    "with s = 2 column / (views_per_side - 1) - 1 and t = 2 row / (views_per_side - 1) - 1, "
    "the eye is in the direction of (x, y, z) = ((s + t) / 2, 1 - |x| - |z|, (s - t) / 2); "
    "inversely, s = (x + z) / n and t = (x - z) / n, n = |x| + y + |z|. "
    "A view is upright, parallel, and shows radius_m to each side of centre_m"
)
NORMAL_NOTE = "RGB: unit normal in the tree's axes, 2 value - 1"
DEPTH_NOTE = "alpha: (2 value - 1) radius_m in front of the plane through centre_m that faces the eye"


def export_impostor(
    table: Table, glb: bytes, folder: Path, name: str, options: ExportOptions
) -> dict[str, Any]:
    """Write NAME_base_color.png, NAME_normal_depth.png and a description; return it. Raises ExportError."""
    from PIL import Image

    file = GltfFile(glb, table)
    surfaces = surfaces_of(file, table)
    side = options.pixels // VIEWS_PER_SIDE
    centre_m, radius_m = sphere_of(surfaces, side)
    base_color, normal_depth = atlas_of(surfaces, centre_m, radius_m, side)
    folder.mkdir(parents=True, exist_ok=True)
    pictures = {"base_color": base_color, "normal_depth": normal_depth}
    for use, pixels in pictures.items():
        Image.fromarray(pixels).save(folder / f"{name}_{use}.png")
    description: dict[str, Any] = {
        "format": "galewood-impostor",
        "version": 1,
        **{use: f"{name}_{use}.png" for use in pictures},
        "views_per_side": VIEWS_PER_SIDE,
        "view_pixels": side,
        "up_axis": "y",
        "centre_m": centre_m.tolist(),
        "radius_m": radius_m,
        "height_m": float(table.metadata["height_m"]),
        "layout": LAYOUT_NOTE,
        "normal": NORMAL_NOTE,
        "depth": DEPTH_NOTE,
    }
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    return description


def sphere_of(surfaces: list[Surface], side: int) -> tuple[Floats, float]:
    """Centre (3,), m, the middle of the box around all triangles, and radius, m, with the margin of views.

    ``side``: texels along each side of a view.
    """
    corners = np.concatenate([surface.corner_m.reshape(-1, 3) for surface in surfaces])
    centre_m = 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    radius_m = float(np.linalg.norm(corners - centre_m, axis=1).max())
    return centre_m, radius_m * side / (side - 2 * MARGIN_TEXELS)


def atlas_of(
    surfaces: list[Surface], centre_m: Floats, radius_m: float, side: int
) -> tuple[npt.NDArray[np.uint8], npt.NDArray[np.uint8]]:
    """Both pictures (h, w, 4) of all views, each ``side`` texels wide."""
    whole = np.zeros((2, VIEWS_PER_SIDE * side, VIEWS_PER_SIDE * side, 4), np.uint8)
    for view, direction in enumerate(view_directions()):
        seen = seen_from(surfaces, direction, centre_m, radius_m, side * RAYS_PER_SIDE)
        row, column = (side * place for place in divmod(view, VIEWS_PER_SIDE))
        whole[:, row : row + side, column : column + side] = _texels(seen, radius_m, side)
    return whole[0], whole[1]


def seen_from(
    surfaces: list[Surface], direction: Floats, centre_m: Floats, radius_m: float, rays: int
) -> Seen:
    """What ``rays``² parallel rays from a direction (3,) meet in the square around the tree."""
    seen, axes = Seen.nothing(rays), view_axes(direction)
    for surface in surfaces:
        surface.draw_into(seen, axes, centre_m, radius_m)
    return seen


def _texels(seen: Seen, radius_m: float, side: int) -> npt.NDArray[np.uint8]:
    """(2, side, side, 4) both pictures of a view."""
    from scipy.ndimage import distance_transform_edt

    met = seen.depth_m > NOTHING_M
    coverage = _means(met[..., None].astype(np.float64), side)[..., 0]
    share = np.maximum(coverage, 1e-9)[..., None]
    look = _means(np.where(met[..., None], seen.look, 0.0), side) / share
    depth = _means(np.where(met, seen.depth_m, 0.0)[..., None], side) / share
    normal = look[..., 3:] / np.maximum(np.linalg.norm(look[..., 3:], axis=2, keepdims=True), 1e-9)
    surface = np.concatenate([0.5 + 0.5 * normal, 0.5 + 0.5 * depth / radius_m], axis=2)
    nearest: Any = distance_transform_edt(coverage == 0, return_distances=False, return_indices=True)
    rows, columns = nearest
    colour = np.concatenate([srgb_of(look[..., :3])[rows, columns], coverage[..., None]], axis=2)
    return np.rint(255 * np.stack([colour, surface[rows, columns]])).astype(np.uint8)


def _means(values: Floats, side: int) -> Floats:
    """(side, side, k) means of square blocks of values (n, n, k)."""
    block = len(values) // side
    return values.reshape(side, block, side, block, -1).mean(axis=(1, 3))

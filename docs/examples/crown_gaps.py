"""Gaps in the crowns of the built-in trees, seen from the side: the figures of assets/species/README.md.

The crowns are those that browsers draw: some species have fuller shoots than their meshes.

Run from the repository: ``python docs/examples/crown_gaps.py assets/species/shipped``.
"""

import math
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.impostor.export import seen_from, sphere_of
from galewood.io.export.impostor.raster import NOTHING_M
from galewood.io.export.impostor.surfaces import surfaces_of
from galewood.table import decode
from PIL import Image
from scipy.ndimage import binary_closing

RAY_SPACING_M = 0.04
OUTLINE_GAP_M = 0.6
"""Openings that are narrower than this belong to the crown, wider ones at its edge do not."""
SIDES = 8
"""Horizontal directions from which a crown is seen."""

folder = Path(sys.argv[1])
for path in sorted(folder.glob("*.table")):
    if path.name.endswith(".bare.table"):
        continue
    table = decode(path.read_bytes())
    surfaces = surfaces_of(GltfFile(path.with_suffix(".glb").read_bytes(), table), table)
    leafy = [drawn["kind"] == "leaves" for drawn in table.metadata["primitives"]]
    shoots = folder.parent / f"{path.stem.partition('-')[0]}.shoots.png"
    if shoots.is_file():
        picture = np.asarray(Image.open(shoots).convert("RGBA"), np.float32) / 255
        surfaces = [
            replace(one, picture=picture) if cards else one
            for one, cards in zip(surfaces, leafy, strict=True)
        ]
    leaves = [one for one, cards in zip(surfaces, leafy, strict=True) if cards]
    centre_m, radius_m = sphere_of(leaves, 64)
    rays = math.ceil(2 * radius_m / RAY_SPACING_M)
    gaps = list[float]()
    for side in range(SIDES):
        turn = 2 * math.pi * side / SIDES
        direction = np.array([math.cos(turn), 0.0, math.sin(turn)])
        covered = seen_from(surfaces, direction, centre_m, radius_m, rays).depth_m > NOTHING_M
        leaf_covered = seen_from(leaves, direction, centre_m, radius_m, rays).depth_m > NOTHING_M
        reach = round(0.5 * OUTLINE_GAP_M / RAY_SPACING_M)
        down, along = np.mgrid[-reach : reach + 1, -reach : reach + 1]
        disc = down**2 + along**2 <= reach**2
        outline = np.asarray(binary_closing(np.pad(leaf_covered, reach), disc), bool)
        outline = outline[reach:-reach, reach:-reach]
        gaps.append(1.0 - covered[outline].mean())
    print(
        f"{path.stem} {100 * np.median(gaps):.0f} % ({100 * min(gaps):.0f} to {100 * max(gaps):.0f})",
        flush=True,
    )

"""What an impostor shows of a tree: its triangles with normals, pictures and the opacity that counts."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from galewood.io.export.gltf_file import GltfFile, given
from galewood.io.export.gltf_names import image_of
from galewood.io.export.impostor.raster import Seen, draw
from galewood.table import Table
from galewood.util import Floats

NO_HOLES = -1.0
"""Cutoff of opaque materials."""
DEFAULT_CUTOFF = 0.5
"""Of glTF, for materials that do not say one; also of blended ones, which have none."""


@dataclass(frozen=True)
class Surface:
    """The triangles of one mesh; m, axes of the table."""

    corner_m: Floats
    """(f, 3, 3)"""
    normal: Floats
    """(f, 3, 3) of the corners."""
    uv: Floats
    """(f, 3, 2)"""
    picture: npt.NDArray[np.float32]
    """(h, w, 4) base colour, linear, and opacity."""
    cutoff: float
    """Places with less opacity are holes."""
    both_sides: bool
    """Seen from behind too, with the normal reversed (glTF 2.0, section 3.9.6)."""

    def draw_into(self, seen: Seen, axes: Floats, centre_m: Floats, radius_m: float) -> None:
        """Draw what is seen along the axes (3, 3) of a view: a square, radius to each side of the centre."""
        side = len(seen.depth_m)
        moved = (self.corner_m - centre_m) @ axes.T
        scale = 0.5 * side / radius_m
        at = np.stack(
            [0.5 * side + scale * moved[..., 0], 0.5 * side - scale * moved[..., 1], moved[..., 2]], -1
        )
        first, second = at[:, 1, :2] - at[:, 0, :2], at[:, 2, :2] - at[:, 0, :2]
        # rows go down, so that the corners of what faces the eye go round clockwise
        front = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0] < 0
        shown = front | self.both_sides
        normal = np.where(front[:, None, None], self.normal, -self.normal)
        draw(at[shown], normal[shown], self.uv[shown], self.picture, self.cutoff, seen.depth_m, seen.look)


def surfaces_of(file: GltfFile, table: Table) -> list[Surface]:
    """The meshes of the file that the table's tree shows: without leaves if it is bare."""
    splits = np.cumsum(file.counts)[:-1]
    rest, normals = np.split(file.rest_m(), splits), np.split(file.normals(), splits)
    parts = zip(
        rest, normals, file.texture_coordinates(), file.faces(), table.metadata["primitives"], strict=True
    )
    found = list[Surface]()
    for index, (rest_m, normal, uv, faces, primitive) in enumerate(parts):
        if table.foliage == "bare" and primitive["kind"] == "leaves":
            continue
        material = file.gltf.materials[given(file.gltf.meshes[index].primitives[0].material)]
        cutoff = NO_HOLES
        if material.alphaMode in ("MASK", "BLEND"):
            cutoff = DEFAULT_CUTOFF if material.alphaCutoff is None else material.alphaCutoff
        coordinates = np.zeros((len(rest_m), 2)) if uv is None else uv.astype(np.float64)
        found.append(
            Surface(
                rest_m[faces], normal[faces], coordinates[faces], _picture(file, index), cutoff,
                bool(material.doubleSided),
            )
        )  # fmt: skip
    return found


def _picture(file: GltfFile, index: int) -> npt.NDArray[np.float32]:
    """(h, w, 4) base colour of a mesh, linear, and opacity; one texel if it has no picture."""
    material = file.gltf.materials[given(file.gltf.meshes[index].primitives[0].material)]
    surface = material.pbrMetallicRoughness
    factor = np.array((surface and surface.baseColorFactor) or (1.0, 1.0, 1.0, 1.0), np.float32)
    if surface is None or surface.baseColorTexture is None:
        return factor.reshape(1, 1, 4)
    from PIL import Image

    content, _ = file.image(image_of(file.gltf, surface.baseColorTexture))
    texels = np.asarray(Image.open(io.BytesIO(content)).convert("RGBA"), np.float64) / 255
    texels[..., :3] = linear(texels[..., :3])
    return (texels * factor).astype(np.float32)


def linear(srgb: Floats) -> Floats:
    """Linear values of sRGB values, both 0 to 1 (IEC 61966-2-1)."""
    return np.where(srgb <= 0.04045, srgb / 12.92, np.power((srgb + 0.055) / 1.055, 2.4))


def srgb_of(linear_values: Floats) -> Floats:
    """The inverse of ``linear``."""
    values = np.clip(linear_values, 0.0, 1.0)
    return np.where(values <= 0.0031308, 12.92 * values, 1.055 * np.power(values, 1 / 2.4) - 0.055)

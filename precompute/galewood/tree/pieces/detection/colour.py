"""Colour of every face: base colour texture at its own coordinates × base colour factor × vertex colours.

An atlas holds bark and leaves in one image, so that only the pixels under a face say what it is. Factors
and vertex colours multiply in linear light (glTF 2.0, sections 3.9.2 and 3.7.2.1); the result is sRGB.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from galewood.formats import IMAGE_ERRORS, Material, RawPart, base_image
from galewood.util import Floats

LARGEST_SIDE = 1024  # pixels; larger images are reduced first: a face covers many pixels
BATCH_FACES = 1 << 16  # faces per batch
CLAMP_TO_EDGE, MIRRORED_REPEAT = 33071, 33648
# ten points inside a triangle, as weights of its corners
POINT_WEIGHTS = np.array(
    [(i, j, 3 - i - j) for i in range(4) for j in range(4 - i)], dtype=np.float64
) * 0.84 / 3 + 0.16 / 3  # fmt: skip


@dataclass(frozen=True)
class FaceColours:
    """sRGB colours (m, 3) from 0 to 1, and the share (m,) of each face that its alpha channel cuts out.

    `known` is false where the file gives no colour: white is the default of every format.
    """

    rgb: Floats
    cut_out: Floats
    known: bool


def face_colours(part: RawPart) -> FaceColours:
    """The colours of a part's faces. Images that cannot be decoded count as absent."""
    count = len(part.faces)
    linear, alpha, known = np.ones((count, 3)), np.zeros(count), False
    pbr: dict[str, Any] = part.material.json.get("pbrMetallicRoughness", {}) if part.material else {}
    texture = _sampled(part)
    if texture is not None:
        linear, alpha, known = texture[0], texture[1], True
    factor = np.array(pbr.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0)), dtype=np.float64).reshape(-1)
    if len(factor) >= 3 and np.isfinite(factor).all():
        linear = linear * np.clip(factor[:3], 0.0, 1.0)
        known = known or bool((factor[:3] < 0.99).any())
    if part.colours is not None and part.colours.shape[1] >= 3:
        of_face = np.clip(part.colours, 0.0, 1.0)[part.faces].mean(axis=1)
        linear = linear * of_face[:, :3]
        known = known or bool((of_face[:, :3] < 0.97).any())
    return FaceColours(_srgb(linear), alpha, known)


def _sampled(part: RawPart) -> tuple[Floats, Floats] | None:
    """Mean linear colour (m, 3) of opaque samples and share (m,) of cut-out samples; None without a texture.

    The alpha channel of an OPAQUE material is not drawn, but an image whose alpha is cut out under a face was
    still made for leaves, so it counts in every mode.
    """
    pixels = _pixels(part.material)
    if pixels is None or part.material is None:
        return None
    info = part.material.json["pbrMetallicRoughness"]["baseColorTexture"]
    uv = part.uv if info.get("texCoord", 0) == 0 else None
    if uv is None:
        return None
    uv = _transformed(uv, info.get("extensions", {}).get("KHR_texture_transform"))
    sampler = part.material.samplers.get(info["index"], {})
    cutoff = float(part.material.json.get("alphaCutoff", 0.5)) * 255
    light, holes = np.empty((len(part.faces), 3)), np.empty(len(part.faces))
    for start in range(0, len(part.faces), BATCH_FACES):
        rows = slice(start, start + BATCH_FACES)
        points = np.einsum("sk,mkc->msc", POINT_WEIGHTS, uv[part.faces[rows]])
        found = pixels[_index(points[..., 1], len(pixels), sampler.get("wrapT")),
                       _index(points[..., 0], pixels.shape[1], sampler.get("wrapS"))]  # fmt: skip
        solid = found[..., 3] >= cutoff
        weight = np.where(solid.any(axis=1, keepdims=True), solid, 1.0)[..., None]
        colour = _linear(found[..., :3] / 255.0)
        light[rows] = (colour * weight).sum(axis=1) / weight.sum(axis=1)
        holes[rows] = 1.0 - solid.mean(axis=1)
    return light, holes


def _pixels(material: Material | None) -> NDArray[np.uint8] | None:
    image = base_image(material)
    if image is None:
        return None
    try:
        factor = max(1, max(image.size) // LARGEST_SIDE)
        rgba = image.convert("RGBA")
        return np.asarray(rgba.reduce(factor) if factor > 1 else rgba)
    except IMAGE_ERRORS:
        return None


def _index(coordinate: Floats, size: int, wrap: int | None) -> NDArray[np.intp]:
    if wrap == CLAMP_TO_EDGE:
        share = np.clip(coordinate, 0.0, 1.0)
    elif wrap == MIRRORED_REPEAT:
        share = 1.0 - np.abs(np.mod(coordinate, 2.0) - 1.0)
    else:
        share = np.mod(coordinate, 1.0)
    return np.clip((share * size).astype(np.intp), 0, size - 1)


def _transformed(uv: Floats, transform: dict[str, Any] | None) -> Floats:
    """Texture coordinates after KHR_texture_transform: scale, then rotation, then offset."""
    if not transform:
        return uv
    angle = float(transform.get("rotation", 0.0))
    u, v = (uv * np.array(transform.get("scale", (1.0, 1.0)), dtype=np.float64)).T
    turned = np.column_stack([np.cos(angle) * u + np.sin(angle) * v, np.cos(angle) * v - np.sin(angle) * u])
    return turned + np.array(transform.get("offset", (0.0, 0.0)), dtype=np.float64)


def _linear(srgb: Floats) -> Floats:
    return np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)


def _srgb(linear: Floats) -> Floats:
    return np.where(linear <= 0.0031308, linear * 12.92, 1.055 * np.maximum(linear, 0) ** (1 / 2.4) - 0.055)


def hue_saturation_value(rgb: Floats) -> tuple[Floats, Floats, Floats]:
    """Hue in degrees, saturation and value (0 to 1) of colours (..., 3)."""
    high, low = rgb.max(axis=-1), rgb.min(axis=-1)
    span = np.maximum(high - low, 1e-12)
    r, g, b = np.moveaxis(rgb, -1, 0)
    hue = np.select(
        [high == r, high == g], [np.mod((g - b) / span, 6.0), (b - r) / span + 2.0], (r - g) / span + 4.0
    )
    return hue * 60.0, (high - low) / np.maximum(high, 1e-12), high


def hex_colour(rgb: Floats) -> str:
    """A colour as #rrggbb."""
    return "#" + "".join(f"{round(float(np.clip(c, 0, 1)) * 255):02x}" for c in rgb)

"""Thumbnail of a render mesh: triangles drawn back to front with flat shading."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from galewood.formats import RawPart, read_glb
from galewood.sandbox import Arrays, Limits, run_limited
from galewood.tree import RenderPrimitive, face_colours
from galewood.util import Floats

SIDE_PX = 256
OVERSAMPLING_FACTOR = 3
MARGIN_SHARE = 0.04
LIGHT_DIRECTION = np.array([0.4, 0.75, 0.53])  # from above, right and front
WOOD_RGB, LEAVES = (0.45, 0.36, 0.28), (0.42, 0.52, 0.22)
ADDED_RGBA = (70, 190, 255, 150)
LIMITS = Limits(memory_bytes=3 << 30, cpu_s=20)


def draw_limited(glb: bytes, side_px: int = SIDE_PX, added: RenderPrimitive | None = None) -> bytes:
    """Draw a render mesh as square PNG in a child process with limits. Raises MeshError.

    ``added`` is wood that is not part of the render mesh; it shines through.
    """
    corners = added.positions_m[added.faces] if added else np.zeros((0, 3, 3))
    arguments: Arrays = {
        "glb": np.frombuffer(glb, np.uint8),
        "side_px": np.array(side_px),
        "added": np.ascontiguousarray(corners, np.float64),
    }
    return run_limited(
        "galewood.pipeline.pictures.thumbnail:draw_in_child", arguments, LIMITS, what="Drawing the tree"
    )["png"].tobytes()


def draw_in_child(arguments: Arrays) -> Arrays:
    """Entry point of the child process of ``draw_limited``."""
    parts = read_glb(arguments["glb"].tobytes())
    png = draw(parts, int(arguments["side_px"]), arguments["added"])
    return {"png": np.frombuffer(png, np.uint8)}


def draw(parts: list[RawPart], side_px: int = SIDE_PX, added: Floats | None = None) -> bytes:
    """Draw parts as square PNG with a transparent background, viewed along −z; ``added`` (k, 3, 3) on top."""
    triangles = np.concatenate([part.positions[part.faces] for part in parts])
    colours = np.concatenate([_colours(part) for part in parts])
    # A partly transparent leaf card is drawn as a smaller opaque card of the same covered area.
    centres = triangles.mean(axis=1, keepdims=True)
    drawn = centres + (triangles - centres) * np.sqrt(colours[:, 3])[:, None, None]
    image, _ = painted(drawn, colours[:, :3], side_px)
    if added is not None and len(added):
        image.alpha_composite(_over(added, drawn, side_px * OVERSAMPLING_FACTOR).resize(image.size))
    stream = io.BytesIO()
    image.save(stream, format="png", optimize=True)
    return stream.getvalue()


def painted(
    triangles: Floats, colours: Floats, side_px: int, marked: NDArray[np.bool_] | None = None
) -> tuple[Image.Image, Image.Image]:
    """Triangles (k, 3, 3) in colours (k, 3), shaded, back to front; and a mask of those ``marked`` (k,)."""
    side = side_px * OVERSAMPLING_FACTOR
    image, mask = Image.new("RGBA", (side, side)), Image.new("L", (side, side))
    pen, marker = ImageDraw.Draw(image), ImageDraw.Draw(mask)
    corners = _to_pixels(triangles, side).reshape(-1, 6).tolist()
    fills = np.clip(colours * _light(triangles)[:, None] * 255, 0, 255).astype(int).tolist()
    for face in np.argsort(triangles[:, :, 2].mean(axis=1)).tolist():
        pen.polygon(corners[face], fill=tuple(fills[face]))
        if marked is not None:
            marker.polygon(corners[face], fill=255 * int(marked[face]))
    size = side_px, side_px
    return image.resize(size, Image.Resampling.BOX), mask.resize(size, Image.Resampling.BOX)


def _over(added: Floats, triangles: Floats, side: int) -> Image.Image:
    """Triangles (k, 3, 3) in one colour, half transparent."""
    layer = Image.new("RGBA", (side, side))
    pen = ImageDraw.Draw(layer)
    for corners in _to_pixels(added, side, triangles).reshape(-1, 6).tolist():
        pen.polygon(corners, fill=ADDED_RGBA)
    return layer


def _to_pixels(triangles: Floats, side: int, whole: Floats | None = None) -> Floats:
    """(k, 3, 2) corners in pixels; the whole tree is centred and fills the picture."""
    flat, all_corners = triangles[:, :, :2], (triangles if whole is None else whole)[:, :, :2]
    low, high = all_corners.min(axis=(0, 1)), all_corners.max(axis=(0, 1))
    pixels = side * (1 - 2 * MARGIN_SHARE) / max(float((high - low).max()), 1e-9)
    centred = (flat - (low + high) / 2) * pixels
    return np.stack([side / 2 + centred[:, :, 0], side / 2 - centred[:, :, 1]], axis=2)


def _light(triangles: Floats) -> Floats:
    """(k,) brightness of triangles (k, 3, 3): ambient plus diffuse light, equal on both sides."""
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    lengths = np.maximum(np.linalg.norm(normals, axis=1), 1e-30)
    return 0.55 + 0.6 * np.abs(normals @ LIGHT_DIRECTION) / lengths


def _colours(part: RawPart) -> Floats:
    """(k, 4) colour and covered share of each face; leaves vary slightly in brightness.

    The colour is that of the texture under the face, times factors and vertex colours. An alpha channel cuts
    out only what a viewer would: not of an opaque material.
    """
    is_leaf = any(label.startswith("leaves") for label in part.labels)
    found = face_colours(part)
    colours = np.tile(np.array([*(LEAVES if is_leaf else WOOD_RGB), 1.0]), (len(part.faces), 1))
    if found.known:
        colours[:, :3] = found.rgb
    if part.material is not None and part.material.json.get("alphaMode", "OPAQUE") != "OPAQUE":
        colours[:, 3] = 1.0 - found.cut_out
    if is_leaf:
        shades = np.random.default_rng(1).uniform(0.75, 1.2, len(part.faces) // 2 + 1)
        colours[:, :3] *= np.repeat(shades, 2)[: len(part.faces), None]
    return colours

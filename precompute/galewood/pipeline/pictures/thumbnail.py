"""Thumbnail of a render mesh: triangles drawn back to front with flat shading."""

from __future__ import annotations

import io

import numpy as np
from PIL import Image, ImageDraw

from galewood.formats import Material, RawPart, base_image, read_glb
from galewood.sandbox import Arrays, Limits, run_limited
from galewood.tree import RenderPrimitive
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
    triangles = centres + (triangles - centres) * np.sqrt(colours[:, 3])[:, None, None]
    shaded = colours[:, :3] * _light(triangles)[:, None]
    side = side_px * OVERSAMPLING_FACTOR
    flat = _to_pixels(triangles, side)
    image = Image.new("RGBA", (side, side))
    pen = ImageDraw.Draw(image)
    corners = flat.reshape(-1, 6).tolist()
    fills = np.clip(shaded * 255, 0, 255).astype(int).tolist()
    for face in np.argsort(triangles[:, :, 2].mean(axis=1)).tolist():
        pen.polygon(corners[face], fill=tuple(fills[face]))
    if added is not None and len(added):
        image.alpha_composite(_over(added, triangles, side))
    stream = io.BytesIO()
    image.resize((side_px, side_px), Image.Resampling.BOX).save(stream, format="png", optimize=True)
    return stream.getvalue()


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
    """(k, 4) colour and opacity of each face from its material; leaves vary slightly in brightness."""
    is_leaf = any(label.startswith("leaves") for label in part.labels)
    base = np.array([*(LEAVES if is_leaf else WOOD_RGB), 1.0])
    if part.material is not None:
        base = _material_colour(part.material, base)
    colours = np.tile(base, (len(part.faces), 1))
    if is_leaf:
        shades = np.random.default_rng(1).uniform(0.75, 1.2, len(part.faces) // 2 + 1)
        colours[:, :3] *= np.repeat(shades, 2)[: len(part.faces), None]
    return colours


def _material_colour(material: Material, base: Floats) -> Floats:
    surface = material.json.get("pbrMetallicRoughness", {})
    # Material factors are linear; the picture uses a display gamma.
    factor = np.array(surface.get("baseColorFactor", (1.0, 1.0, 1.0, 1.0)), dtype=float)[:3] ** (1 / 2.2)
    image = base_image(material)
    if image is None:
        return np.append(factor, 1.0) if "baseColorFactor" in surface else base
    pixels = np.asarray(image.convert("RGBA").resize((64, 64)), dtype=float) / 255
    weight = pixels[:, :, 3]
    mean = (pixels[:, :, :3] * weight[:, :, None]).sum(axis=(0, 1)) / max(float(weight.sum()), 1e-9)
    return np.append(mean * factor, max(float(weight.mean()), 0.25))

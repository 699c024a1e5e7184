"""Colours, textures and names of the parts of generated trees."""

import io
from dataclasses import dataclass, field

import numpy as np
from PIL import Image

from tests.precompute.labelled_shapes import Rng, Shape

WOOD, LEAVES, OTHER = "wood", "leaves", "other"


@dataclass
class Look:
    """How a part is drawn; everything left out is missing in the file."""

    factor: tuple[float, ...] | None = None  # linear
    image: bytes | None = None
    alpha_mode: str | None = None
    vertex_colour: tuple[float, ...] | None = None  # linear
    cell: tuple[float, ...] | None = None  # part of the image: u0, v0, u1, v1
    noise: float = 0.0  # of the vertex colours


@dataclass
class Part:
    """Shapes with one name and one look, and their label."""

    name: str
    label: str
    shape: Shape
    look: Look = field(default_factory=Look)
    tree: int = 1


def png(pixels: np.ndarray) -> bytes:
    out = io.BytesIO()
    Image.fromarray(pixels.astype(np.uint8)).save(out, "PNG")
    return out.getvalue()


def bark_pixels(rng: Rng, size=32, base=(96, 72, 50)) -> np.ndarray:
    streaks = rng.normal(0, 14, (1, size, 1)) + rng.normal(0, 8, (size, size, 1))
    rgb = np.clip(np.array(base) + streaks, 0, 255)
    return np.concatenate([rgb, np.full((size, size, 1), 255)], axis=2)


def leaf_pixels(rng: Rng, size=32, base=(70, 120, 40)) -> np.ndarray:
    y, x = np.mgrid[0:size, 0:size] / size - 0.5
    alpha = ((np.abs(x) * 1.6 + np.abs(y) < 0.5) * 255)[:, :, None]
    rgb = np.clip(np.array(base) + rng.normal(0, 12, (size, size, 1)), 0, 255)
    return np.concatenate([np.broadcast_to(rgb, (size, size, 3)), alpha], axis=2)


def palette(colours) -> bytes:
    """A palette of four by four cells, as low-poly packs share."""
    rows = [np.array(c) for c in colours]
    grid = np.array([rows[k % len(rows)] for k in range(16)]).reshape(4, 4, 3)
    return png(np.repeat(np.repeat(grid, 8, axis=0), 8, axis=1))


def palette_cell(k: int):
    return (k % 4 / 4 + 0.1, k // 4 / 4 + 0.1, k % 4 / 4 + 0.14, k // 4 / 4 + 0.14)


def atlas(rng: Rng) -> bytes:
    """Bark in the left half, leaves with alpha in the right half."""
    return png(np.concatenate([bark_pixels(rng), leaf_pixels(rng)], axis=1))


BARK_HALF, LEAF_HALF = (0.02, 0.0, 0.48, 1.0), (0.5, 0.0, 1.0, 1.0)


def linear(rgb):
    return tuple(float((c / 255) ** 2.2) for c in rgb)


def green(rng: Rng):
    return tuple(int(c) for c in (rng.integers(30, 120), rng.integers(125, 190), rng.integers(20, 70)))


def brown(rng: Rng):
    r = int(rng.integers(70, 140))
    return (r, int(r * rng.uniform(0.6, 0.8)), int(r * rng.uniform(0.35, 0.55)))


def colours(rng):
    return Look(factor=linear(brown(rng))), Look(factor=linear(green(rng)))

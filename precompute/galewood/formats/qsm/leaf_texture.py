"""The picture on a leaf card: a sprig with leaves, cut out by its alpha channel."""

from __future__ import annotations

import io
from functools import cache

import numpy as np
from PIL import Image

from galewood.util import Floats

TEXTURE_SIZE_PX = 128
LEAF_COUNT = 13
GREEN_RGB = np.array([92.0, 128.0, 52.0])
STALK_WIDTH = 0.012


@cache
def sprig_png() -> bytes:
    """A square PNG with alpha; the stalk begins in the middle of its lower edge."""
    random = np.random.default_rng(0)
    centres = (np.arange(TEXTURE_SIZE_PX) + 0.5) / TEXTURE_SIZE_PX
    x, y = np.meshgrid(centres - 0.5, 1.0 - centres)
    rgb = np.broadcast_to(GREEN_RGB, (TEXTURE_SIZE_PX, TEXTURE_SIZE_PX, 3)).copy()
    alpha = (np.abs(x) < STALK_WIDTH) & (y < 0.8)
    for number in range(LEAF_COUNT):
        at = 0.08 + 0.64 * number / (LEAF_COUNT - 1)
        lean = (-1) ** number * random.uniform(0.7, 1.25) if number < LEAF_COUNT - 1 else 0.0
        length, width = random.uniform(0.32, 0.42), random.uniform(0.075, 0.1)
        inside, edge = _leaf(x, y - at, lean, length, width)
        shade = random.uniform(0.82, 1.15) * (1.08 - 0.22 * edge)
        rgb = np.where(inside[:, :, None], np.clip(GREEN_RGB * shade[:, :, None], 0, 255), rgb)
        alpha = alpha | inside
    picture = np.dstack([rgb, 255.0 * alpha]).astype(np.uint8)
    out = io.BytesIO()
    Image.fromarray(picture, "RGBA").save(out, "PNG", optimize=True)
    return out.getvalue()


def _leaf(x: Floats, y: Floats, lean: float, length: float, width: float) -> tuple[np.ndarray, Floats]:
    """Which pixels belong to a leaf that grows from the origin, and how near its edge they are, 0 to 1."""
    along = (x * np.sin(lean) + y * np.cos(lean)) / length
    across = np.abs(x * np.cos(lean) - y * np.sin(lean))
    half = width * np.sin(np.pi * np.clip(along, 0.0, 1.0) ** 0.8)
    return across < half, np.clip(across / np.maximum(half, 1e-9), 0.0, 1.0)

"""Thumbnails: positions, colours and depth order of what is drawn."""

import io

import numpy as np
from galewood.formats.types import RawPart
from galewood.pipeline.pictures.thumbnail import SIDE_PX, draw
from PIL import Image

SQUARE = np.array([[0, 0], [1, 0], [1, 1], [0, 1]], dtype=float)
FACES = np.array([[0, 1, 2], [0, 2, 3]])


def part(label: str, low, high, z: float = 0.0) -> RawPart:
    """A rectangle facing the viewer."""
    flat = np.array(low) + SQUARE * (np.array(high) - np.array(low))
    return RawPart((label,), np.column_stack([flat, np.full(4, z)]), FACES)


def pixels(*parts: RawPart) -> np.ndarray:
    return np.asarray(Image.open(io.BytesIO(draw(list(parts)))).convert("RGBA"), dtype=int)


def test_trunk_and_crown_are_drawn_in_place():
    picture = pixels(part("wood_0", (-0.1, 0), (0.1, 2)), part("leaves_0", (-1, 2), (1, 4)))
    assert picture.shape == (SIDE_PX, SIDE_PX, 4)
    trunk, crown, beside = picture[200, 128], picture[64, 128], picture[200, 20]
    assert trunk[3] == crown[3] == 255 and beside[3] == 0
    assert trunk[0] > trunk[1] > trunk[2] and crown[1] > crown[0] > crown[2]


def test_near_parts_hide_far_parts():
    wood, leaves = part("wood_0", (0, 0), (1, 1), z=1.0), part("leaves_0", (0, 0), (1, 1), z=-1.0)
    for order in ((wood, leaves), (leaves, wood)):
        middle = pixels(*order)[128, 128]
        assert middle[0] > middle[1] > middle[2]

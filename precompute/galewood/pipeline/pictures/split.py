"""Picture of what was detected in a file: wood, leaves, what is left out, and what is uncertain."""

from __future__ import annotations

import io
from typing import Any

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw

from galewood.options import ImportRequest
from galewood.pipeline.pictures.thumbnail import LIMITS, painted
from galewood.sandbox import Arrays, from_json_array, run_limited, to_bytes_array, to_json_array
from galewood.tree import detected_faces
from galewood.util import Floats

SPLIT_RGB = {"wood": (0.75, 0.54, 0.33), "twigs": (0.59, 0.4, 0.24), "leaves": (0.5, 0.69, 0.38),
             "other": (0.85, 0.25, 0.2)}  # fmt: skip
"""Colours of kinds; "other" is left out."""
LEGEND_WORDS = {"wood": "wood", "leaves": "leaves", "other": "left out", "unsure": "unsure"}
STRIPE_PX, LEGEND_PX = 5, 32
INK_RGBA, PAPER_RGBA = (40, 46, 50, 255), (255, 255, 255, 255)


def check_picture(tree_png: bytes, data: bytes, filename: str, options: ImportRequest, side_px: int) -> bytes:
    """A picture of an imported tree, and beside it what was detected in its file. Raises MeshError."""
    request = {"filename": filename, "options": options.model_dump(exclude_none=True), "side_px": side_px}
    result = run_limited(
        "galewood.pipeline.pictures.split:split_in_child",
        {"data": to_bytes_array(data), "request": to_json_array(request)},
        LIMITS,
        what="Drawing the pieces",
    )
    sides = [Image.open(io.BytesIO(png)).convert("RGBA") for png in (tree_png, result["png"].tobytes())]
    page = Image.new("RGBA", (2 * side_px, side_px), PAPER_RGBA)
    for number, side in enumerate(sides):
        page.alpha_composite(side, (number * side_px, 0))
    stream = io.BytesIO()
    page.convert("RGB").save(stream, format="png", optimize=True)
    return stream.getvalue()


def split_in_child(arguments: Arrays) -> Arrays:
    """Entry point of the child process of ``check_picture``."""
    request: dict[str, Any] = from_json_array(arguments["request"])
    options = ImportRequest.model_validate(request["options"])
    faces = detected_faces(arguments["data"].tobytes(), request["filename"], options)
    png = draw_split(faces.corners, faces.kind, faces.unsure, int(request["side_px"]))
    return {"png": to_bytes_array(png)}


def draw_split(corners: Floats, kind: list[str], unsure: NDArray[np.bool_], side_px: int) -> bytes:
    """Triangles (k, 3, 3) in the colour of their kind; uncertain ones are hatched. A square PNG."""
    colours, inner_px = np.array([SPLIT_RGB[one] for one in kind]), side_px - LEGEND_PX
    tree, marked = painted(corners, colours, inner_px, unsure)
    tree.paste(Image.new("RGBA", tree.size, INK_RGBA), mask=_hatched(marked))
    image = Image.new("RGBA", (side_px, side_px))
    image.paste(tree, (LEGEND_PX // 2, 0))
    _legend(image)
    stream = io.BytesIO()
    image.save(stream, format="png", optimize=True)
    return stream.getvalue()


def _hatched(marked: Image.Image) -> Image.Image:
    """The mask, only where stripes are."""
    side = marked.size[0]
    down, right = np.mgrid[:side, :side]
    stripes = (down + right) % (2 * STRIPE_PX) < STRIPE_PX // 2
    return Image.fromarray(np.asarray(marked) * stripes.astype(np.uint8))


def _legend(image: Image.Image) -> None:
    pen, side, left = ImageDraw.Draw(image), image.size[0], 10
    for kind, word in LEGEND_WORDS.items():
        box = (left, side - 24, left + 14, side - 10)
        fill = tuple(int(255 * c) for c in SPLIT_RGB.get(kind, (0.9, 0.9, 0.9)))
        pen.rectangle(box, fill=fill, outline=INK_RGBA)
        if kind == "unsure":
            for shift in (4, 9, 14, 19, 24):
                pen.line((left + max(shift - 14, 0), side - 24 + min(shift, 14), left + min(shift, 14),
                          side - 24 + max(shift - 14, 0)), fill=INK_RGBA)  # fmt: skip
        pen.text((left + 19, side - 23), word, fill=INK_RGBA)
        left += 29 + int(pen.textlength(word)) + 10

"""Vertex animation textures: a looping motion that a vertex shader reads (docs/how-to/exports.md).

Every vertex of a table moves rigidly with one of a few hundred joints, so a texel belongs to a joint and not
to a vertex: one texture holds the displacements of the joints, one their rotations, a row (or a few) per
frame; a small third one holds their places at rest. The rotation also turns the normals. That is exact, and
some twenty times smaller than offsets and normals of every vertex.

TEXCOORD_1 of a vertex is the centre of its joint's texel in the rows of frame 0.
"""

from __future__ import annotations

import json
from dataclasses import dataclass
from importlib import resources
from pathlib import Path
from typing import Any

import numpy as np

from galewood.io.export.engine.levels import write_levels
from galewood.io.export.errors import ExportError
from galewood.io.export.gltf_file import GltfFile
from galewood.io.export.gltf_names import give_names
from galewood.io.export.looped import Loop, seam
from galewood.io.export.options import ExportOptions, TextureFormat
from galewood.io.export.skeletal.joints import RigidMotion, joint_motion, joint_of_vertex, rotated
from galewood.io.export.textures import (
    MAX_HEIGHT_PX,
    MAX_WIDTH_PX,
    Written,
    read_texture,
    write_texture,
)
from galewood.solid.skinning import drawn_positions
from galewood.table import Table
from galewood.util import Floats

FORMAT, VERSION = "galewood-vat", 1
AXES_NOTE = "glTF: metres, x right, y up, z towards the viewer, right-handed; row 0 of a texture is its top"
MEASURED_MOMENTS = 96


@dataclass(frozen=True)
class Layout:
    """Where the texels are: ``bodies`` joints in rows of ``width`` texels, ``rows`` of them per frame."""

    bodies: int
    frames: int

    @property
    def width(self) -> int:
        """Texels per row: a power of two, as some engines scale other textures."""
        return min(_power_of_two(self.bodies), MAX_WIDTH_PX)

    @property
    def rows(self) -> int:
        """Rows per frame."""
        return -(-self.bodies // self.width)

    @property
    def height(self) -> int:
        """Rows of the animated textures: a power of two, those after the last frame repeat the first ones."""
        return _power_of_two(self.frames * self.rows)

    def texels(self, values: Floats) -> Floats:
        """(height, width, k) picture of values (T, b, k); what is left over of a row is 0."""
        count, _, k = values.shape
        filled = np.zeros((count, self.rows * self.width, k))
        filled[:, : self.bodies] = values
        return filled.reshape(count * self.rows, self.width, k)

    def animated(self, values: Floats) -> Floats:
        """The same for values of all frames, with its height filled up from the first frames."""
        picture = self.texels(values)
        return picture[np.arange(self.height) % len(picture)]

    def values(self, picture: Floats, frame: int) -> Floats:
        """(b, k) values of a frame."""
        rows = picture[frame * self.rows : (frame + 1) * self.rows]
        return rows.reshape(-1, picture.shape[2])[: self.bodies]

    def coordinates(self, body: np.ndarray[Any, Any]) -> np.ndarray[Any, Any]:
        """(v, 2) centres of the texels of bodies (v,) in frame 0, in 0..1 of the picture, from its top."""
        column, row = body % self.width, body // self.width
        return np.stack([(column + 0.5) / self.width, (row + 0.5) / self.height], axis=1).astype(np.float32)


def _power_of_two(count: int) -> int:
    return 1 << max(0, int(count) - 1).bit_length()


def export_vat(
    table: Table, glb: bytes, loop: Loop, folder: Path, name: str, options: ExportOptions
) -> dict[str, Any]:
    """Write textures, meshes, description and decoders; return the description. Raises ExportError."""
    file = GltfFile(glb, table)
    give_names(file.gltf, name)
    motion = joint_motion(table, loop.q())
    layout = Layout(motion.moved_m.shape[1], loop.frames)
    if layout.height > MAX_HEIGHT_PX:
        raise ExportError(
            f"{loop.frames} frames of {layout.bodies} joints need {layout.height} rows of texels; engines "
            f"take {MAX_HEIGHT_PX}: choose a shorter loop or fewer frames per second"
        )
    textures = _write_textures(table, motion, layout, folder, name, options.format)
    file.add_second_coordinates(layout.coordinates(joint_of_vertex(table)))
    description = _description(table, loop, layout, textures)
    rest_m = file.rest_m()
    decoded = Decoder(folder, layout, textures)
    description["bounds_m"] = _bounds(table, rest_m, loop)
    description["measured"] = {"error_percent_of_height": error_percent(table, rest_m, loop, decoded)} | seam(
        table, rest_m, loop
    )
    description["mesh"] = f"{name}.glb"
    description["levels"] = write_levels(file, table, folder, name, options.levels)
    file.note("galewood_vat", description)
    (folder / f"{name}.glb").write_bytes(file.glb())
    (folder / f"{name}.json").write_text(json.dumps(description, indent=2) + "\n")
    _write_decoders(folder, name, description)
    return description


def _write_textures(
    table: Table, motion: RigidMotion, layout: Layout, folder: Path, name: str, kind: TextureFormat
) -> dict[str, Written]:
    place = table.joint_rest_m.astype(np.float64)[None]
    return {
        "offset": write_texture(folder, f"{name}_offset", layout.animated(motion.moved_m), kind),
        "rotation": write_texture(
            folder, f"{name}_rotation", layout.animated(motion.rotation[:, :, :3]), kind
        ),
        "pivot": write_texture(folder, f"{name}_pivot", layout.texels(place), kind, single=True),
    }


def _description(table: Table, loop: Loop, layout: Layout, textures: dict[str, Written]) -> dict[str, Any]:
    return {
        "format": FORMAT,
        "version": VERSION,
        "axes": AXES_NOTE,
        **loop.about(table),
        "width": layout.width,
        "height": layout.height,
        "rows_per_frame": layout.rows,
        "joints": layout.bodies,
        "textures": {use: written.about() for use, written in textures.items()},
    }


class Decoder:
    """Reads the written textures again and moves vertices as the shaders do."""

    def __init__(self, folder: Path, layout: Layout, textures: dict[str, Written]) -> None:
        self._layout = layout
        self._offset, self._rotation, pivot = (
            read_texture(folder, textures[use]) for use in ("offset", "rotation", "pivot")
        )
        self._place = layout.values(pivot, 0)

    def positions(self, rest_m: Floats, body: np.ndarray[Any, Any], frame: float) -> Floats:
        """(v, 3) vertices at a frame number, which may lie between two; the frame after the last is 0."""
        first = int(frame) % self._layout.frames
        second, share = (first + 1) % self._layout.frames, frame - int(frame)
        moved, turn = (
            (1 - share) * self._layout.values(picture, first) + share * self._layout.values(picture, second)
            for picture in (self._offset, self._rotation)
        )
        w = np.sqrt(np.maximum(1.0 - np.square(turn).sum(axis=1, keepdims=True), 0.0))
        rotation = np.concatenate([turn, w], axis=1)
        return (self._place + moved)[body] + rotated(rotation[body], rest_m - self._place[body])


def error_percent(table: Table, rest_m: Floats, loop: Loop, decoded: Decoder) -> float:
    """Largest distance of a decoded vertex from the table's, in % of the height; at frames and between."""
    body, worst = joint_of_vertex(table), 0.0
    # an open loop jumps from its last frame to the first
    end = loop.frames if loop.closed else loop.frames - 1
    for frame in np.linspace(0.0, end, MEASURED_MOMENTS, endpoint=False):
        exact = drawn_positions(table, rest_m, loop.q_at(frame * loop.seconds / loop.frames))
        apart = np.linalg.norm(decoded.positions(rest_m, body, float(frame)) - exact, axis=1)
        worst = max(worst, float(apart.max()))
    return 100 * worst / float(table.metadata["height_m"])


def _bounds(table: Table, rest_m: Floats, loop: Loop) -> dict[str, list[float]]:
    """The box that the moving tree never leaves: engines hide a tree whose box at rest is out of view."""
    q = loop.q()[:: max(1, loop.frames // 24)]
    drawn = np.concatenate([rest_m, *(drawn_positions(table, rest_m, row) for row in q)])
    margin = 0.02 * float(table.metadata["height_m"])
    return {"low": (drawn.min(axis=0) - margin).tolist(), "high": (drawn.max(axis=0) + margin).tolist()}


def _write_decoders(folder: Path, name: str, description: dict[str, Any]) -> None:
    """Write the decoders, with the numbers of this export as their defaults."""
    values: dict[str, Any] = {"NAME": name, "FRAMES": description["frames"], "FPS": description["fps"]}
    values["ROWS"] = description["rows_per_frame"]
    for use, written in description["textures"].items():
        for end in ("low", "high"):
            values[f"{use}_{end}".upper()] = ", ".join(_real(value) for value in written[end])
    for source in resources.files("galewood.io.export").joinpath("decoders").iterdir():
        stem, _, ending = source.name.rpartition(".")
        text = source.read_text()
        for key, value in values.items():
            text = text.replace(f"@{key}@", _real(value) if isinstance(value, float) else str(value))
        target = f"{stem}.{ending}" if ending in ("js", "ts") else f"{name}.{ending}"
        (folder / target).write_text(text)


def _real(value: float) -> str:
    """A number that shaders take for a float, not for an integer."""
    text = f"{value:.9g}"
    return text if "." in text or "e" in text else f"{text}.0"

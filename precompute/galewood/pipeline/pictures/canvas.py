"""Common parts of the pictures of a build: page, camera, lighting and PNG output."""

from __future__ import annotations

import io
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from PIL import Image

from galewood.util import Floats

PAGE_COLOUR, INK_COLOUR, SOFT_INK = "#141b20", "#f4efe6", "#a9b1b3"
PALETTE_COLOURS = 255
"""Palette size; keeps a picture below 200 kB."""
SIZE_INCHES, DOTS_PER_INCH = (9.6, 9.6), 100


@dataclass(frozen=True)
class Camera:
    """Orthographic camera: rotation about the vertical and elevation, degrees."""

    turn_deg: float = 35.0
    above_deg: float = 7.0

    def view(self, points_m: Floats) -> Floats:
        """(n, 3) points in camera coordinates: right, up and towards the eye, m."""
        turn, above = np.radians([self.turn_deg, self.above_deg])
        right = np.array([np.cos(turn), 0.0, -np.sin(turn)])
        eye = np.array([np.sin(turn) * np.cos(above), np.sin(above), np.cos(turn) * np.cos(above)])
        return points_m @ np.stack([right, np.cross(eye, right), eye], axis=1)


KEY_LIGHT = np.array([-0.55, 0.62, 0.56])
RIM_LIGHT = np.array([0.85, 0.25, -0.3])


def lit(faces: Floats, wood: Floats) -> Floats:
    """Shaded colours (k, 3) of triangles (k, 3, 3) in camera coordinates with base colours (k, 3) or (3,)."""
    normal = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])
    normal /= np.maximum(np.linalg.norm(normal, axis=1, keepdims=True), 1e-300)
    key = np.maximum(normal @ KEY_LIGHT, 0.0)[:, None]
    rim = np.maximum(normal @ RIM_LIGHT, 0.0)[:, None] ** 2
    sky = (0.5 + 0.5 * normal[:, 1])[:, None]
    shade = 0.16 + 0.14 * sky + 0.95 * key
    return np.clip(wood * shade + rim * np.array([0.18, 0.34, 0.46]), 0.0, 1.0)


def add_faces(plot: Axes, faces: Floats, colour: Floats, *, edge: float, width: float) -> None:
    """Draw triangles (k, 3, 3) in camera coordinates back to front; edges are ``edge`` times as bright."""
    towards = np.cross(faces[:, 1] - faces[:, 0], faces[:, 2] - faces[:, 0])[:, 2] > 0
    faces, colour = faces[towards], colour[towards]
    order = np.argsort(faces[:, :, 2].mean(axis=1))
    edges = np.clip(colour * edge, 0.0, 1.0)[order]
    polygons = list(faces[order][:, :, :2])
    plot.add_collection(
        PolyCollection(polygons, facecolors=colour[order], edgecolors=edges, linewidths=width)
    )


def empty_page() -> Figure:
    """Create a figure with the background colour of the page."""
    figure = Figure(figsize=SIZE_INCHES, dpi=DOTS_PER_INCH, facecolor=PAGE_COLOUR)
    FigureCanvasAgg(figure)
    return figure


def bare_axes(figure: Figure, box: tuple[float, float, float, float]) -> Axes:
    """Add axes without frame and ticks."""
    plot: Axes = figure.add_axes(box)
    plot.set_aspect("equal")
    plot.set_axis_off()
    return plot


def frame_points(plot: Axes, flat_m: Floats, margin: float = 0.03) -> None:
    """Set the limits of the axes to show all points (n, 2)."""
    low, high = flat_m.min(axis=0), flat_m.max(axis=0)
    room = margin * float((high - low).max())
    plot.set_xlim(low[0] - room, high[0] + room)
    plot.set_ylim(low[1] - room, high[1] + room)


def write_title(figure: Figure, title: str, facts: str) -> None:
    """Write a title and a line of facts at the top left."""
    figure.text(0.04, 0.955, title, color=INK_COLOUR, fontsize=17, va="center")
    figure.text(0.04, 0.922, facts, color=SOFT_INK, fontsize=11, va="center")


def png(figure: Figure) -> bytes:
    """Encode a figure as PNG with a palette."""
    stream = io.BytesIO()
    figure.savefig(stream, format="raw")
    width, height = figure.canvas.get_width_height()
    pixels = Image.frombytes("RGBA", (width, height), stream.getvalue())
    small, out = pixels.convert("RGB").quantize(PALETTE_COLOURS, dither=Image.Dither.NONE), io.BytesIO()
    small.save(out, format="PNG", optimize=True)
    return out.getvalue()

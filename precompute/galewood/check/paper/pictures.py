"""Draws the pictures of docs/paper.md."""

from __future__ import annotations

import io
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from galewood.check.evaluation import Source
from galewood.check.paper.gestures import TARGET_DIRECTION_DEG, Fig3, Fig5
from galewood.check.paper.plan import Plan
from galewood.pipeline.sampling import DIRECTIONS_DEG, sample_winds
from galewood.solid.skinning import joint_rows
from galewood.table import Table
from galewood.util import Floats

PAPER_ELEMENTS = (35, 135, 235, 335, 435)
PAPER_FPS = (1133, 1098, 836, 602, 487)
WOOD_COLOUR, INK_COLOUR, MODAL_COLOUR, PAPER_COLOUR = "#4a3526", "#333333", "#1b7f5c", "#c2571a"
LEAVES = {"poplar": "#c9a227", "maple": "#b5432a", "apricot": "#d08a3c"}
LIGHT_COLOURS = 96
DRAWN_SWAY = 0.1
"""Sway over the height that the pictures aim at: smaller motions are magnified, by a stated factor."""


def save_small(figure: Any, path: Path, dpi: int = 100) -> None:
    """Save a figure as SVG, or as PNG with a small palette to reduce its size."""
    from PIL import Image

    path.parent.mkdir(parents=True, exist_ok=True)
    if path.suffix == ".svg":
        figure.savefig(path, metadata={"Date": None})
        text = path.read_text().splitlines()
        path.write_text("\n".join(line.rstrip() for line in text) + "\n")
        return
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=dpi, facecolor="white")
    image = Image.open(buffer).convert("RGB")
    image.quantize(LIGHT_COLOURS, dither=Image.Dither.NONE).save(path, optimize=True)


def new_figure(width: float, height: float) -> Any:
    """Create an empty figure of this size in inches, without a display."""
    from matplotlib import rcParams
    from matplotlib.figure import Figure

    rcParams["svg.hashsalt"] = "galewood"
    return Figure(figsize=(width, height), layout="constrained")


def draw_winds(table: Table, plan: Plan, path: Path) -> None:
    """Fig. 2: the six cosine winds of the table."""
    speed_m_s, dt_s = float(table.metadata["design_speed_m_s"]), float(table.metadata["dt_s"])
    winds = sample_winds(speed_m_s, dt_s, table.streamlined_exponent, plan.record_frames)
    chosen = [wind for wind in winds if wind.name.startswith("cosine") and wind.direction_deg == 60.0]
    figure = new_figure(7.0, 2.6)
    panels = figure.subplots(2, 3, sharex=True, sharey=True).ravel()
    for k, (panel, wind) in enumerate(zip(panels, chosen, strict=True)):
        panel.plot(np.linalg.norm(wind.pressure_pa, axis=1), color=MODAL_COLOUR, linewidth=1.3)
        panel.set_title(f"wind {k + 1}", fontsize=8, loc="left")
        panel.tick_params(labelsize=7)
        panel.spines[["top", "right"]].set_visible(False)
    figure.supxlabel("frame", fontsize=8)
    figure.supylabel("pressure, Pa", fontsize=8)
    save_small(figure, path)


def draw_gestures(fig: Fig3, table: Table, source: Source, path: Path) -> None:
    """Fig. 3b: frames 20, 40 and 60 by the reference solution and, over it in grey, by both methods."""
    rows: list[tuple[str, Callable[[int], Floats], str | None]] = [
        ("finite elements", lambda f: reference_motion(source, fig.reference_m[f]), None),
        ("modal", lambda f: table_motion(table, fig.pose["modal"][f]), "modal"),
        ("paper's search", lambda f: table_motion(table, fig.pose["paper-literal"][f]), "paper-literal"),
    ]
    times = magnified(list(fig.reference_m.values()), table)
    figure = new_figure(6.0, 7.6)
    panels = figure.subplots(len(rows), len(fig.reference_m), squeeze=False)
    for line, (name, moved, method) in zip(panels, rows, strict=True):
        for panel, frame in zip(line, fig.reference_m, strict=True):
            ghost = times * reference_motion(source, fig.reference_m[frame]) if method else None
            draw_tree(panel, table, source, times * moved(frame), TARGET_DIRECTION_DEG, ghost)
            title = f"frame {frame}"
            if method:
                title += f"   HD {fig.figures['hausdorff'][method][str(frame)]:.4f}"
            panel.set_title(title, fontsize=8)
        line[0].set_ylabel(name, fontsize=9)
    figure.supxlabel(f"motion drawn {times:g} times as large", fontsize=7)
    save_small(figure, path, dpi=90)


def draw_directions(fig: Fig5, table: Table, source: Source, path: Path) -> None:
    """Fig. 5: one wind from six directions at frame 20, by the reference solution and the modal model."""
    times = magnified(fig.reference_m, table)
    figure = new_figure(7.6, 3.5)
    panels = figure.subplots(2, len(DIRECTIONS_DEG))
    for k, direction in enumerate(DIRECTIONS_DEG):
        reference, shown = reference_motion(source, fig.reference_m[k]), table_motion(table, fig.pose[k])
        # Viewed along 90°, so that winds of 0° and 180° bend the tree to the right and to the left.
        draw_tree(panels[0, k], table, source, times * reference, 0.0, None, direction)
        draw_tree(panels[1, k], table, source, times * shown, 0.0, times * reference, direction)
        panels[0, k].set_title(f"{direction:.0f}°", fontsize=8)
    panels[0, 0].set_ylabel("finite elements", fontsize=8)
    panels[1, 0].set_ylabel("modal", fontsize=8)
    figure.supxlabel(f"motion drawn {times:g} times as large", fontsize=7)
    save_small(figure, path, dpi=100)


def magnified(references_m: Sequence[Floats], table: Table) -> float:
    """Integer factor by which motions are magnified to be visible."""
    largest = max(float(np.linalg.norm(reference, axis=1).max()) for reference in references_m)
    return float(max(1, round(DRAWN_SWAY * float(table.metadata["height_m"]) / max(largest, 1e-9))))


def reference_motion(source: Source, reference_m: Floats) -> Floats:
    """(v, 3) displacement of the render vertices, m, from the reference solution on the wood (n, 3)."""
    return np.asarray(source.binding @ reference_m)


def table_motion(table: Table, q: Floats) -> Floats:
    """(v, 3) displacement of the render vertices, m, of the places that hold them, from q (r,)."""
    joints = joint_rows(table, table.node_basis) @ q
    return joints[table.vertex_joint.astype(np.int64)]


def draw_tree(
    panel: Any,
    table: Table,
    source: Source,
    moved_m: Floats,
    heading_deg: float,
    ghost_m: Floats | None,
    arrow_deg: float | None = None,
) -> None:
    """Draw a tree from the side, the wind to the right; ``ghost_m`` is the reference, in grey behind it."""
    positions = np.concatenate([p.positions_m for p in source.tree.primitives])
    heading, height = np.radians(heading_deg), float(table.metadata["height_m"])
    across = np.array([np.cos(heading), 0.0, np.sin(heading)])

    view = np.stack([across, [0.0, 1.0, 0.0], np.cross(across, [0.0, 1.0, 0.0])], axis=1)
    if ghost_m is not None:
        _patches(panel, source, (positions + ghost_m) @ view, "#a8a8a8", "#cfcfcf")
    colour = LEAVES.get(str(table.metadata.get("species")), "#a8842c")
    _patches(panel, source, (positions + moved_m) @ view, WOOD_COLOUR, colour)
    visible = 1.0 if arrow_deg is None else np.cos(np.radians(arrow_deg))
    if abs(visible) > 0.1:
        low = -0.07 * height
        panel.annotate(
            "", (0.22 * height * visible, low), (-0.22 * height * visible, low),
            arrowprops={"arrowstyle": "-|>", "color": "#e0a800", "linewidth": 1.4},
        )  # fmt: skip
    panel.set_xlim(-0.45 * height, 0.45 * height)
    panel.set_ylim(-0.12 * height, 1.05 * height)
    panel.set_aspect("equal")
    panel.set_xticks([])
    panel.set_yticks([])
    panel.spines[:].set_visible(False)


def _patches(panel: Any, source: Source, points: Floats, wood: str, leaves: str) -> None:
    """Draw all faces of points (v, 3), given as (right, up, towards the eye), back to front."""
    from matplotlib.collections import PolyCollection
    from matplotlib.colors import to_rgb

    corners: list[Floats] = []
    colours: list[Floats] = []
    first = 0
    for k, primitive in enumerate(source.tree.primitives):
        faces = np.asarray(primitive.faces)
        corners.append(points[first : first + len(primitive.positions_m)][faces])
        first += len(primitive.positions_m)
        leafy = primitive.kind == "leaves"
        shade = np.random.default_rng(k).uniform(0.72, 1.12 if leafy else 1.0, (len(faces) + 1) // 2)
        each = np.repeat(shade, 2)[: len(faces), None]  # a leaf card is two faces
        colours.append(np.clip(np.array(to_rgb(leaves if leafy else wood)) * each, 0, 1))
    triangles, colour = np.concatenate(corners), np.concatenate(colours)
    depth = triangles[:, :, 2].mean(axis=1)
    near = 0.82 + 0.18 * (depth - depth.min()) / max(float(np.ptp(depth)), 1e-9)
    order = np.argsort(depth)
    colour = np.clip(colour * near[:, None], 0, 1)
    panel.add_collection(
        PolyCollection(list(triangles[order][:, :, :2]), facecolors=colour[order], linewidths=0)
    )


def draw_elements(found: dict[str, dict[str, Any]], elements: Sequence[int], path: Path) -> None:
    """Table 1 as curves: steps a second of one tree over the number of sampled elements."""
    figure = new_figure(6.4, 3.0)
    panel = figure.subplots()
    panel.semilogy(
        PAPER_ELEMENTS, PAPER_FPS, "o-", color=INK_COLOUR, linewidth=1.2, label="paper (its machine)"
    )
    curves = (
        ("exhaustive_us", "every state compared, as printed", ":"),
        ("paper_us", "exact short lists", "-"),
        ("modal_us", "modal", "--"),
    )
    for key, label, dashes in curves:
        for k, rows in enumerate(found.values()):
            rates = [1e6 / rows[str(count)][key] for count in elements]
            colour = MODAL_COLOUR if key == "modal_us" else PAPER_COLOUR
            panel.semilogy(elements, rates, dashes, color=colour, linewidth=1.1, label=None if k else label)
    panel.set_xlabel("sampled elements", fontsize=8)
    panel.set_ylabel("steps of one tree a second", fontsize=8)
    panel.tick_params(labelsize=7)
    panel.spines[["top", "right"]].set_visible(False)
    panel.legend(fontsize=7, frameon=False)
    save_small(figure, path)

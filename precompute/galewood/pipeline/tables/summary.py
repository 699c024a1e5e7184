"""What the reports of an import and of a build say at a glance: figures of a tree, and lines to read."""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.constants import BREAST_HEIGHT_M
from galewood.solid.model import TreeModel
from galewood.solid.skeleton import Skeleton
from galewood.solid.tets import TetMesh, tet_volumes
from galewood.tree import TreeMesh

MOST_PARTS = 30


def import_lines(report: dict[str, Any]) -> list[str]:
    """What was found in a mesh file and what was assumed; warnings are not included."""
    species, unit, axis = report["species"], report["unit"], report["up_axis"]
    up = str(axis["value"]).upper()
    lines = [
        f"{report['file']['name']}: {report['file']['format']}, {report['height_m']:.3g} m high",
        f"up axis {'' if up.startswith('-') else '+'}{up}{_assumed(axis)}",
        f"unit {unit['value']}{_assumed(unit)}",
        f"wood species {species['value'] or 'default'} ({species['reason']})",
    ]
    lines += [
        f"repaired: {name.replace('_', ' ')} {value}" for name, value in report["repairs"].items() if value
    ]
    trees = report.get("trees", [])
    if len(trees) > 1:
        heights = ", ".join(f"{tree['number']}: {tree['height_m']:.3g} m" for tree in trees[:MOST_PARTS])
        lines.append(f"{len(trees)} trees in the file ({heights})")
    return lines + part_lines(report.get("pieces") or report["parts"])


def part_lines(parts: list[dict[str, Any]]) -> list[str]:
    """One line per part or group of pieces: kind, faces, id, name, and the reason of the kind."""
    lines = [
        f"{part.get('what') or part['kind']:<7}{part['faces']:>9,} faces  {_id(part)}"
        f"{' / '.join(dict.fromkeys(part['names'])) or 'unnamed'} ({part['reason']})"
        for part in parts[:MOST_PARTS]
    ]
    more = len(parts) - MOST_PARTS
    return [*lines, f"and {more} more parts"] if more > 0 else lines


def _id(part: dict[str, Any]) -> str:
    return f"{part['id']}  " if "id" in part else ""


def _assumed(choice: dict[str, Any]) -> str:
    return f" ({'assumed: ' if choice['assumed'] else ''}{choice['reason']})"


def figures_of(tree: TreeMesh, made: TreeModel) -> dict[str, Any]:
    """Size, masses and frequencies of a tree; None: it has none.

    The diameter is that of the skeleton's trunk 1.3 m above the lowest point of the wood.
    """
    mesh, crown, of_model = made.tets, made.lumped.report, made.fem.report
    bare = of_model.get("bare", {})
    twigs = crown.get("twig_mass_kg", 0.0) + crown.get("added_twig_mass_kg", 0.0)
    return {
        "height_m": tree.height_m,
        "dbh_cm": _diameter_cm(mesh, made.skeleton),
        "wood_volume_m3": float((tet_volumes(mesh.vertices_m, mesh.tets) * mesh.radius_ratio**2).sum()),
        "wood_mass_kg": of_model["wood_mass_kg"],
        "twig_mass_kg": twigs,
        "leaf_mass_kg": crown["leaf_mass_kg"],
        "rest_pose": of_model["rest_pose"]["kind"],
        "first_frequency_hz": of_model["frequencies_hz"][0],
        **_sway("", of_model["sway"]),
        "bare_first_frequency_hz": bare["frequencies_hz"][0] if bare else None,
        **_sway("bare_", bare.get("sway", {})),
    }


def tree_lines(figures: dict[str, Any]) -> list[str]:
    """The figures of a tree as lines to read."""
    diameter = figures["dbh_cm"]
    size = [f"{figures['height_m']:.1f} m high"]
    size += [] if diameter is None else [f"{diameter:.0f} cm in diameter at 1.3 m"]
    size += [f"{figures['wood_volume_m3']:.3g} m³ of wood"]
    names = {"wood": "wood", "twig": "unmeshed twigs", "leaf": "leaves"}
    masses = [f"{name} {figures[f'{key}_mass_kg']:.3g} kg" for key, name in names.items()]
    hertz = [f"first frequency {_hertz(figures, '')}"]
    if figures["bare_first_frequency_hz"] is not None:
        hertz.append(f"without leaves {_hertz(figures, 'bare_')}")
    return [", ".join(part) for part in (size, masses, hertz)]


def _sway(prefix: str, sway: dict[str, Any]) -> dict[str, Any]:
    """The main sway mode, counted from 1, and its frequency."""
    mode = sway.get("main_mode")
    return {
        f"{prefix}main_sway_mode": None if mode is None else mode + 1,
        f"{prefix}main_sway_frequency_hz": sway.get("main_frequency_hz"),
    }


def _diameter_cm(mesh: TetMesh, skeleton: Skeleton) -> float | None:
    trunk = skeleton.branch == 0
    height_m = skeleton.points_m[trunk, 1] - mesh.vertices_m[:, 1].min()
    if height_m.max() < BREAST_HEIGHT_M:
        return None
    rising = np.argsort(height_m)
    return 200 * float(np.interp(BREAST_HEIGHT_M, height_m[rising], skeleton.radius_m[trunk][rising]))


def _hertz(figures: dict[str, Any], prefix: str) -> str:
    first, main = (figures[f"{prefix}{name}_frequency_hz"] for name in ("first", "main_sway"))
    mode = figures[f"{prefix}main_sway_mode"]
    more = "" if mode in (None, 1) else f" (main sway: mode {mode}, {main:.3g} Hz)"
    return f"{first:.3g} Hz{more}"

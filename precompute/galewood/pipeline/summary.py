"""The report of a mesh import as lines to read: size, assumptions, parts."""

from __future__ import annotations

from typing import Any

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

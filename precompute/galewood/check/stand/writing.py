"""Writes the report of a stand: as a table (CSV), a page to print with a map (HTML), GeoJSON or JSON."""

from __future__ import annotations

import csv
import io
import json
from collections.abc import Iterable
from dataclasses import asdict, fields
from html import escape
from pathlib import Path

import numpy as np

from galewood.check.stand.report import StandReport, StemRisk
from galewood.measurements import Inventory
from galewood.solid.strain import CAUTION_TEXT
from galewood.util import write_atomically

MAP_WIDTH = 720.0
MOST_ROWS = 2000
"""Rows of the page; the table has all."""
COLOUR_MAP_NAME, COLOUR_STEP_COUNT = "RdYlBu", 7
"""From those that break first to those that break last, in equal numbers; the colour-blind see them too."""
PAGE_STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:75rem;margin:2rem auto;padding:0 1rem;color:#222}"
    "table{border-collapse:collapse;margin:1rem 0;font-size:13px}"
    "td,th{padding:.15rem .6rem;border-bottom:1px solid #ddd;text-align:right}"
    "th.text,td.text{text-align:left}svg{max-width:100%;height:auto;background:#f7f7f5}"
    ".caution{border-left:4px solid #c2571a;padding-left:1rem}"
)
COLUMNS = (
    ("rank", "rank"), ("line", "line"), ("species", "species"), ("shown by", "tree"),
    ("height, m", "height_m"), ("DBH, cm", "dbh_cm"), ("first frequency, Hz", "frequency_hz"),
    ("from the edge, m", "edge_distance_m"), ("share of the load", "load_share"), ("sway, m", "sway_m"),
    ("base moment, kN·m", "base_moment_knm"), ("largest strain", "strain"),
    ("breaks at, m/s", "critical_m_s"), ("10 %", "critical_low_m_s"), ("90 %", "critical_high_m_s"),
)  # fmt: skip
PLACE_DIGITS = 10
"""Of longitudes and latitudes: five are ten metres."""
TEXT_COLUMNS = ("species", "tree")
NO_LONGITUDES_TEXT = "the inventory has no longitudes and latitudes for GeoJSON: write .csv or .html"
ESTIMATED_TEXT = "* not measured: height from the diameter, or diameter from the built-in tree's proportions"


def check_writable(inventory: Inventory, path: Path) -> None:
    """Whether a report of these stems can be written to a file of this name, before it is computed.

    ValueError for another ending than .csv, .html, .geojson and .json, and for GeoJSON without longitudes.
    """
    if path.suffix.lower() not in _WRITERS:
        raise ValueError(f"{path.name}: the report ends in {', '.join(_WRITERS)}")
    if path.suffix.lower() == ".geojson" and None in inventory.lon_lat_deg:
        raise ValueError(NO_LONGITUDES_TEXT)


def write_report(report: StandReport, path: Path) -> None:
    """Write a report as CSV, HTML, GeoJSON or JSON, by the ending of its name. ValueError for another one."""
    if path.suffix.lower() not in _WRITERS:
        raise ValueError(f"{path.name}: the report ends in {', '.join(_WRITERS)}")
    write_atomically(path, _WRITERS[path.suffix.lower()](report).encode())


def table_text(report: StandReport) -> str:
    """All stems, one a row, below the caution and the assumptions as comments; empty: not up to 100 m/s."""
    out = io.StringIO()
    for text in (CAUTION_TEXT, *report.assumptions, f"Gust of {report.options.wind_m_s:g} m/s."):
        out.write(f"# {text}\n")
    names = [field.name for field in fields(StemRisk)]
    table = csv.writer(out, lineterminator="\n")
    table.writerow(names)
    for stem in report.stems:
        table.writerow([_cell(name, value) for name, value in asdict(stem).items()])
    return out.getvalue()


def _cell(name: str, value: object) -> str:
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        digits = PLACE_DIGITS if name in ("lon_deg", "lat_deg") else 5
        return f"{value:.{digits}g}" if np.isfinite(value) else ""
    return "" if value is None else str(value)


def geojson_text(report: StandReport) -> str:
    """Stems as points for a map (RFC 7946), with what the table has; null: not up to 100 m/s.

    ValueError if the inventory has no longitudes and latitudes, which GeoJSON needs.
    """
    features: list[dict[str, object]] = []
    document, colours = report.document(), _colours()
    for stem, properties in zip(report.stems, document.pop("stems"), strict=True):
        place = [properties.pop("lon_deg"), properties.pop("lat_deg")]
        if None in place:
            raise ValueError(NO_LONGITUDES_TEXT)
        properties["marker-color"] = colours[_step_of(stem, len(report.stems))]
        geometry = {"type": "Point", "coordinates": place}
        features.append({"type": "Feature", "geometry": geometry, "properties": properties})
    return json.dumps({"type": "FeatureCollection", "features": features, **document}, indent=1) + "\n"


def json_text(report: StandReport) -> str:
    """The report as JSON."""
    return json.dumps(report.document(), indent=1) + "\n"


def page_text(report: StandReport) -> str:
    """A page that needs no other file: caution, map, legend, stems and assumptions."""
    count = len(report.stems)
    left = (
        f" The first {MOST_ROWS} of {count} stems are listed; a report in CSV has all."
        if count > MOST_ROWS
        else ""
    )
    parts = [
        "<h1>Stems in wind</h1>",
        f'<p class="caution">{escape(CAUTION_TEXT)}</p>',
        f"<p>{count} stems, {report.per_ha:.0f} per hectare, {report.mean_height_m:.1f} m high on average. "
        f"Sway, moment and strain in a gust of {report.options.wind_m_s:g} m/s.{left}</p>",
        _map(report.stems),
        _legend(report.stems),
        _table(report.stems[:MOST_ROWS]),
        "<h2>Assumptions</h2><ul>",
        *[f"<li>{escape(text)}</li>" for text in report.assumptions],
        "</ul>",
    ]
    body = "\n".join(parts)
    return (
        '<!doctype html><html lang="en"><meta charset="utf-8"><title>Stems in wind</title>'
        f"<style>{PAGE_STYLE}</style><body>\n{body}\n</body></html>\n"
    )


def _map(stems: tuple[StemRisk, ...]) -> str:
    """Stems from above, north up, as circles of their crowns' rough size, coloured by rank."""
    east, north = np.array([(stem.east_m, stem.north_m) for stem in stems]).T
    margin = max(stem.height_m for stem in stems) / 4
    width = float(np.ptp(east)) + 2 * margin
    depth = float(np.ptp(north)) + 2 * margin
    scale, colours = MAP_WIDTH / width, _colours()
    circles = [
        f'<circle cx="{scale * (stem.east_m - east.min() + margin):.1f}" '
        f'cy="{scale * (north.max() - stem.north_m + margin):.1f}" '
        f'r="{max(scale * stem.height_m / 12, 2):.1f}" fill="{colours[_step_of(stem, len(stems))]}">'
        f"<title>{escape(_said_of(stem))}</title></circle>"
        for stem in reversed(stems)
    ]
    height = scale * depth
    size = f'viewBox="0 0 {MAP_WIDTH:.0f} {height:.0f}" width="{MAP_WIDTH:.0f}" height="{height:.0f}"'
    label = "Map of the stems, north up, coloured by the gust that breaks them"
    outline = 'stroke="#888" stroke-width="0.5"'
    return f'<svg {size} {outline} role="img" aria-label="{label}">{"".join(circles)}</svg>'


def _colours() -> list[str]:
    from matplotlib import colormaps, colors  # slow to load

    return [colors.to_hex(one) for one in colormaps[COLOUR_MAP_NAME](np.linspace(0, 1, COLOUR_STEP_COUNT))]


def _step_of(stem: StemRisk, count: int) -> int:
    return (stem.rank - 1) * COLOUR_STEP_COUNT // count


def _said_of(stem: StemRisk) -> str:
    species = stem.species or "unknown species"
    return f"line {stem.line}: {species}, {stem.height_m:.1f} m, breaks at {_speed(stem.critical_m_s)} m/s"


def _speed(speed_m_s: float) -> str:
    return f"{speed_m_s:.1f}" if np.isfinite(speed_m_s) else "over 100"


def _legend(stems: tuple[StemRisk, ...]) -> str:
    entries: list[str] = []
    for k, colour in enumerate(_colours()):
        part = [stem for stem in stems if _step_of(stem, len(stems)) == k]
        if part:
            between = f"{_speed(part[0].critical_m_s)} to {_speed(part[-1].critical_m_s)}"
            entries.append(f'<span style="color:{colour}">■</span> {between}')
    return f"<p>Gust that breaks a stem, m/s: {' '.join(entries)}</p>"


def _table(stems: Iterable[StemRisk]) -> str:
    head = "".join(f"<th{_kind(name)}>{escape(title)}</th>" for title, name in COLUMNS)
    rows = ["".join(_table_cell(stem, name) for _, name in COLUMNS) for stem in stems]
    table = f"<table><tr>{head}</tr>{''.join(f'<tr>{row}</tr>' for row in rows)}</table>"
    return f"{table}<p>{ESTIMATED_TEXT}</p>"


def _table_cell(stem: StemRisk, name: str) -> str:
    not_measured = {"height_m": stem.height_estimated, "dbh_cm": stem.dbh_assumed}
    mark = " *" if not_measured.get(name) else ""
    return f"<td{_kind(name)}>{escape(_shown(name, getattr(stem, name)))}{mark}</td>"


def _kind(name: str) -> str:
    return ' class="text"' if name in TEXT_COLUMNS else ""


def _shown(name: str, value: object) -> str:
    if name.startswith("critical") and isinstance(value, float):
        return _speed(value)
    return f"{value:.3g}" if isinstance(value, float) else str(value)


_WRITERS = {".csv": table_text, ".html": page_text, ".geojson": geojson_text, ".json": json_text}

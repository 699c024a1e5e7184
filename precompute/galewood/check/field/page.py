"""The report as one HTML file with its plot inside."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Iterable
from html import escape
from pathlib import Path
from typing import Any

from galewood.solid.strain import CAUTION_TEXT

PAGE_STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;max-width:70rem;margin:2rem auto;padding:0 1rem;color:#222}"
    "table{border-collapse:collapse;margin:1rem 0}td,th{padding:.2rem .7rem;border-bottom:1px solid #ddd;"
    "text-align:right}td:first-child,th:first-child{text-align:left}img{max-width:100%}"
)
COLUMNS = (
    ("tree", "tree"), ("season", "season"), ("wood", "wood"), ("measured, Hz", "frequency_hz"),
    ("model, Hz", "model_frequency_hz"), ("model over measured", "ratio"),
    ("lowest mode, Hz", "model_lowest_hz"), ("main mode", "model_mode"),
    ("its share of the mass", "model_mode_mass_share"),
    ("measured damping", "damping_ratio"), ("model damping", "model_damping_ratio"),
)  # fmt: skip
BENDING_NAMES = {"critical_m_s": "Gust that breaks the stem, m/s"}
STATISTICS = (
    ("", "name"), ("trees", "trees"), ("R²", "r2"), ("R² of logarithms", "r2_log"),
    ("squared correlation", "correlation_squared"), ("median ratio", "median_ratio"),
    ("RMS logarithmic error", "rms_log_error"),
)  # fmt: skip


def html_page(report: dict[str, Any], plots: Iterable[Path]) -> str:
    """A page that needs no other file; those of the ``plots`` that exist are embedded."""
    trees = [tree | _ratio(tree) for tree in report["trees"]]
    parts = ["<h1>Model against measurement</h1>", _notes(report)]
    if trees:
        parts += [
            *[_picture(plot) for plot in plots if plot.exists()],
            *_frequency(report, trees),
            _bending(report),
        ]
    for tree in report["failed"]:
        parts.append(f"<p>{escape(tree['tree'])} failed: {escape(tree['error'])}</p>")
    for row in report["without_file"]:
        parts.append(f"<p>{escape(row['tree'])} (line {row['line']}): {escape(row['why'])}</p>")
    for tree in trees:
        parts += [f"<p>{escape(tree['tree'])}: {escape(text)}</p>" for text in tree["warnings"]]
    body = "\n".join(parts)
    return (
        f'<!doctype html><html lang="en"><meta charset="utf-8"><title>Field report</title>'
        f"<style>{PAGE_STYLE}</style><body>\n{body}\n</body></html>\n"
    )


def _frequency(report: dict[str, Any], trees: list[dict[str, Any]]) -> list[str]:
    """Statistics of frequency and damping, and the trees' values."""
    if not report["frequency"]:
        return []
    definitions: dict[str, str] = report["definitions"]
    return [
        "<h2>Frequency</h2>",
        _table(STATISTICS, report["frequency"].values()),
        *[f"<p><b>{escape(name)}</b>: {escape(text)}.</p>" for name, text in definitions.items()],
        _damping(report["damping"]),
        "<h2>Trees</h2>",
        _table(COLUMNS, [tree for tree in trees if tree["frequency_hz"] is not None]),
    ]


def _picture(plot: Path) -> str:
    picture = b64encode(plot.read_bytes()).decode()
    return f'<img alt="Model against measured values" src="data:image/png;base64,{picture}">'


def _ratio(tree: dict[str, Any]) -> dict[str, float]:
    measured = tree["frequency_hz"]
    return {} if measured is None else {"ratio": tree["model_frequency_hz"] / measured}


def _bending(report: dict[str, Any]) -> str:
    """Statistics of every measured strain and of the critical wind, and the values of the trees."""
    statistics: dict[str, list[dict[str, Any]]] = report["bending"]
    parts = [
        f"<h2>{escape(BENDING_NAMES.get(name, name))}</h2>" + _table(STATISTICS, rows)
        for name, rows in statistics.items()
    ]
    bent = [
        {"tree": tree["tree"], "season": tree["season"], "name": name, "measured": value,
         "model": tree["model_bending"].get(name)}
        for tree in report["trees"] for name, value in tree.get("bending", {}).items()
    ]  # fmt: skip
    columns = tuple((name, name) for name in ("tree", "season", "name", "measured", "model"))
    return "".join(parts) + (_table(columns, bent) + f"<p>{escape(CAUTION_TEXT)}</p>" if bent else "")


def _notes(report: dict[str, Any]) -> str:
    sentences = [
        f"{len(report['trees'])} measurements of {escape(report['table'])} computed, "
        f"{len(report['failed'])} failed, {len(report['without_file'])} without a file."
    ]
    if report["interrupted"]:
        sentences.append(f"The run was interrupted: {report['unfinished']} are not computed.")
    if report["not_measured"]:
        sentences.append(f"Not in the table: {escape(', '.join(report['not_measured']))}.")
    return f"<p>{' '.join(sentences)}</p>"


def _damping(found: dict[str, Any]) -> str:
    if not found["trees"]:
        return ""
    figures = {**found, "name": "model, released"}
    return "<h2>Damping ratio</h2>" + _table(STATISTICS, [figures])


def _table(columns: tuple[tuple[str, str], ...], rows: Iterable[dict[str, Any]]) -> str:
    head = "".join(f"<th>{escape(title)}</th>" for title, _ in columns)
    lines = [
        "<tr>" + "".join(f"<td>{_cell(row.get(key))}</td>" for _, key in columns) + "</tr>" for row in rows
    ]
    return f"<table><tr>{head}</tr>{''.join(lines)}</table>"


def _cell(value: Any) -> str:
    if value is None:
        return ""
    return f"{value:.3g}" if isinstance(value, float) else escape(str(value))

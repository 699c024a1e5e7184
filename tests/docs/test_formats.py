"""The format documents state the versions and constants of the code."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from galewood.modal import MAX_STEPS_PER_ADVANCE, drag_inputs, force_terms, gusts, shape_terms, step, terms
from galewood.player import paper_search
from galewood.table import compliance, records
from galewood.table import format as table_format
from galewood.table.container import MAX_HEADER_BYTES
from galewood.wind import crown, document, fronts, pressure, recording, transition
from galewood.wind.models import eddy_gusts, frame, navier_stokes, perlin, spectral
from galewood_server.stream import WIRE_VERSION, wire, wire_forest, wire_pull
from galewood_server.stream.envelope import MAX_HEADER_BYTES as WIRE_HEADER_BYTES
from galewood_server.stream.forest import STREAM_ERROR_M

FORMATS = Path(__file__).parents[2] / "docs" / "formats"
DIGITS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
C = 7
"""A number of coupled coordinates to count terms with."""


def page(name: str) -> str:
    """The text of a page, with single blanks."""
    return re.sub(r"\s+", " ", (FORMATS / f"{name}.md").read_text(encoding="utf-8"))


def power(value: float) -> str:
    """A power of ten as it is written: 10⁻⁷."""
    exponent = f"{value:.0e}".partition("e")[2]
    assert float(f"1e{exponent}") == value
    return "10" + str(int(exponent)).translate(DIGITS)


def number(value: float) -> str:
    return f"{value:g}".replace("-", "−")


def test_versions() -> None:
    table = table_format.VERSION
    said = {
        "table": [
            f"# The table file, version {table} ", f"| `version` | {table} | readers reject any other ",
            f"| `version` | {records.RECORDS_VERSION} | | | `table_sha256`",
        ],
        "wind": [
            f"# The wind document, version {document.VERSION} ", f"| `version` | {document.VERSION} | all |",
        ],
        "wire": [f"# The wire protocol, version {WIRE_VERSION} ", f"| 2 | version, `{WIRE_VERSION:02d}` |"],
        "index": [
            f"| [Table file](table.md) | {table} |",
            f"| [Compliance file](compliance.md) | {compliance.COMPLIANCE_VERSION} |",
            f"| [Wire protocol](wire.md) | {WIRE_VERSION} |",
            f"| [Wind document](wind.md) | {document.VERSION} |",
        ],
    }  # fmt: skip
    for name, texts in said.items():
        for text in texts:
            assert text in page(name) + " ", f"{name}.md does not say: {text}"


def page_lines(name: str) -> str:
    return (FORMATS / f"{name}.md").read_text(encoding="utf-8")


TABLE = [
    f"(a, b) · min(1, {terms.REACH} l / √(a² + b²))",
    f"min(max(a, −{terms.REACH} l), {terms.REACH} l)",
    f"exceeds {power(step.REST)} l_0 in magnitude, neither of `sway` v' exceeds {power(step.REST)} l_1",
    f"< {power(step.REST)} l_0, then e' = v' = 0",
    f"min(⌊phase⌋, {MAX_STEPS_PER_ADVANCE}) times",
    f"At most {MAX_STEPS_PER_ADVANCE} steps are taken",
    f"d in 2..{table_format.MAX_DYNAMIC}:",
    f"m in 0..{table_format.MAX_DRAG_POINTS} |",
    f"G in 0..{table_format.MAX_GUST_PLACES} |",
    f"L in 0..{table_format.MAX_GUST_OSCILLATORS} |",
    f"more than {table_format.MAX_DRAG_POINTS} drag points",
    f"exceeds {MAX_HEADER_BYTES // 1024**2} MiB",
    f"min(d, max({drag_inputs(8)}, ⌊d/2⌋))",
    f"all below {power(gusts.STILL_M)} (m, m/s)",
    f"p(U) = {pressure.HALF_AIR_DENSITY_KG_M3:g} U² Pa up to {pressure.STREAMLINING_SPEED_M_S:g} m/s",
    f"(U/5)^{pressure.STREAMLINED_EXPONENT}",
    f"| `modal.force` | F32 | {force_terms(0)} + {force_terms(1) - force_terms(0)}c, d |",
    f"| `modal.pose` | F32 | d + {2 + shape_terms(0)} + {shape_terms(1) - shape_terms(0)}c, f − d |",
    f"1/{2**paper_search._REDUCTIONS} of the argument",  # pyright: ignore[reportPrivateUsage]
]
WIND = [
    f"over {transition.TRANSITION_S} s",
    f"clamp((t − t₀) / {transition.TRANSITION_S} s, 0, 1)",
    f"L is {document.Wind().length_scale_m:g} m wherever it is needed",
    f"{document.Wind().length_scale_m:g} m for `length_scale_m`",
    f"{document.Wind().heading_swing_deg:g}° for `heading_swing_deg`",
    f"| `waves` | 1 … {document.MOST_WAVES} waves |",
    f"`pairs` holds {recording.FEWEST_SAMPLES} … {recording.MOST_SAMPLES} pairs",
    f"a list of up to {('four' if fronts.MOST_FRONTS == 4 else fronts.MOST_FRONTS)} [gust fronts]",
    f"max({fronts.LEAST_TRAVEL_M_S:g}, {fronts.TRAVEL_SHARE:g} U₁)",
    f"({fronts.LEAST_GUST_M_S:g} + {fronts.GUST_SHARE:g} U₁) · min((t − t₁) / {fronts.RISE_S:g} s, 1) "
    f"· (1 − s / {fronts.RANGE_M:g} m)",
    f"/ {fronts.DEPTH_M:g} m",
    f"/ ({fronts.WIDTH_M:g} m + {fronts.SPREAD:g} s)",
    f"each after {fronts.LIFE_S:g} s",
    f"σ = {frame.TURBULENCE_PER_GUSTINESS:g} g U̅",
    f"for U ≤ {pressure.STREAMLINING_SPEED_M_S:g} m/s, ρ = {pressure.AIR_DENSITY_KG_M3:g} kg/m³",
    f"(U/5)^{pressure.STREAMLINED_EXPONENT:g} above",
    f"with c(x) = x up to 1 and 1 + ¼ ln(1 + {1 / pressure.COMPRESSION:g} (x − 1)) above",
    f"clamp({crown.INTENSITY:g} f g A(ξ, η), ±{crown.MOST:g})",
    f"ℓ = {crown.CELL_M:g} m",
    f"− D {number(crown.LEAN_ALONG).replace('−', '− ')} y) / ℓ",
    f"+ {crown.LEAN_ACROSS:g} y) / ℓ + {crown.SLANT:g} ξ",
    f"periodic fields of {crown.CELLS} × {crown.CELLS} points",
    f"k = 0 … {crown.WAVES - 1}",
    f"texture of {spectral.COLUMNS} × {spectral.ROWS} cells, {spectral.CELLS_ALONG} per L along and "
    f"{spectral.CELLS_ACROSS} per L across",
    f"(1 + {spectral.VON_KARMAN:g} n²)^(−β/2)",
    f"w = {spectral.DECAY:g}/(2π) √(n² + {spectral.SLOWEST_COHERENCE:g}²)",
    f"sampled at (ξ, η + {spectral.SLANT:g} ξ)",
    f"V = {round(perlin.NOISE_VARIANCE * 480729249)}/480729249",
    f"q = (η + {perlin.SLANT:g} ξ)/2, z = {perlin.CHANGE:g} S",
    f"N = {navier_stokes.GRID}, {eddy_gusts.CELLS_PER_SCALE} per L",
    f"(1 + {navier_stokes.FRICTION:g} + {navier_stokes.LARGE_SCALE_FRICTION:g}/k²)",
    f"p += {navier_stokes.KICK:g} N² / (8",
    f"where {navier_stokes.BAND[0]} ≤ |k| < {navier_stokes.BAND[1]};",
    f"where |k| ≥ {navier_stokes.SLOWEST_START}, otherwise 0",
    f"run e = ⌊n/{eddy_gusts.EPOCH}⌋",
    f"f = (M − {eddy_gusts.EPOCH} e)/{eddy_gusts.OVERLAP}",
]
WIRE = [
    f"version {WIRE_VERSION}",
    f"u32, at most {WIRE_HEADER_BYTES:,}",
    f"√Σ (h_k b_k)² ≤ {1e3 * STREAM_ERROR_M:g} mm",
    f"1 / ({MAX_STEPS_PER_ADVANCE} · {wire.TICK_HZ} · `dt_s`)",
    f"map of up to {wire_forest.MAX_ABOUT} names",
    f"at most {wire_pull.MOST_PULLS}, whenever they have changed",
]


@pytest.mark.parametrize(
    ("name", "text"),
    [(name, text) for name, texts in {"table": TABLE, "wind": WIND, "wire": WIRE}.items() for text in texts],
)
def test_constants(name: str, text: str) -> None:
    assert text in page(name), f"{name}.md does not say: {text}"


def test_the_number_of_terms_is_that_of_the_table() -> None:
    rows = page_lines("table").partition("| number | terms |")[2].partition("\n\n")[0]
    counts = re.findall(r"^\| ([^|]+) \|", rows, re.MULTILINE)
    sizes = [sum(int(part[:-1] or 1) * C if part.endswith("c") else int(part) for part in count.split(" + "))
             for count in counts if count[0].isdigit()]  # fmt: skip
    assert sum(sizes) == force_terms(C)
    assert sum(sizes[:2]) == shape_terms(C)


def test_fields_of_the_wind_have_their_ranges_and_defaults() -> None:
    text = page_lines("wind")
    for name, field in document.FIELDS.items():
        row = next(line for line in text.splitlines() if line.startswith(f"| `{name}` |"))
        high = "2³²−1" if name == "seed" else number(field.high)
        assert f"| {number(field.low)} … {high}" in row, row
        if field.default is not None:
            assert f"default {'5/3' if name == 'beta' else number(field.default)} " in row, row
    for k, wave in enumerate(document.FOREST_WAVES):
        row = re.search(rf"^\| {k} \| (.+) \| (.+) \| (.+) \|$", text, re.MULTILINE)
        assert row is not None
        assert [float(cell.replace("−", "-")) for cell in row.groups()] == [
            wave.frequency_hz, wave.share, wave.across,
        ]  # fmt: skip


def test_kinds_of_messages_have_their_numbers() -> None:
    rows = re.findall(r"^\| (\d+) \| ([A-Z_]+) \|", page_lines("wire"), re.MULTILINE)
    assert len(rows) == 19
    known = {**vars(wire_pull), **vars(wire_forest), **vars(wire)}
    assert {name: int(kind) for kind, name in rows} == {name: known[name] for _, name in rows}


def test_every_error_code_is_listed() -> None:
    server = Path(__file__).parents[2] / "server" / "galewood_server"
    files = [server / "api" / "socket.py", *(server / "stream").glob("*.py")]
    codes = {
        code
        for file in files
        for code in re.findall(r"(?:Session|Wire)Error\([^)]*?\"([a-z]+(?:-[a-z]+)+)\"", file.read_text())
    }
    assert len(codes) > 10
    assert {code for code in codes if f"`{code}`" not in page("wire")} == set()

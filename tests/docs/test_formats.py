"""The format documents state the versions and constants of the code."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from galewood import constants as spec
from galewood.motion.modal import drag_inputs, force_terms, shape_terms
from galewood.motion.wind.document import FIELDS
from galewood_server.stream.forest import STREAM_ERROR_M

SPEC = Path(__file__).parents[2] / "spec"
DIGITS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
C = 7
"""A number of coupled coordinates to count terms with."""


def page(name: str) -> str:
    """The text of a page, with single blanks."""
    return re.sub(r"\s+", " ", page_lines(name))


def power(value: float) -> str:
    """A power of ten as it is written: 10⁻⁷."""
    exponent = f"{value:.0e}".partition("e")[2]
    assert float(f"1e{exponent}") == value
    return "10" + str(int(exponent)).translate(DIGITS)


def number(value: float) -> str:
    return f"{value:g}".replace("-", "−")


def test_versions() -> None:
    table = spec.TABLE_VERSION
    said = {
        "table": [
            f"# The table file, version {table} ", f"| `version` | {table} | readers reject any other ",
            f"| `version` | {spec.RECORDS_VERSION} | | | `table_sha256`",
        ],
        "wind": [
            f"# The wind document, version {spec.WIND_VERSION} ",
            f"| `version` | {spec.WIND_VERSION} | all |",
        ],
        "wire": [
            f"# The wire protocol, version {spec.WIRE_VERSION} ",
            f"| 2 | version, `{spec.WIRE_VERSION:02d}` |",
        ],
        "README": [
            f"| [Table file](formats/table.md) | {table} |",
            f"| [Compliance file](formats/compliance.md) | {spec.COMPLIANCE_VERSION} |",
            f"| [Wire protocol](formats/wire.md) | {spec.WIRE_VERSION} |",
            f"| [Wind document](formats/wind.md) | {spec.WIND_VERSION} |",
        ],
    }  # fmt: skip
    for name, texts in said.items():
        for text in texts:
            assert text in page(name) + " ", f"{name}.md does not say: {text}"


def page_lines(name: str) -> str:
    return (SPEC / f"{name}.md" if name == "README" else SPEC / "formats" / f"{name}.md").read_text(
        encoding="utf-8"
    )


TABLE = [
    f"(a, b) · min(1, {spec.MODAL_REACH} l / √(a² + b²))",
    f"min(max(a, −{spec.MODAL_REACH} l), {spec.MODAL_REACH} l)",
    f"exceeds {power(spec.MODAL_REST)} l_0 in magnitude, "
    f"neither of `sway` v' exceeds {power(spec.MODAL_REST)} l_1",
    f"< {power(spec.MODAL_REST)} l_0, then e' = v' = 0",
    f"min(⌊phase⌋, {spec.MAX_STEPS_PER_ADVANCE}) times",
    f"At most {spec.MAX_STEPS_PER_ADVANCE} steps are taken",
    f"d in 2..{spec.MAX_OSCILLATORS}:",
    f"m in 0..{spec.MAX_DRAG_POINTS} |",
    f"G in 0..{spec.MAX_PLACES} |",
    f"more than {spec.MAX_DRAG_POINTS} drag points",
    f"exceeds {spec.MAX_TABLE_HEADER_BYTES // 1024**2} MiB",
    f"min(d, max({drag_inputs(8)}, ⌊d/2⌋))",
    f"p(U) = {spec.HALF_AIR_DENSITY_KG_M3:g} U² Pa up to {spec.STREAMLINING_SPEED_M_S:g} m/s",
    f"{spec.STREAMLINING_PRESSURE_PA:g} (U/{spec.STREAMLINING_SPEED_M_S:g})^n",
    "| `streamlined_exponent` | {:g} … {:g} |".format(*spec.TABLE_RANGES["streamlined_exponent"]),
    f"| `modal.force` | F32 | {force_terms(0)} + {force_terms(1) - force_terms(0)}c, d |",
    f"| `modal.pose` | F32 | d + {2 + shape_terms(0)} + {shape_terms(1) - shape_terms(0)}c, r − d |",
    f"1/{2**spec.EXPONENTIAL_SQUARINGS} of the argument",
]
WIND = [
    f"over {spec.TRANSITION_S} s",
    f"clamp((t − t₀) / {spec.TRANSITION_S} s, 0, 1)",
    f"L is {spec.UNUSED_LENGTH_SCALE_M:g} m wherever it is needed",
    f"{spec.UNUSED_LENGTH_SCALE_M:g} m for `length_scale_m`",
    f"{spec.WIND_FIELDS['heading_swing_deg']['default']:g}° for `heading_swing_deg`",
    f"| `waves` | 1 … {spec.MOST_WAVES} waves |",
    f"`pairs` holds {spec.FEWEST_RECORDING_SAMPLES} … {spec.MOST_RECORDING_SAMPLES} pairs",
    f"a list of up to {('four' if spec.MOST_FRONTS == 4 else spec.MOST_FRONTS)} [gust fronts]",
    f"max({spec.FRONT_LEAST_TRAVEL_M_S:g}, {spec.FRONT_TRAVEL_SHARE:g} U₁)",
    f"({spec.FRONT_LEAST_GUST_M_S:g} + {spec.FRONT_GUST_SHARE:g} U₁) "
    f"· min((t − t₁) / {spec.FRONT_RISE_S:g} s, 1) · (1 − s / {spec.FRONT_RANGE_M:g} m)",
    f"/ {spec.FRONT_DEPTH_M:g} m",
    f"/ ({spec.FRONT_WIDTH_M:g} m + {spec.FRONT_SPREAD:g} s)",
    f"each after {spec.FRONT_LIFE_S:g} s",
    f"σ = {spec.TURBULENCE_PER_GUSTINESS:g} g U̅",
    f"for U ≤ {spec.STREAMLINING_SPEED_M_S:g} m/s, ρ = {2 * spec.HALF_AIR_DENSITY_KG_M3:g} kg/m³",
    f"½ ρ {spec.STREAMLINING_SPEED_M_S:g}² (U/{spec.STREAMLINING_SPEED_M_S:g})^n",
    f"with c(x) = x up to 1 and 1 + ¼ ln(1 + {1 / spec.PRESSURE_COMPRESSION:g} (x − 1)) above",
    f"clamp({spec.CROWN_INTENSITY:g} f g A(ξ, η), ±{spec.CROWN_MOST_GUST:g})",
    f"ℓ = {spec.CROWN_CELL_M:g} m",
    f"− D {number(spec.CROWN_LEAN_ALONG).replace('−', '− ')} y) / ℓ",
    f"+ {spec.CROWN_LEAN_ACROSS:g} y) / ℓ + {spec.CROWN_SLANT:g} ξ",
    f"periodic fields of {spec.CROWN_CELLS} × {spec.CROWN_CELLS} points",
    f"k = 0 … {spec.CROWN_WAVES - 1}",
    f"texture of {spec.SPECTRAL_COLUMNS} × {spec.SPECTRAL_ROWS} cells, "
    f"{spec.SPECTRAL_CELLS_ALONG} per L along and {spec.SPECTRAL_CELLS_ACROSS} per L across",
    f"(1 + {spec.SPECTRAL_VON_KARMAN:g} n²)^(−β/2)",
    f"w = {spec.SPECTRAL_DECAY:g}/(2π) √(n² + {spec.SPECTRAL_SLOWEST_COHERENCE:g}²)",
    f"sampled at (ξ, η + {spec.SPECTRAL_SLANT:g} ξ)",
    f"V = {round(spec.PERLIN_NOISE_VARIANCE * 480729249)}/480729249",
    f"q = (η + {spec.PERLIN_SLANT:g} ξ)/2, z = {spec.PERLIN_CHANGE:g} S",
    f"N = {spec.EDDY_GRID}, {spec.EDDY_CELLS_PER_SCALE} per L",
    f"(1 + {spec.EDDY_FRICTION:g} + {spec.EDDY_LARGE_SCALE_FRICTION:g}/k²)",
    f"p += {spec.EDDY_KICK:g} N² / (8",
    f"where {spec.EDDY_BAND[0]} ≤ |k| < {spec.EDDY_BAND[1]};",
    f"where |k| ≥ {spec.EDDY_SLOWEST_START}, otherwise 0",
    f"run e = ⌊n/{spec.EDDY_EPOCH}⌋",
    f"f = (M − {spec.EDDY_EPOCH} e)/{spec.EDDY_OVERLAP}",
]
WIRE = [
    f"version {spec.WIRE_VERSION}",
    f"u32, at most {spec.WIRE_MAX_HEADER_BYTES:,}",
    f"√Σ (h_k b_k)² ≤ {1e3 * STREAM_ERROR_M:g} mm",
    f"1 / ({spec.MAX_STEPS_PER_ADVANCE} · {spec.TICK_HZ} · `dt_s`)",
    f"map of up to {spec.MOST_ABOUT_ENTRIES} names",
    f"at most {spec.MOST_PULLS_OF_FOREST}, whenever they have changed",
    f"for a forest larger than {spec.MOST_STREAMED_TREES:,} trees it should be",
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
    for name, field in FIELDS.items():
        row = next(line for line in text.splitlines() if line.startswith(f"| `{name}` |"))
        high = "2³²−1" if name == "seed" else number(field.high)
        assert f"| {number(field.low)} … {high}" in row, row
        if field.default is not None:
            assert f"default {'5/3' if name == 'beta' else number(field.default)} " in row, row
    for k, wave in enumerate(spec.FOREST_WAVES):
        row = re.search(rf"^\| {k} \| (.+) \| (.+) \| (.+) \|$", text, re.MULTILINE)
        assert row is not None
        assert [float(cell.replace("−", "-")) for cell in row.groups()] == list(wave.values())


def test_kinds_of_messages_have_their_numbers() -> None:
    rows = re.findall(r"^\| (\d+) \| ([A-Z_]+) \|", page_lines("wire"), re.MULTILINE)
    assert len(rows) == 19
    assert {name: int(kind) for kind, name in rows} == {
        name: getattr(spec, f"WIRE_{name}") for _, name in rows
    }


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

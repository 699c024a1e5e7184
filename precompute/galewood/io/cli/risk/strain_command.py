"""`galewood strain`: what a tree bears in a steady wind, or in gusts."""

from __future__ import annotations

import csv
import math
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer
from pydantic import Field

from galewood.io.cli.request_options import Mesh, WoodFile, validated, with_options_of, wood_document
from galewood.io.cli.risk.tree_bending import FOLIAGE_NAMES, OF_TREE, print_weight, progress_of, read_tree
from galewood.io.cli.tools import JsonOut, console, plain_errors, print_error, print_warning, write_figures
from galewood.io.cli.wind_options import WindOptions
from galewood.motion.wind import PRESETS, Wind
from galewood.options import BuildRequest

if TYPE_CHECKING:  # loaded only by the command that needs it
    from galewood.check.sway import SwayAnalysis
    from galewood.solid.strain import GustStrain, TreeStrain

USUAL_GUSTS = "autumn-gusts"
USUAL_SPEED_M_S = 15.0
PART_NAMES: dict[Literal["stem", "boughs"], str] = {"stem": "stem", "boughs": "boughs of 4 cm and more"}
NEAR_RATIO = 1.4
"""A resonance farther from the first frequency is that of another mode."""
CSV_COLUMNS = ("height_m", "x_m", "z_m", "branch", "part", "diameter_cm", "moment_nm", "strain", "stress_mpa")
STILL_SHARE = 1e-4
"""Deviation over the largest strain below which a series has no spectrum to speak of."""
FEWEST_ANALYSED = 256
"""Values that an analysis of a motion needs."""


class BendingWind(WindOptions):
    """The wind that bends a tree: steady, or gusts."""

    speed: float | None = Field(
        default=None,
        ge=0,
        le=150,
        description=f"(Mean) wind at the top of the tree, m/s; default: {USUAL_SPEED_M_S:g}, or that of a "
        "wind file.",
    )
    direction: float | None = Field(
        default=None,
        ge=-360,
        le=360,
        description="Direction the wind blows towards, degrees (0: x, 90: z); default: 0, or that of a wind "
        "file.",
    )
    gusts: bool = Field(
        default=False, description="Gusts, in which the tree sways, or a steady wind; --wind chooses them."
    )
    seconds: float = Field(default=600.0, ge=1, le=3600, description="Length of the series of gusts, s.")

    @property
    def gusty(self) -> bool:
        """Whether gusts are asked for."""
        return self.gusts or self.wind is not None

    def gust_wind(self) -> Wind:
        """The gusts, as strong as their preset or file has them. OSError or ValueError."""
        name = self.wind or USUAL_GUSTS
        heading = self.direction if self.direction is not None or name not in PRESETS else 0.0
        return self.model_copy(update={"wind": name, "speed": None, "direction": heading}).chosen()

    @property
    def top_speed_m_s(self) -> float | None:
        """Mean wind at the top of the tree; None: that of the wind file."""
        of_file = self.wind is not None and self.wind not in PRESETS
        return self.speed if self.speed is not None or of_file else USUAL_SPEED_M_S


@with_options_of(BuildRequest, only=(*OF_TREE, "foliage"))
@with_options_of(BendingWind)
def strain(
    tree: Mesh,
    csv_out: Annotated[
        Path | None,
        typer.Option("--csv", dir_okay=False, help="Write all sections in the steady (mean) wind here."),
    ] = None,
    series: Annotated[
        Path | None,
        typer.Option(dir_okay=False, help="Gusts: write the strain at 1.3 m over time to this table."),
    ] = None,
    wood_properties: WoodFile = None,
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Report bending strain and stress of a tree in a steady wind or in gusts: at 1.3 m, and the largest.

    For sound wood only, and no substitute for an inspection: not validated for decay, root damage or included
    bark.
    """
    from galewood.io.api import strain as strain_of
    from galewood.solid.strain import CAUTION_TEXT

    wind = validated(BendingWind, {name: chosen.pop(name) for name in BendingWind.model_fields})
    options = validated(BuildRequest, {**chosen, "wood": wood_document(wood_properties)})
    name = f"{tree.stem} {FOLIAGE_NAMES[options.foliage]}"
    if series is not None and not wind.gusty:
        print_error("There is no series of strain in a steady wind.", "Add --gusts, or --wind.")
        raise typer.Exit(2)
    if wind.gusty:
        found, analysis = _in_gusts(tree, options, wind)
        figures = found.figures()
        if analysis is not None:
            figures["breast_height"] |= {
                "spectrum_peak_hz": _spectrum_peak_hz(analysis),
                "sway": analysis.along.figures(),
            }
        if series is not None:
            _write_series(series, found)
        _print_gusts(name, found, analysis)
        steady = found.in_mean
    else:
        with plain_errors(), console.status(f"Bending {tree.stem}"):
            steady = strain_of(
                read_tree(tree, options),
                wind_m_s=USUAL_SPEED_M_S if wind.speed is None else wind.speed,
                direction_deg=wind.direction or 0.0,
                foliage=options.foliage,
                wood=options.own_wood,
            )
        figures = steady.figures()
        _print_steady(name, steady)
    write_figures(json_out, figures)
    if csv_out is not None:
        _write_sections(csv_out, steady)
    print_weight(steady)
    print_warning(CAUTION_TEXT)


def _in_gusts(tree: Path, options: BuildRequest, wind: BendingWind) -> tuple[GustStrain, SwayAnalysis | None]:
    """The strain in gusts, and an analysis of that at 1.3 m if there is enough of it."""
    from galewood.check.sway import analyse_motion
    from galewood.io.api import gust_strain

    with plain_errors():
        try:
            gusts = wind.gust_wind()
        except OSError as error:
            raise ValueError(str(error)) from None
        read = read_tree(tree, options)
        with progress_of(f"{tree.stem} in gusts") as report:
            found = gust_strain(
                read,
                gusts,
                wind_m_s=wind.top_speed_m_s,
                seconds=wind.seconds,
                foliage=options.foliage,
                wood=options.own_wood,
                on_progress=report,
            )
        breast = found.breast_height_strain
        still = breast is None or breast.std() <= STILL_SHARE * abs(breast).max()
        if still or len(found.time_s) < FEWEST_ANALYSED:
            return found, None
        return found, analyse_motion(found.breast_height_record())


def _print_steady(name: str, found: TreeStrain) -> None:
    console.print(f"{name}, wind of {found.wind_m_s:g} m/s:")
    breast = found.breast_height_strain
    console.print(f"strain at 1.3 m: {'the tree is lower' if breast is None else f'{breast:.5f}'}")
    for part, part_name in PART_NAMES.items():
        if largest := found.largest(part):
            console.print(
                f"largest strain, {part_name}: {largest.strain:.5f} ({largest.stress_mpa:.1f} MPa), "
                f"{largest.height_m:.1f} m up, diameter {largest.diameter_cm:.1f} cm"
            )
            _warn_of_rupture(part, largest.strain, found.rupture_strain)
    console.print(
        f"moment at the ground: {found.base_moment_nm / 1000:.3g} kN·m; the top moves by "
        f"{found.top_displacement_m:.2f} m"
    )


def _print_gusts(name: str, found: GustStrain, analysis: SwayAnalysis | None) -> None:
    seconds = float(found.time_s[-1])
    console.print(
        f"{name}, {seconds:.0f} s of gusts of up to {found.gust_m_s:.1f} m/s, {found.mean_m_s:.1f} m/s on "
        f"average; the tree sways at {found.frequency_hz:.2f} Hz:",
        soft_wrap=True,
    )
    breast, steady = found.breast_height_strain, found.in_mean.breast_height_strain
    if breast is None:
        console.print("strain at 1.3 m: the tree is lower")
    else:
        console.print(
            f"strain at 1.3 m: up to {abs(breast).max():.5f}, {breast.mean():.5f} ± {breast.std():.5f} "
            f"(standard deviation); {found.breast_height_factor:.2f} times that in the steady mean wind, "
            f"{steady:.5f}",
            soft_wrap=True,
        )
    for part, part_name in PART_NAMES.items():
        if peak := found.peak(part):
            at = peak.section
            of_gust = "" if peak.over_gust is None else f", {peak.over_gust:.2f} times in the strongest gust"
            console.print(
                f"largest strain, {part_name}: {at.strain:.5f} ({at.stress_mpa:.1f} MPa) after "
                f"{peak.time_s:.1f} s, {at.height_m:.1f} m up, diameter {at.diameter_cm:.1f} cm; RMS there "
                f"{peak.rms:.5f}; {peak.over_mean:.2f} times the largest in the steady mean wind{of_gust}",
                soft_wrap=True,
            )
            _warn_of_rupture(part, at.strain, found.rupture_strain)
    if analysis is not None:
        _print_spectrum(found.frequency_hz, analysis)


def _warn_of_rupture(part: Literal["stem", "boughs"], strain: float, rupture_strain: float) -> None:
    if strain > rupture_strain:
        what = "stem" if part == "stem" else "bough"
        print_warning(
            f"This is more than the rupture strain of the wood, {rupture_strain:.4f}: the {what} would break."
        )


def _spectrum_peak_hz(analysis: SwayAnalysis) -> float:
    """Where frequency times spectral density is largest: most of the variance is near."""
    frequency, density = analysis.spectra()
    return float(frequency[(frequency * density).argmax()])


def _print_spectrum(first_hz: float, analysis: SwayAnalysis) -> None:
    resonance = analysis.along.resonance
    near = resonance is not None and abs(math.log(resonance.frequency_hz / first_hz)) < math.log(NEAR_RATIO)
    answer = (
        f"resonance at {resonance.frequency_hz:.2f} Hz, damping ratio {resonance.damping_ratio:.2f}"
        if resonance is not None and near
        else "no clear resonance near the tree's frequency: drag damps it"
    )
    console.print(
        f"spectrum of the strain at 1.3 m: peak at {_spectrum_peak_hz(analysis):.2f} Hz (of frequency times "
        f"density); {answer}",
        soft_wrap=True,
    )


def _write_series(path: Path, found: GustStrain) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    if found.breast_height_strain is None:
        print_error(f"{path.name} was not written: the tree is lower than 1.3 m.")
        raise typer.Exit(1)
    with path.open("w", newline="") as file:
        table = csv.writer(file)
        table.writerow(("time_s", "strain"))
        for time_s, one in zip(found.time_s, found.breast_height_strain, strict=True):
            table.writerow((f"{time_s:.4f}", f"{one:.6g}"))


def _write_sections(path: Path, found: TreeStrain) -> None:
    from galewood.solid.strain import CAUTION_TEXT

    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="") as file:
        file.write(f"# {CAUTION_TEXT}\n")
        table = csv.writer(file)
        table.writerow(CSV_COLUMNS)
        for k, (x, y, z) in enumerate(found.place_m):
            part = "stem" if found.stem[k] else "bough" if found.bough[k] else "thin"
            row = (100 * found.diameter_m[k], found.moment_nm[k], found.strain[k], found.stress_pa[k] / 1e6)
            named = [f"{v:.4g}" for v in (y, x, z)] + [str(found.branch[k]), part]
            table.writerow(named + [f"{v:.5g}" for v in row])


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(strain)

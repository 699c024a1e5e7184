"""`galewood motion`: what a record of a real tree's motion says, beside a model of the tree."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from galewood.io.cli.request_options import WoodFile, validated, with_options_of, wood_document
from galewood.io.cli.tools import (
    CacheDir,
    JsonOut,
    console,
    plain_errors,
    print_error,
    print_warning,
    progress_bar,
    progress_reporter,
    write_figures,
    write_plot,
)
from galewood.options import BuildRequest

if TYPE_CHECKING:  # loaded only by the command that needs it
    from galewood.check.sway import AxisSway, Calibration, PredictedSway, SwayAnalysis, WindResponse
    from galewood.wood import Wood

LIKELY_FACTOR, LIKELY_DEVIATION = 2.0, 0.25
"""Of a calibrated modulus, and of the damping ratio over that of the record: what exceeds them is said."""
TABLE_SUFFIX = ".gwt"
OF_TREE = (
    "species", "height_m", "dbh_cm", "foliage", "min_radius_mm", "up_axis", "root_stiffness_knm",
    "target_tets",
)  # fmt: skip


@with_options_of(BuildRequest, only=OF_TREE)
def motion(
    record: Annotated[
        Path,
        typer.Argument(
            exists=True,
            dir_okay=False,
            help="CSV: time, and strain, tilt, acceleration or sway; one or two axes.",
        ),
    ],
    tree: Annotated[
        Path | None,
        typer.Option(
            exists=True,
            dir_okay=False,
            help="Mesh or scan of the tree, to compare with its model; or its table (.gwt), to simulate its "
            "sway in the record's wind.",
        ),
    ] = None,
    calibrate: Annotated[
        Path | None,
        typer.Option(
            dir_okay=False,
            help="Fit the tree's wood to the record, and write it here for --wood-properties (JSON).",
        ),
    ] = None,
    columns: Annotated[
        list[str] | None,
        typer.Option(help="What a column has: time=, axis1=, axis2= or wind= and its name; may be repeated."),
    ] = None,
    rate_hz: Annotated[
        float | None, typer.Option(min=0.5, max=1000.0, help="Samples per second of a file without times.")
    ] = None,
    wood_properties: WoodFile = None,
    plot: Annotated[Path | None, typer.Option(help="Plot to write (PNG, SVG, PDF).")] = None,
    cache_dir: CacheDir = Path("data/cache"),
    json_out: JsonOut = None,
    **chosen: Any,
) -> None:
    """Report frequency, damping and spectrum of a recorded motion of a tree, beside those of its model."""
    from galewood.check.sway import analyse_motion, sway_figure
    from galewood.measurements import MeasurementError, read_motion

    options = validated(BuildRequest, {**chosen, "wood": wood_document(wood_properties)})
    of_table = tree is not None and tree.suffix.lower() == TABLE_SUFFIX
    if (tree is None or of_table) and calibrate is not None:
        print_error("There is no tree to calibrate.", "Give its mesh or scan with --tree.")
        raise typer.Exit(2)
    try:
        with console.status(f"Reading {record.name}"):
            analysis = analyse_motion(read_motion(record, rate_hz=rate_hz, columns=_columns(columns)))
    except MeasurementError as error:
        print_error(f"{record.name}: {error}")
        raise typer.Exit(1) from None
    figures = analysis.figures()
    _print_analysis(record.name, analysis)
    predicted = simulated = None
    if tree is not None and of_table:
        simulated = _simulated(tree, analysis)
        figures["simulated"] = simulated.figures()
        _print_axis(f"{tree.stem} simulated in the same wind", simulated.along)
        if simulated.wind is not None:
            _print_wind(simulated.wind)
        for note in simulated.record.notes:
            print_warning(note)
    elif tree is not None:
        predicted, calibration = _compared(tree, options, analysis, calibrate is not None, cache_dir)
        figures["model"] = predicted.figures()
        _print_predicted("model", predicted)
        if calibration is not None:
            figures["calibration"] = calibration.figures()
            _print_calibration(calibration)
        if calibration is not None and calibrate is not None:
            _write_wood(calibrate, calibration.wood, record.name)
    if plot is not None:
        write_plot(plot, sway_figure(analysis, predicted, record.stem, simulated))
    write_figures(json_out, figures)


def _simulated(path: Path, analysis: SwayAnalysis) -> SwayAnalysis:
    """The sway of a table's tree in the wind of a record, analysed like it."""
    from galewood.check.sway import analyse_motion
    from galewood.io.api import load, simulated_motion

    with plain_errors(), console.status(f"Simulating {path.stem}"):
        return analyse_motion(simulated_motion(load(path), analysis.record))


def _columns(chosen: list[str] | None) -> dict[str, str]:
    """Names of columns by what they have."""
    from galewood.measurements import CHOSEN_NAMES

    known, found = CHOSEN_NAMES, dict[str, str]()
    for text in chosen or []:
        what, equals, name = text.partition("=")
        if what not in known or not equals:
            print_error(f"--columns {text!r} is not understood.", f"Write {'=…, '.join(known)}=….")
            raise typer.Exit(2)
        found[what] = name
    return found


def _compared(
    path: Path, options: BuildRequest, analysis: SwayAnalysis, calibrate: bool, cache_dir: Path
) -> tuple[PredictedSway, Calibration | None]:
    """What the model of the tree predicts, and the calibration if it is asked for."""
    from galewood.check.sway import predicted_sway
    from galewood.io.api import Model, read
    from galewood.io.api import calibrate as calibrate_wood
    from galewood.options import ImportRequest
    from galewood.solid.fem import FemSettings

    settings = FemSettings(root_stiffness_nm_rad=options.root_stiffness_nm_rad)
    with plain_errors(), progress_bar() as bar:
        report = progress_reporter(bar)
        report(0.0, "Building the model")
        given = options.model_dump(include=set(ImportRequest.model_fields), exclude_none=True)
        tree = read(path, **given)
        common: dict[str, Any] = {
            "wood": options.own_wood, "foliage": options.foliage, "target_tets": options.target_tets,
            "settings": settings, "cache_dir": cache_dir,
        }  # fmt: skip
        if not calibrate:
            return predicted_sway(Model(tree, **common).fem, analysis.record.wind_m_s), None
        found = calibrate_wood(
            tree, analysis, **common, on_progress=lambda share: report(share, "Calibrating the wood")
        )
        return found.before, found


def _print_analysis(name: str, analysis: SwayAnalysis) -> None:
    record = analysis.record
    axes = "one axis" if record.values.shape[1] == 1 else "two axes"
    lost = f", {record.missing_count} values missing" if record.missing_count else ""
    gaps = f"; {record.gap_count} long gaps: this is the longest piece" if record.gap_count else ""
    console.print(
        f"{name}: {record.quantity}, {axes}, {record.rate_hz:.4g} samples per second, "
        f"{record.duration_s / 60:.3g} min{lost}{gaps}",
        soft_wrap=True,
    )
    for what, column in (record.columns or {}).items():
        console.print(f"  {what}: {column}")
    _print_axis("along the first principal axis", analysis.along)
    if analysis.across is not None:
        _print_axis("across it", analysis.across)
        ratio = (
            "one of them does not move"
            if analysis.variance_ratio is None
            else f"{analysis.variance_ratio:.3g} to 1"
        )
        console.print(
            f"variances along the two: {ratio}; the first lies at "
            f"{analysis.direction_deg:.0f}° from axis 1 towards axis 2"
        )
    if analysis.wind is not None:
        _print_wind(analysis.wind)
    for note in record.notes:
        print_warning(note)


def _print_wind(found: WindResponse) -> None:
    if not len(found.wind_m_s):
        console.print("wind: too weak to say how the tree answers it")
        return
    exponent = "" if found.exponent is None else f"; the sway grows as U^{found.exponent:.2f}"
    slowest, fastest = found.wind_m_s.min(), found.wind_m_s.max()
    console.print(f"wind: {len(found.wind_m_s)} windows of {slowest:.1f} to {fastest:.1f} m/s{exponent}")


def _print_axis(where: str, axis: AxisSway) -> None:
    parts: list[str] = []
    if found := axis.resonance:
        parts.append(
            f"{found.frequency_hz:.4g} ± {found.frequency_error_hz:.1g} Hz, damping ratio "
            f"{found.damping_ratio:.3f} ± {found.damping_error:.3f} by the spectrum"
        )
    if axis.decrement:
        parts.append(f"{axis.decrement.damping_ratio:.3f} by random decrement")
    console.print(f"{where}: {', '.join(parts) or 'no resonance'}")
    for note in axis.notes:
        print_warning(f"  {note}")
    if axis.slopes:
        bands = ", ".join(f"{slope:.2f} in {band} Hz" for band, slope in axis.slopes.items())
        console.print(f"  slope of the spectrum: {bands}")


def _print_predicted(who: str, predicted: PredictedSway) -> None:
    console.print(
        f"{who}: {predicted.frequency_hz:.4g} Hz, damping ratio {predicted.damping_ratio:.3f}, of which drag "
        f"{predicted.drag_damping_ratio:.3f}"
    )


def _print_calibration(found: Calibration) -> None:
    factor = found.wood.young_longitudinal_pa / found.given.young_longitudinal_pa
    console.print(
        f"calibrated: E {found.wood.young_longitudinal_pa / 1e9:.2f} GPa (× {factor:.2f}), damping ratio "
        f"of the wood {found.wood.damping_ratio:.3f} (given: {found.given.damping_ratio:.3f})"
    )
    _print_predicted("model with it", found.after)
    if not found.reached:
        print_warning("The frequency was not reached within 0.2 %: check the record and the tree.")
    if not 1 / LIKELY_FACTOR <= factor <= LIKELY_FACTOR:
        print_warning("E is far from that of its species: check height, diameter and record before using it.")
    measured = found.record_damping_ratio
    if abs(found.after.damping_ratio / measured - 1) > LIKELY_DEVIATION:
        print_warning(
            f"The damping ratio of the record, {measured:.3f}, was not reached: drag and leaves alone make "
            f"{found.after.drag_damping_ratio:.3f}."
        )


def _write_wood(path: Path, wood: Wood, record: str) -> None:
    from dataclasses import asdict

    from galewood.wood import WoodDocument

    fields = set(WoodDocument.model_fields) & set(asdict(wood))
    given = {name: value for name, value in asdict(wood).items() if name in fields}
    document = WoodDocument.model_validate({**given, "source": f"calibrated with {record}"})
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(document.model_dump_json(indent=2, exclude_none=True) + "\n")


def register(app: typer.Typer) -> None:
    """Add the command to the program."""
    app.command()(motion)

"""Plot of a recorded sway: spectrum with its fit, mean decay, and the answer to the wind."""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.check.sway.analysis import SwayAnalysis
from galewood.check.sway.predicted import PredictedSway
from galewood.check.sway.spectrum import AROUND_RESONANCE

COLOURS = {"leaf": "#1b7f5c", "bare": "#c2571a"}
SIMULATED_COLOUR = "#3b6fb5"
SCALED_LABEL = "table, scaled to the record's variance"
GREY_COLOUR = "#8a8a8a"


def sway_figure(
    analysis: SwayAnalysis,
    predicted: PredictedSway | None = None,
    title: str = "",
    simulated: SwayAnalysis | None = None,
) -> Any:
    """The figure of an analysis; with a prediction, its frequency is marked.

    The sway that a table has in the record's wind, ``simulated``, is drawn beside it.
    """
    from matplotlib.figure import Figure

    panels = 2 + (analysis.wind is not None)
    figure = Figure(figsize=(4.4 * panels, 3.4), layout="constrained")
    axes = figure.subplots(1, panels, squeeze=False)[0]
    _spectrum(axes[0], analysis, predicted)
    _decay(axes[1], analysis)
    if simulated is not None:
        _beside(axes, analysis, simulated)
    if analysis.wind is not None:
        axes[2].plot(
            analysis.wind.wind_m_s, analysis.wind.deviation, "o", markersize=4, color=COLOURS["leaf"]
        )
        axes[2].set_xlabel("mean wind, m/s", fontsize=8)
        axes[2].set_ylabel(f"standard deviation of the {analysis.record.quantity}", fontsize=8)
        if analysis.wind.exponent is not None:
            axes[2].set_title(f"U^{analysis.wind.exponent:.2f}", fontsize=8, loc="right")
    axes[0].set_title(title, fontsize=8, loc="left")
    for panel in axes:
        panel.tick_params(labelsize=7)
        panel.spines[["top", "right"]].set_visible(False)
    return figure


def _spectrum(panel: Any, analysis: SwayAnalysis, predicted: PredictedSway | None) -> None:
    frequency, density = analysis.spectra()
    panel.loglog(frequency, density, color=COLOURS["leaf"], linewidth=1, label="record")
    if resonance := analysis.along.resonance:
        low, high = (share * resonance.frequency_hz for share in AROUND_RESONANCE)
        near = np.geomspace(low, min(high, frequency[-1]), 200)
        label = f"{resonance.frequency_hz:.3g} Hz, damping ratio {resonance.damping_ratio:.2g}"
        panel.loglog(near, resonance.spectrum(near), color=COLOURS["bare"], linewidth=1, label=label)
    if predicted:
        label = f"model: {predicted.frequency_hz:.3g} Hz, {predicted.damping_ratio:.2g}"
        panel.axvline(predicted.frequency_hz, color=GREY_COLOUR, linestyle=":", linewidth=1, label=label)
    unit = {"": "", "1": ", 1/Hz"}.get(analysis.record.unit, f", ({analysis.record.unit})²/Hz")
    panel.set_xlabel("frequency, Hz", fontsize=8)
    panel.set_ylabel(f"spectral density of the {analysis.record.quantity}{unit}", fontsize=8)
    panel.legend(fontsize=7, frameon=False)


def _beside(axes: Any, analysis: SwayAnalysis, simulated: SwayAnalysis) -> None:
    """Spectrum, decay and answer to the wind of a simulated sway, in the unit of the record."""
    scale = analysis.along.deviation / max(simulated.along.deviation, 1e-300)
    frequency, density = simulated.spectra()
    axes[0].loglog(frequency, scale**2 * density, color=SIMULATED_COLOUR, linewidth=0.8, label=SCALED_LABEL)
    axes[0].legend(fontsize=7, frameon=False)
    if decrement := simulated.along.decrement:
        label = f"table: {decrement.damping_ratio:.2g}"
        axes[1].plot(
            decrement.time_s, decrement.deflection, color=SIMULATED_COLOUR, linewidth=0.8, label=label
        )
        axes[1].legend(fontsize=7, frameon=False)
    if analysis.wind is not None and simulated.wind is not None:
        axes[2].plot(
            simulated.wind.wind_m_s, scale * simulated.wind.deviation, "o", markersize=3,
            color=SIMULATED_COLOUR,
        )  # fmt: skip


def _decay(panel: Any, analysis: SwayAnalysis) -> None:
    panel.set_xlabel("time, s", fontsize=8)
    panel.set_ylabel("mean decay (random decrement)", fontsize=8)
    if decrement := analysis.along.decrement:
        panel.plot(decrement.time_s, decrement.deflection, color=COLOURS["leaf"], linewidth=1)
        label = f"damping ratio {decrement.damping_ratio:.2g}"
        panel.plot(decrement.time_s, decrement.fitted, color=COLOURS["bare"], linewidth=0.8, label=label)
        panel.legend(fontsize=7, frameon=False)

"""Plots: model against measurement, and the decay of a released tree."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from galewood.check.field.decay import envelope
from galewood.check.sway import COLOURS, GREY_COLOUR

if TYPE_CHECKING:
    from galewood.check.field.release import Release


def scatter_figure(report: dict[str, Any]) -> Any:
    """The figure of a report: frequencies by the model and by the trees' sizes, and damping if measured."""
    from matplotlib.figure import Figure

    trees = [tree for tree in report["trees"] if tree["frequency_hz"] is not None]
    damped = [t for t in trees if t["damping_ratio"] and t.get("model_damping_ratio")]
    figure = Figure(figsize=(4.4 * (3 if damped else 2), 4.4), layout="constrained")
    panels = figure.subplots(1, 3 if damped else 2, squeeze=False)[0]
    model = [(t["frequency_hz"], t["model_frequency_hz"], t) for t in trees]
    _scatter(panels[0], model, "measured frequency, Hz", "main sway mode of the model, Hz")
    own = "own_power_law" in report["frequency"]
    method = "own_power_law" if own else "forest"
    title = "power law of the other trees' sizes, Hz" if own else "forest-grown trees of that size, Hz"
    sized = [t for t in trees if method in t["predicted_hz"]]
    pairs = [(t["frequency_hz"], t["predicted_hz"][method], t) for t in sized]
    _scatter(panels[1], pairs, "measured frequency, Hz", title)
    if damped:
        pairs = [(t["damping_ratio"], t["model_damping_ratio"], t) for t in damped]
        _scatter(panels[2], pairs, "measured damping ratio", "damping ratio of the released model")
    return figure


def bending_figure(report: dict[str, Any]) -> Any:
    """Strains and critical winds by the model against the measured ones, a panel for each."""
    from matplotlib.figure import Figure

    names = list(report["bending"])
    figure = Figure(figsize=(4.4 * len(names), 4.4), layout="constrained")
    for panel, name in zip(figure.subplots(1, len(names), squeeze=False)[0], names, strict=True):
        pairs = [
            (tree["bending"][name], modelled, tree)
            for tree in report["trees"]
            if name in tree.get("bending", {}) and (modelled := tree["model_bending"].get(name)) is not None
        ]
        title = name.removeprefix("strain_")
        what = "gust that breaks the stem, m/s" if title == name else f"strain at 1.3 m in {title} m/s"
        _scatter(panel, pairs, f"measured {what}", f"{what} by the model")
    return figure


def _scatter(panel: Any, pairs: list[tuple[float, float, dict[str, Any]]], across: str, up: str) -> None:
    from matplotlib.ticker import FormatStrFormatter, LogLocator, NullFormatter

    panel.set_xlabel(across, fontsize=8)
    panel.set_ylabel(up, fontsize=8)
    panel.tick_params(labelsize=7)
    panel.spines[["top", "right"]].set_visible(False)
    if not pairs:
        return
    values = np.array([pair[:2] for pair in pairs])
    ends = np.array([0.8 * values.min(), 1.25 * values.max()])
    panel.loglog(ends, ends, color=GREY_COLOUR, linewidth=0.8)
    for factor in (0.8, 1.25):
        panel.loglog(ends, factor * ends, color=GREY_COLOUR, linewidth=0.5, linestyle=":")
    for season, colour in COLOURS.items():
        of_season = [pair for pair in pairs if pair[2]["season"] == season]
        if of_season:
            panel.loglog(*zip(*[p[:2] for p in of_season], strict=True), "o", color=colour, markersize=4,
                         label={"leaf": "in leaf", "bare": "bare"}[season])  # fmt: skip
    panel.set_xlim(ends)
    panel.set_ylim(ends)
    for axis in (panel.xaxis, panel.yaxis):
        axis.set_major_locator(LogLocator(subs=(1, 1.5, 2, 3, 5, 7)))
        axis.set_major_formatter(FormatStrFormatter("%g"))
        axis.set_minor_formatter(NullFormatter())
    panel.legend(fontsize=7, frameon=False)


def decay_figure(release: Release, title: str = "") -> Any:
    """The sway of a released tree with its fitted envelope, and its damping ratio against the amplitude."""
    from matplotlib.figure import Figure

    decay = release.decay
    figure = Figure(figsize=(8.4, 2.8), layout="constrained")
    left, right = figure.subplots(1, 2, width_ratios=[2, 1])
    left.plot(release.time_s, 100 * release.sway, color=COLOURS["leaf"], linewidth=1)
    phase = 2 * np.pi * decay.frequency_hz * release.time_s
    fitted = 100 * envelope(phase, decay.start, decay.linear, decay.quadratic)
    for sign in (1, -1):
        left.plot(release.time_s, sign * fitted, color=COLOURS["bare"], linewidth=0.8)
    left.set_xlabel("time, s", fontsize=8)
    left.set_ylabel("sway, % of height", fontsize=8)
    left.set_title(title, fontsize=8, loc="left")
    amplitude, ratio = decay.by_cycle
    right.plot(100 * amplitude, ratio, "o", color=COLOURS["leaf"], markersize=3)
    reach = np.linspace(0, float(amplitude.max()), 50)
    right.plot(100 * reach, [decay.ratio_at(a) for a in reach], color=COLOURS["bare"], linewidth=0.8)
    right.set_xlabel("amplitude, % of height", fontsize=8)
    right.set_ylabel("damping ratio", fontsize=8)
    right.set_ylim(bottom=0)
    for panel in (left, right):
        panel.tick_params(labelsize=7)
        panel.spines[["top", "right"]].set_visible(False)
    return figure

"""Plots the errors of an evaluation over time, one panel per wind, in the style of the paper's Fig. 3."""

from __future__ import annotations

from pathlib import Path
from typing import Any

ERROR_FLOOR_SHARE = 1e-6
"""Errors are drawn no smaller than this share of the height."""
STYLES = {
    "modal": ("#1b7f5c", 1.4, "-"),
    "paper": ("#c2571a", 1.0, "-"),
    "paper-literal": ("#c2571a", 0.8, ":"),
    "nearest-sample": ("#7a7a7a", 0.8, "--"),
    "rest-pose": ("#b5b5b5", 0.8, "-"),
}
MARKED_FRAMES = (20, 40, 60)


def plot_errors(in_gusts: dict[str, Any], uniform: dict[str, Any], path: Path) -> None:
    """Plot the figures of an evaluation to a file (PNG, SVG or PDF by its suffix), those in gusts first."""
    path.parent.mkdir(parents=True, exist_ok=True)
    named = {f"gusts, {name}": case for name, case in in_gusts.items()}
    error_figure({**named, **uniform}).savefig(path, dpi=110)


def error_figure(figures: dict[str, Any]) -> Any:
    """Create the figure without saving it, from figures by wind."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 1.5 * len(figures) + 0.8), layout="constrained")
    panels = figure.subplots(len(figures), 1, sharex=True, squeeze=False)[:, 0]
    for panel, (wind, methods) in zip(panels, figures.items(), strict=True):
        for method, (colour, width, dashes) in STYLES.items():
            if method in methods:
                errors = [max(value, ERROR_FLOOR_SHARE) for value in methods[method]["error_by_frame"]]
                frames = range(1, len(errors) + 1)
                panel.semilogy(frames, errors, dashes, color=colour, linewidth=width, label=method)
        for frame in MARKED_FRAMES:
            panel.axvline(frame, color="#d0d0d0", linewidth=0.6, zorder=0)
        sway = methods.get("rest-pose", methods)["reference_sway"]
        panel.set_title(f"{wind}: sways by {sway:.1%} of the height", fontsize=8, loc="left")
        panel.tick_params(labelsize=7)
        panel.spines[["top", "right"]].set_visible(False)
    figure.supylabel("largest error / height", fontsize=8)
    panels[-1].set_xlabel("frame", fontsize=8)
    figure.legend(*panels[0].get_legend_handles_labels(), loc="outside upper center", fontsize=7, ncols=5)
    return figure

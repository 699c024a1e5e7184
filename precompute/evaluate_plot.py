"""The errors of an evaluation over time, one panel a wind, in the style of the paper's Fig. 3."""

from __future__ import annotations

from pathlib import Path
from typing import Any

FLOOR = 1e-5
"""Errors below this share of the height are drawn at it."""


def plot_errors(figures: dict[str, Any], path: Path) -> None:
    """Write a picture (PNG, SVG or PDF by its name) of what ``evaluate_table`` found."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(7.0, 1.9 * len(figures)), layout="constrained")
    panels = figure.subplots(len(figures), 1, sharex=True, squeeze=False)[:, 0]
    for panel, (wind, methods) in zip(panels, figures.items(), strict=True):
        for method, found in methods.items():
            errors = [max(value, FLOOR) for value in found["error_by_frame"]]
            panel.semilogy(range(1, len(errors) + 1), errors, label=method, linewidth=1.0)
        panel.set_title(f"{wind}: sways by {methods['rest-pose']['true_sway']:.1%} of the height", fontsize=9)
        panel.set_ylabel("error / height", fontsize=8)
    panels[-1].set_xlabel("frame")
    panels[0].legend(fontsize=7, ncols=5)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=130)

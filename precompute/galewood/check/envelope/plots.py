"""Plot of a sway envelope: the crown from above, and its profile."""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.check.envelope.reach import SwayEnvelope
from galewood.check.sway import COLOURS, GREY_COLOUR

LEVELS = (("at rest", GREY_COLOUR), ("median in gusts", COLOURS["leaf"]), ("90 % in gusts", COLOURS["bare"]))


def envelope_figure(envelope: SwayEnvelope, title: str = "") -> Any:
    """The figure of an envelope: reach over all heights by direction, and largest reach by height."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(8.4, 4.2), layout="constrained")
    above = figure.add_subplot(1, 2, 1, projection="polar")
    side = figure.add_subplot(1, 2, 2)
    angle = np.radians(-np.append(envelope.direction_deg, 0.0))  # east to the right, north up
    middle = (envelope.height_m[1:] + envelope.height_m[:-1]) / 2
    levels = (envelope.rest_m, envelope.quantile_m(0.5), envelope.quantile_m(0.9))
    for level, (label, colour) in zip(levels, LEVELS, strict=True):
        reach = level.max(axis=0)
        above.plot(angle, np.append(reach, reach[0]), color=colour, linewidth=1.2, label=label)
        side.plot(level.max(axis=1), middle, color=colour, linewidth=1.2, marker="o", markersize=3)
    above.set_title(title, fontsize=8, loc="left")
    above.set_xticks(np.radians([0, 90, 180, 270]), ["E", "N", "W", "S"])
    above.legend(fontsize=7, frameon=False, loc="lower left", bbox_to_anchor=(-0.15, -0.15))
    side.set_xlabel("largest reach from the trunk's axis, m", fontsize=8)
    side.set_ylabel("height at rest, m", fontsize=8)
    side.spines[["top", "right"]].set_visible(False)
    for panel in (above, side):
        panel.tick_params(labelsize=7)
    return figure

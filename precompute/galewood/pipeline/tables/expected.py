"""What a tree will do in the wind, before it is computed: from beams along its branches, within a second."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from galewood.constants import LINEAR_SWAY_SHARE
from galewood.solid.model import beam_model, typical_frequency_hz
from galewood.tree import TreeMesh
from galewood.wood import Wood, wood_of_species

BREEZE_M_S, STORM_M_S = 10.0, 18.0
MIN_FREQUENCY_RATIO = 0.5
"""Lowest frequency to suggest, over that of measured trees: softer trees could not carry their own weight."""
VISIBLE_SHARE = 0.01
"""Sway in the strong wind, relative to the height, below which motion is barely visible."""


def expected_motion(tree: TreeMesh, wood: Wood | None = None) -> dict[str, Any] | None:
    """First frequency and sway of an imported tree; JSON-able. None if no beam model can be made of it.

    The sway is the largest displacement under a steady wind, for a linear response; gusts add to it.
    ``typical_frequency_hz`` is that of measured trees of this height. ``lively_frequency_hz`` is at most as
    high, and down to half as high if the sway in a strong wind would not be visible otherwise.
    """
    try:
        model = beam_model(tree, wood or wood_of_species(tree.species or "default"))
    except ValueError:
        return None
    first_hz, typical_hz = float(model.frequencies_hz[0]), typical_frequency_hz(tree.height_m)
    sway_m = {speed_m_s: model.steady_sway_m(speed_m_s) for speed_m_s in (BREEZE_M_S, STORM_M_S)}
    share = sway_m[STORM_M_S] / tree.height_m
    return {
        "first_frequency_hz": first_hz,
        "typical_frequency_hz": typical_hz,
        "lively_frequency_hz": _lively_hz(first_hz, typical_hz, share),
        "sway": [
            {"wind_m_s": speed_m_s, "sway_m": far_m, "share": far_m / tree.height_m}
            for speed_m_s, far_m in sway_m.items()
        ],
        "visible": share >= VISIBLE_SHARE,
    }


def _lively_hz(first_hz: float, typical_hz: float, share: float) -> float:
    """At most the frequency of measured trees; lower if the sway is not visible then, but not much lower."""
    visible_hz = first_hz * math.sqrt(share / VISIBLE_SHARE)
    return min(first_hz, typical_hz, max(visible_hz, MIN_FREQUENCY_RATIO * typical_hz))


def with_expected_motion(tree: TreeMesh) -> TreeMesh:
    """The tree with ``expected`` in its report."""
    return replace(tree, report=tree.report | {"expected": expected_motion(tree)})


def motion_lines(expected: dict[str, Any] | None) -> list[str]:
    """The expected motion as lines to read."""
    if expected is None:
        return ["Unsure how far it sways: no beams can be laid along its branches."]
    sways = [f"{_sway_words(sway)} at {sway['wind_m_s']:g} m/s" for sway in expected["sway"]]
    lines = [
        f"expected sway {' and '.join(sways)}, first frequency about {expected['first_frequency_hz']:.2g} Hz"
    ]
    if not expected["visible"]:
        lines.append(
            "The motion of this tree will be barely visible. Trees of its height sway at about "
            f"{expected['typical_frequency_hz']:.2g} Hz. For visible motion, build it with "
            f"--first-frequency-hz {expected['lively_frequency_hz']:.2g}."
        )
    return lines


def _sway_words(sway: dict[str, Any]) -> str:
    """A sway as a length and share of the height; the linear response says too much of a large one."""
    if sway["share"] > LINEAR_SWAY_SHARE:
        return f"more than {100 * LINEAR_SWAY_SHARE:g} % of the height"
    share = f"{100 * sway['share']:.2g}" if sway["share"] >= 1e-5 else "less than 0.001"
    return f"{length_words(sway['sway_m'])} ({share} % of the height)"


def length_words(metres: float) -> str:
    """A length in m, cm or mm."""
    if metres >= 1:
        return f"{metres:.1f} m"
    if metres >= 0.0095:
        return f"{100 * metres:.0f} cm"
    return f"{1000 * metres:.1g} mm" if metres >= 0.0001 else "less than 0.1 mm"

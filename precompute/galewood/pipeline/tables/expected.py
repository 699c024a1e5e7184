"""What a tree will do in the wind, before it is computed: from beams along its branches, within a second."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

from galewood.constants import LINEAR_SWAY_SHARE
from galewood.solid.model import BeamModel, beam_model, typical_frequency_hz
from galewood.tree import TreeMesh
from galewood.wood import Wood, wood_of_species

BREEZE_M_S, STORM_M_S = 10.0, 18.0
MIN_FREQUENCY_RATIO = 0.5
"""Lowest frequency to suggest, over that of measured trees: softer trees could not carry their own weight."""
VISIBLE_SHARE = 0.01
"""Sway in the strong wind, relative to the height, below which motion is barely visible."""
LARGEST_LOAD_FACTOR = 2.0
"""Weight over buckling load from which the beams say nothing: a build then changes masses and stiffness of
the tree until it stands."""
MOST_SOFTENED = 0.8
"""Highest frequency to soften a tree to, relative to that of its wood: a smaller change is not seen."""


def expected_motion(tree: TreeMesh, wood: Wood | None = None, leaves: bool = True) -> dict[str, Any] | None:
    """The motion of an imported tree with the stiffness of its wood (``motion_of``); None: unsure."""
    try:
        model = beam_model(tree, wood or wood_of_species(tree.species or "default"), leaves=leaves)
    except ValueError:
        return None
    return motion_of(tree, model)


def motion_of(tree: TreeMesh, model: BeamModel) -> dict[str, Any] | None:
    """First frequency and sway of a tree of beams; JSON-able. None: unsure.

    Unsure if the tree would not stand, or if its limbs are chains of overlapping surfaces: how these hold on
    to each other decides how stiff they are, and the finite elements then had 0.45 to 1.25 of the frequency.

    The sway is the largest displacement under a steady wind, for a linear response; gusts add to it.
    ``typical_frequency_hz`` is that of measured trees of this height. ``lively_frequency_hz`` is at most as
    high, and down to half as high if the sway in a strong wind would not be visible otherwise.
    ``default_frequency_hz`` is what a build makes of it unless it is asked for something else
    (``TableRequest.stiffness``): the lively one if the tree is stylised and its motion would be barely
    visible, else that of the wood. Scanned trees (``measured``) keep that: their radii are known.
    """
    if model.chained or float(model.load_factors[0]) > LARGEST_LOAD_FACTOR:
        return None
    first_hz, typical_hz = float(model.frequencies_hz.min()), typical_frequency_hz(tree.height_m)
    sway_m = {speed_m_s: model.steady_sway_m(speed_m_s) for speed_m_s in (BREEZE_M_S, STORM_M_S)}
    share = sway_m[STORM_M_S] / tree.height_m
    lively_hz, measured = _lively_hz(first_hz, typical_hz, share), "qsm" in tree.report
    softened = share < VISIBLE_SHARE and not measured
    return {
        "first_frequency_hz": first_hz,
        "typical_frequency_hz": typical_hz,
        "lively_frequency_hz": lively_hz,
        "default_frequency_hz": lively_hz if softened else first_hz,
        "measured": measured,
        "sway": [
            {"wind_m_s": speed_m_s, "sway_m": far_m, "share": far_m / tree.height_m}
            for speed_m_s, far_m in sway_m.items()
        ],
        "visible": share >= VISIBLE_SHARE,
    }


def _lively_hz(first_hz: float, typical_hz: float, share: float) -> float:
    """At most the frequency of measured trees; lower if the sway is not visible then, but not much lower.

    That of the wood, if it would hardly change.
    """
    visible_hz = first_hz * math.sqrt(share / VISIBLE_SHARE)
    lively_hz = min(typical_hz, max(visible_hz, MIN_FREQUENCY_RATIO * typical_hz))
    return lively_hz if lively_hz < MOST_SOFTENED * first_hz else first_hz


def with_expected_motion(tree: TreeMesh) -> TreeMesh:
    """The tree with ``expected`` in its report."""
    return replace(tree, report=tree.report | {"expected": expected_motion(tree)})


def motion_lines(expected: dict[str, Any] | None, may_soften: bool = True) -> list[str]:
    """The expected motion as lines to read; whether a build may soften the tree."""
    if expected is None:
        return [
            "Unsure how far it sways: its branches are drawn in many pieces, do not bear its weight, or "
            "cannot be followed."
        ]
    sways = [f"{_sway_words(sway)} at {sway['wind_m_s']:g} m/s" for sway in expected["sway"]]
    lines = [
        f"expected sway {' and '.join(sways)}, first frequency about {expected['first_frequency_hz']:.2g} Hz"
    ]
    if expected["visible"]:
        return lines
    lines.append(
        "With the stiffness of its wood, the motion of this tree would be barely visible. Trees of its "
        f"height sway at about {expected['typical_frequency_hz']:.2g} Hz."
    )
    if is_softened(expected) and may_soften:
        lines.append(
            f"A build makes it softer, with a first frequency of {expected['default_frequency_hz']:.2g} Hz; "
            '--stiffness "as drawn" keeps the stiffness of its wood.'
        )
    elif expected["measured"]:
        lines.append(
            "It is a scanned tree and keeps the stiffness of its wood. For visible motion, build it with "
            f"--first-frequency-hz {expected['lively_frequency_hz']:.2g}."
        )
    return lines


def is_softened(expected: dict[str, Any]) -> bool:
    """Whether a build makes a tree of this expected motion softer by default."""
    return expected["default_frequency_hz"] < expected["first_frequency_hz"]


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

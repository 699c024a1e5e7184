"""What a single tree bears in wind: strain of its wood, and the gust that breaks it."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from typing import get_args

from galewood.io.api.expected import expect
from galewood.io.api.trees import Tree
from galewood.motion.wind import PRESETS, Wind, check_direction
from galewood.solid.strain import (
    CriticalOptions,
    CriticalWind,
    GustStrain,
    TreeStrain,
    WindRods,
    critical_wind_of,
    strain_in_gusts,
    strain_in_wind,
    wind_rods,
    with_top_speed,
)
from galewood.table import Foliage
from galewood.wood import Wood, wood_of_species


def strain(
    tree: Tree,
    *,
    wind_m_s: float,
    direction_deg: float = 0.0,
    foliage: Foliage = "leaf",
    wood: Wood | None = None,
) -> TreeStrain:
    """Bending moment, strain and stress along the stem and the boughs of a tree in a steady wind.

    A calculation for sound wood, no substitute for an inspection: not validated for decay, root damage or
    included bark. The moment of the weight in the bent pose is included; gusts that meet the sway of the
    tree bend it further (``gust_strain``).

    Args:
        tree: The tree (``galewood.read``).
        wind_m_s: Speed at the top of the tree, m/s.
        direction_deg: The wind blows towards (cos θ, 0, sin θ).
        foliage: "bare" leaves out the mass and the wind area of the leaves.
        wood: Elastic constants and density; by default those of the tree's species.

    Raises:
        TypeError: Tree, wood or wind are something else.
        ValueError: The speed is negative or not finite, or no branches were found in the wood.
        ArithmeticError: The tree has no equilibrium in this wind.
    """
    if not 0 <= wind_m_s < float("inf"):
        raise ValueError("wind_m_s must be a speed of 0 m/s or more")
    check_direction(direction_deg)
    rods = _rods(tree, wood, foliage)
    return strain_in_wind(rods, wind_m_s, direction_deg)[0]


def gust_strain(
    tree: Tree,
    wind: Wind = PRESETS["autumn-gusts"],
    *,
    wind_m_s: float | None = None,
    seconds: float = 600.0,
    foliage: Foliage = "leaf",
    wood: Wood | None = None,
    on_progress: Callable[[float], None] | None = None,
) -> GustStrain:
    """Bending strain along the stem and the boughs of a tree in gusts, as it sways: a series in time.

    A calculation for sound wood, no substitute for an inspection: not validated for decay, root damage or
    included bark.

    Args:
        tree: The tree (``galewood.read``); it stands at the origin of the wind.
        wind: The gusts: a preset, a document, or a measured wind (``galewood.read_measurement``).
        wind_m_s: Mean speed at the top of the tree, to which the wind is scaled; None: as it is.
        seconds: Length of the series, after 20 s in which the tree swings in.
        foliage: "bare" leaves out the mass and the wind area of the leaves.
        wood: Elastic constants, density and damping; by default those of the tree's species.
        on_progress: Receives the fraction done; whatever it raises ends the calculation.

    Raises:
        TypeError: Tree, wood or wind are something else.
        ValueError: The wind is still or too strong, the time is out of range, or no branches were found in
            the wood.
        ArithmeticError: The tree gives way in a gust.
    """
    expect("wind", wind, Wind)
    rods = _rods(tree, wood, foliage)
    if wind_m_s is not None:
        wind = with_top_speed(wind, rods.height_m, wind_m_s)
    return strain_in_gusts(rods, wind, seconds, on_progress or (lambda share: None))


def critical_wind(
    tree: Tree,
    *,
    foliage: Foliage = "leaf",
    wood: Wood | None = None,
    options: CriticalOptions | None = None,
    on_progress: Callable[[float], None] | None = None,
) -> CriticalWind:
    """The gust speed at which the largest strain of the stem reaches the rupture strain of its green wood.

    A calculation for sound wood, no substitute for an inspection: not validated for decay, root damage or
    included bark. The gust acts as a steady wind. Overturning is assessed only where the options give the
    strength of the roots.

    Args:
        tree: The tree (``galewood.read``).
        foliage: "bare" leaves out the mass and the wind area of the leaves.
        wood: Constants of the wood, with its modulus of rupture; by default those of the tree's species.
        options: Heading, knots, root strength, and how the uncertainty is sampled.
        on_progress: Receives the fraction done after each sample; whatever it raises ends the calculation.

    Raises:
        TypeError: Tree, wood or wind are something else.
        ValueError: No branches were found in the wood.
    """
    rods = _rods(tree, wood, foliage)
    return critical_wind_of(rods, options or CriticalOptions(), on_progress or (lambda share: None))


def _rods(tree: Tree, wood: Wood | None, foliage: Foliage) -> WindRods:
    if foliage not in get_args(Foliage):
        raise ValueError(f"foliage must be one of {', '.join(get_args(Foliage))}, not {foliage!r}")
    expect("tree", tree, Tree)
    if wood is not None:
        expect("wood", wood, Wood)
    wood = wood or wood_of_species(tree.species or "default")
    return wind_rods(tree.mesh, wood, leaves=foliage == "leaf")

"""The risk of every stem of a stand in wind: which breaks first, and how far each one sways."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from galewood.check.stand.forms import MEDIAN_SAMPLE, ScaledTree, TreeForm
from galewood.check.stand.shelter import edge_distances_m, shelter_factor
from galewood.measurements import Inventory, Stem, wood_species_of
from galewood.motion.wind import check_direction
from galewood.solid.strain import CAUTION_TEXT, DIRECTIONS_DEG, QUANTILES, Sample, samples
from galewood.util import Floats
from galewood.wood import wood_of_species

ASSUMPTIONS = (
    "Each stem is a built-in tree of its habit, stretched to its height, thickened to its diameter with its "
    "crown as wide in proportion, and of the wood of its own species where that is known.",
    "Winds are gusts at the top of each tree in the open; they act as steady winds.",
    "Sheltered stems bear a share of the bending moment at the edge: wind-tunnel measurements as used by "
    "ForestGALES (Gardiner, Peltola, Kellomäki 2000). All beyond the inventory is open ground.",
    "Stems break where the largest strain of their stem reaches the rupture strain of sound green wood; "
    "overturning is not assessed.",
)
STREAMLINED_TEXT = (
    "In leaf the load grows only as U^{exponent:.2g} above 5 m/s, because crowns streamline; far above the "
    "winds of measurements this is assumed, and makes trees in leaf seem to bear more than bare ones."
)
MOST_LISTED = 8


@dataclass(frozen=True, kw_only=True)
class StandOptions:
    """What a report is computed for; ValueError if a value is out of range.

    ``wind_m_s``: the gust in which sway, moment and strain are reported. ``direction_deg`` None: the least
    favourable of eight directions for each stem. ``sheltered`` False: every stem stands in the open.
    """

    wind_m_s: float = 20.0
    direction_deg: float | None = None
    sheltered: bool = True
    knot_factor: float = 1.0
    sample_count: int = 100
    seed: int = 1

    def __post_init__(self) -> None:
        if self.direction_deg is not None:
            check_direction(self.direction_deg)
        if not 0 < self.wind_m_s <= 100:
            raise ValueError("wind_m_s must lie above 0 and at most at 100")
        if not 0 < self.knot_factor <= 1:
            raise ValueError("knot_factor must lie above 0 and at most at 1")
        if not 0 <= self.sample_count <= 10_000:
            raise ValueError("sample_count must lie between 0 and 10000")
        if self.seed < 0:
            raise ValueError("seed must be 0 or more")


@dataclass(frozen=True)
class StemRisk:
    """A stem in wind. Critical winds are gusts, m/s; inf: not up to 100 m/s.

    rank 1 breaks first; ``critical_low_m_s`` and ``critical_high_m_s`` are the 10 and 90 % of possible trees.
    """

    rank: int
    index: int
    """Of the stem in the inventory, from 0."""
    line: int
    species: str
    tree: str
    """The built-in tree that stands for it."""
    wood: str
    east_m: float
    north_m: float
    lon_deg: float | None
    """Place as in the inventory; None: it has metres."""
    lat_deg: float | None
    height_m: float
    height_estimated: bool
    """By a curve, from the diameter."""
    dbh_cm: float
    dbh_assumed: bool
    """By the proportions of the tree."""
    rough: bool
    """Less than half or more than twice as high, or as slender, as the tree: its figures are rough."""
    frequency_hz: float
    edge_distance_m: float
    load_share: float
    """Share of the load at the edge that it bears."""
    direction_deg: float
    sway_m: float
    base_moment_knm: float
    strain: float
    critical_m_s: float
    critical_low_m_s: float
    critical_high_m_s: float


@dataclass(frozen=True)
class StandReport:
    """The stems of a stand, the one that breaks first first, and what was assumed."""

    stems: tuple[StemRisk, ...]
    options: StandOptions
    per_ha: float
    mean_height_m: float
    assumptions: tuple[str, ...]

    def document(self) -> dict[str, Any]:
        """All of it, JSON-able; null: not up to 100 m/s."""
        stems = [
            {k: None if isinstance(v, float) and not np.isfinite(v) else v for k, v in asdict(stem).items()}
            for stem in self.stems
        ]
        return {
            "options": asdict(self.options),
            "stems_per_ha": self.per_ha,
            "mean_height_m": self.mean_height_m,
            "stems": stems,
            "assumptions": list(self.assumptions),
            "caution": CAUTION_TEXT,
        }


def stand_report(
    inventory: Inventory, forms: Mapping[str, TreeForm], options: StandOptions | None = None
) -> StandReport:
    """The risk of all stems. ``forms``: the built-in trees by name, "maple" and "maple-forest" and so on."""
    chosen = options or StandOptions()
    stems = inventory.stems
    height_m = float(np.mean([stem.height_m for stem in stems]))
    spacing_m = 100.0 / float(np.sqrt(inventory.report.per_ha))
    place = np.array([(stem.east_m, -stem.north_m) for stem in stems])
    edge, share, direction = _exposed(place, height_m, spacing_m, chosen)
    possible = [
        one._replace(rupture=chosen.knot_factor * one.rupture)
        for one in samples(chosen.sample_count, chosen.seed)
    ]
    found = [
        _risk(
            stem,
            forms[_form_name(stem)],
            float(edge[k]),
            float(share[k]),
            float(direction[k]),
            chosen,
            possible,
        )
        for k, stem in enumerate(stems)
    ]
    order = sorted(range(len(found)), key=lambda k: (found[k].critical_m_s, -found[k].strain))
    ranked = tuple(_placed(found[k], rank, k, inventory) for rank, k in enumerate(order, 1))
    notes = (*_notes(ranked, forms), *inventory.report.notes)
    return StandReport(ranked, chosen, inventory.report.per_ha, height_m, ASSUMPTIONS + notes)


def _placed(stem: StemRisk, rank: int, index: int, inventory: Inventory) -> StemRisk:
    lon_deg, lat_deg = inventory.lon_lat_deg[index] or (None, None)
    return replace(stem, rank=rank, index=index, lon_deg=lon_deg, lat_deg=lat_deg)


def _notes(stems: tuple[StemRisk, ...], forms: Mapping[str, TreeForm]) -> list[str]:
    """What holds for some of the stems only."""
    notes: list[str] = []
    exponent = min(forms[stem.tree].streamlined_exponent for stem in stems)
    if exponent < 2:
        notes.append(STREAMLINED_TEXT.format(exponent=exponent))
    if assumed := sum(stem.dbh_assumed for stem in stems):
        notes.append(f"{assumed} diameters are missing; they have the built-in tree's proportions.")
    if average := sorted({stem.species or "unknown species" for stem in stems if stem.wood == "default"}):
        more = f" and {len(average) - MOST_LISTED} more" if len(average) > MOST_LISTED else ""
        notes.append(f"Average wood for {', '.join(average[:MOST_LISTED])}{more}.")
    if far := sum(stem.rough for stem in stems):
        notes.append(
            f"{far} stems are less than half or more than twice as high, or as slender, as their tree: rough "
            "figures."
        )
    return notes


def _form_name(stem: Stem) -> str:
    """The built-in tree that stands for a stem."""
    return f"{stem.builtin}-forest" if stem.slender else stem.builtin


def _exposed(
    place_m: Floats, height_m: float, spacing_m: float, options: StandOptions
) -> tuple[Floats, Floats, Floats]:
    """(n,) distance from the edge, share of the load there, and direction, where the share is largest."""
    directions = DIRECTIONS_DEG if options.direction_deg is None else (options.direction_deg,)
    edges = np.stack([edge_distances_m(place_m, one, height_m, spacing_m) for one in directions])
    shares = np.stack([shelter_factor(edge, height_m, spacing_m) for edge in edges])
    if not options.sheltered:
        shares[:] = 1.0
    worst, every = np.argmax(shares, axis=0), np.arange(len(place_m))
    return edges[worst, every], shares[worst, every], np.array(directions)[worst]


def _risk(
    stem: Stem,
    form: TreeForm,
    edge_m: float,
    share: float,
    direction_deg: float,
    options: StandOptions,
    possible: list[Sample],
) -> StemRisk:
    dbh_m = form.dbh_m * stem.height_m / form.height_m if stem.dbh_cm is None else stem.dbh_cm / 100
    tree = form.scaled(stem.height_m, dbh_m, wood_of_species(wood_species_of(stem.species)))
    median = MEDIAN_SAMPLE._replace(rupture=options.knot_factor)
    middle = tree.critical_m_s(share, median)
    critical = tree.all_critical_m_s(share, possible or [median])
    low, _, high = np.quantile(critical, QUANTILES, method="nearest")
    return StemRisk(
        rank=0,
        index=0,
        line=stem.line,
        species=stem.species,
        tree=form.name,
        wood=tree.wood.name,
        east_m=stem.east_m,
        north_m=stem.north_m,
        lon_deg=None,
        lat_deg=None,
        height_m=stem.height_m,
        height_estimated=stem.height_estimated,
        dbh_cm=100 * dbh_m,
        dbh_assumed=stem.dbh_cm is None,
        rough=tree.rough,
        frequency_hz=tree.frequency_hz,
        edge_distance_m=edge_m,
        load_share=share,
        direction_deg=direction_deg,
        **_in_wind(tree, options.wind_m_s, share),
        critical_m_s=middle,
        critical_low_m_s=float(low),
        critical_high_m_s=float(high),
    )


def _in_wind(tree: ScaledTree, wind_m_s: float, share: float) -> dict[str, float]:
    return {
        "sway_m": tree.sway_m(wind_m_s, share),
        "base_moment_knm": tree.moment_nm(wind_m_s, share) / 1000,
        "strain": tree.strain_at(wind_m_s, share),
    }

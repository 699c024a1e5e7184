"""Strain and critical wind of measured trees by the rods of `galewood.solid.strain`, beside the measured."""

from __future__ import annotations

from typing import Any

import numpy as np

from galewood.check.field.measurements import Measurement
from galewood.check.field.statistics import agreement, left_out
from galewood.options import BuildRequest
from galewood.solid.strain import CriticalOptions, critical_wind_of, strain_in_wind, wind_rods
from galewood.tree import TreeMesh

DIRECTIONS_DEG = (0.0, 45.0, 90.0, 135.0)
"""Directions over which the strain is averaged: which way the wind blew is not known."""
CRITICAL_NAME = "critical_m_s"


def is_bending(row: Measurement) -> bool:
    """Whether a row has a strain or a critical wind."""
    return bool(row.strains) or row.critical_m_s is not None


def bending_of(row: Measurement, mesh: TreeMesh, options: BuildRequest) -> dict[str, Any]:
    """Measured and modelled values by name. ValueError, ArithmeticError if the tree cannot be bent."""
    rods = wind_rods(mesh, options.wood_of(mesh.species), leaves=row.season == "leaf")
    measured = {strain_name(wind): strain for wind, strain in row.strains}
    modelled: dict[str, float | None] = {}
    for wind, _ in row.strains:
        found = [strain_in_wind(rods, wind, direction)[0] for direction in DIRECTIONS_DEG]
        strains = [one.breast_height_strain for one in found if one.breast_height_strain is not None]
        modelled[strain_name(wind)] = float(np.mean(strains)) if strains else None
    if row.critical_m_s is not None:
        measured[CRITICAL_NAME] = row.critical_m_s
        critical = critical_wind_of(rods, CriticalOptions(sample_count=0))
        modelled |= {
            CRITICAL_NAME: critical.gust_m_s if np.isfinite(critical.gust_m_s) else None,
            "critical_of_square_law_m_s": critical.extrapolated_m_s,
        }
    return {"bending": measured, "model_bending": modelled}


def strain_name(wind_m_s: float) -> str:
    """Name of the strain in a wind."""
    return f"strain_{wind_m_s:g}"


def bending_statistics(trees: list[dict[str, Any]]) -> dict[str, list[dict[str, Any]]]:
    """By measured quantity: agreement of the model, and of a power law of the trees' sizes."""
    found: dict[str, list[dict[str, Any]]] = {}
    for name in sorted({name for tree in trees for name in tree.get("bending", {})}):
        rows = [tree for tree in trees if name in tree.get("bending", {})]
        methods = {
            "model": "model, rupture at the largest strain of the stem"
            if name == CRITICAL_NAME
            else "model, strain at 1.3 m"
        }
        if name == CRITICAL_NAME:
            methods["critical_of_square_law_m_s"] = "model, strain at 1.3 m extrapolated by U²"
        found[name] = []
        for method, title in methods.items():
            key = name if method == "model" else method
            pairs = [(tree["model_bending"].get(key), tree["bending"][name]) for tree in rows]
            found[name].append({"name": title, **_agreement(pairs)})
        found[name].append(
            {"name": "power law of these trees' sizes, each tree left out in turn", **_by_size(rows, name)}
        )
    return found


def _agreement(pairs: list[tuple[float | None, float]]) -> dict[str, Any]:
    both = np.array([pair for pair in pairs if pair[0] is not None], float).reshape(-1, 2)
    return agreement(both[:, 0], both[:, 1])


def _by_size(rows: list[dict[str, Any]], name: str) -> dict[str, Any]:
    sized = [row for row in rows if row["size"] is not None]
    if not sized:
        return _agreement([])
    height, dbh = np.array([row["size"] for row in sized], float).T
    measured = np.array([row["bending"][name] for row in sized], float)
    law = left_out(height, dbh, measured)
    return _agreement([]) if law is None else agreement(law, measured)

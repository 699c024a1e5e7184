"""The pose in which a tree stands still under its weight.

In order of preference: the static equilibrium ("sagged"); the given shape, taken as already bent by the
weight ("loaded"); the same with the limbs stiffened that could not carry their own weight ("supported"). Only
if even that fails is the weight left out ("weightless").
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from galewood.solid.fem import (
    ElementSystem,
    ExcessiveSagError,
    FemModel,
    Modes,
    NotPositiveDefinite,
    RestPose,
    Support,
    gravity_rest_pose,
    loaded_pose,
    natural_modes,
    rest_prestress,
    strain_displacements,
    supporting_factors,
    weightless_pose,
    with_ground_reaction,
)
from galewood.util import Floats, Int32s

MODE_COUNT = 24
REPORTED_MODES = 10


class Limbs(NamedTuple):
    """Limb (m,) and mass of the wood (m,), kg, of each element."""

    limb: Int32s
    mass_kg: Floats


class Resting(NamedTuple):
    """A model in its rest pose, its lowest modes about it, and a report."""

    model: FemModel
    modes: Modes
    report: dict[str, Any]

    def frequencies(self) -> list[float]:
        """The lowest frequencies, Hz."""
        return [float(f) for f in self.modes.frequencies_hz[:REPORTED_MODES]]


def at_rest(model: FemModel, system: ElementSystem, limbs: Limbs) -> Resting:
    """The model in its rest pose under ``gravity_n``; it is given unstrained, with its system."""
    _unload(model, system)
    try:
        return _sagged(model, system)
    except (ExcessiveSagError, NotPositiveDefinite):
        pass
    try:
        return _loaded(model, system, {"kind": "loaded"})
    except NotPositiveDefinite:
        pass
    try:
        return _supported(model, system, limbs)
    except NotPositiveDefinite:
        return _weightless(model, system)


def _sagged(model: FemModel, system: ElementSystem) -> Resting:
    height_m = float(np.ptp(model.nodes_m[:, 1]))
    return _resting(model, system, gravity_rest_pose(system, model.gravity_n, height_m))


def _loaded(model: FemModel, system: ElementSystem, report: dict[str, Any]) -> Resting:
    """In the given shape, with the strain that balances it. Raises NotPositiveDefinite if it falls."""
    u_m = _bearing(model, system)
    loaded = replace(model, strain_m=strain_displacements(model, u_m))
    system.set_strain(_given(loaded))
    pose = RestPose(np.zeros_like(model.u_rest), with_ground_reaction(model, u_m), report)
    return _resting(loaded, system, pose)


def _supported(model: FemModel, system: ElementSystem, limbs: Limbs) -> Resting:
    """In the given shape, with limbs stiffened to carry it. Raises NotPositiveDefinite if it falls."""
    loaded = replace(model, strain_m=strain_displacements(model, _bearing(model, system)))
    support = supporting_factors(system, rest_prestress(loaded), limbs.limb)
    if not support.stands:
        raise NotPositiveDefinite("the tree cannot carry its weight at any stiffness")
    model = replace(model, blocks=model.blocks * support.factor[:, None, None, None])
    system.set_blocks(model.blocks)
    return _loaded(model, system, {"kind": "supported", **_supported_report(support, limbs)})


def _weightless(model: FemModel, system: ElementSystem) -> Resting:
    _unload(model, system)
    system.set_blocks(model.blocks)
    return _resting(model, system, weightless_pose(model.gravity_n))


def _supported_report(support: Support, limbs: Limbs) -> dict[str, Any]:
    held = support.factor > 1
    mass, whole = float(limbs.mass_kg[held].sum()), float(limbs.mass_kg.sum())
    count = len(np.unique(limbs.limb[held]))
    note = (
        f"{'A limb' if count == 1 else f'{count} limbs'} ({mass:.3g} kg of wood, {mass / whole:.0%}) would "
        "buckle under the tree's own weight with the given radii. They are simulated stiffer, by a factor of "
        f"up to {support.factor.max():.3g}, and keep their weight."
    )
    return {
        "load_factor": support.load_factor,
        "supported_limbs": count,
        "supported_wood_kg": mass,
        "supported_share": mass / whole,
        "largest_stiffness_factor": float(support.factor.max()),
        "note": note,
    }


def _bearing(model: FemModel, system: ElementSystem) -> Floats:
    """The small displacement (N,3), m, whose strain balances the weight in the given shape."""
    _unload(model, system)
    return loaded_pose(system, model.gravity_n)


def _unload(model: FemModel, system: ElementSystem) -> None:
    system.set_prestress(np.zeros_like(model.prestress))
    system.set_strain(np.zeros((*model.elements.shape, 3)))


def _given(loaded: FemModel) -> Floats:
    assert loaded.strain_m is not None
    return loaded.strain_m


def _resting(model: FemModel, system: ElementSystem, pose: RestPose) -> Resting:
    model = replace(model, u_rest=pose.u_m, gravity_n=pose.gravity_n)
    model = replace(model, prestress=rest_prestress(model))
    system.set_prestress(model.prestress)
    count = min(MODE_COUNT, 3 * system.free // 2)
    return Resting(model, natural_modes(model, count, system), pose.report)

"""The pose in which a tree stands still under its weight: the given shape, in which it has grown.

Its elements have the strain that balances the weight there. A tree whose load factor is larger than that of
real trees is "supported": its thin parts are lighter or its wood is stiffer than given, by one rule for all
loads (`galewood.solid.fem.support`). Only if that is of no use is the weight left out ("weightless").
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from galewood.solid.fem import (
    ElementSystem,
    FemModel,
    Modes,
    NotPositiveDefinite,
    Support,
    Weight,
    loaded_pose,
    natural_modes,
    rest_prestress,
    strain_displacements,
    supported,
    with_ground_reaction,
)
from galewood.util import Floats, Int32s

MODE_COUNT = 24
REPORTED_MODES = 10
NOTABLE_CHANGE = 0.05
"""Change of a mass or stiffness that is worth a warning; smaller ones are in the report only."""


class Parts(NamedTuple):
    """Limb (m,), 0 the trunk, and mass of the wood (m,), kg, of each element; at the nodes the mass (N,), kg,
    of the thin parts: leaves, twigs and thin limbs.
    """

    limb: Int32s
    wood_kg: Floats
    thin_kg: Floats


class Resting(NamedTuple):
    """A model in its rest pose, its lowest modes about it, and a report."""

    model: FemModel
    modes: Modes
    report: dict[str, Any]

    def frequencies(self) -> list[float]:
        """The lowest frequencies, Hz."""
        return [float(f) for f in self.modes.frequencies_hz[:REPORTED_MODES]]


def at_rest(model: FemModel, system: ElementSystem, parts: Parts) -> Resting:
    """The model in its rest pose under ``gravity_n``; it is given unstrained, with its system."""
    if not model.gravity_n.any():
        return _resting(model, system, {"kind": "loaded", "load_factor": 0.0})
    _unload(model, system)
    try:
        support = supported(system, _weight(model, system, parts), parts.limb)
        if support.stands:
            return _loaded(_changed(model, parts, support), system, _report(parts, support))
    except NotPositiveDefinite:
        pass
    return _weightless(model, system)


def _weight(model: FemModel, system: ElementSystem, parts: Parts) -> Weight:
    """The prestress by the whole weight in the given shape, and by that of the thin parts."""
    thin = model.gravity_n * _share(parts.thin_kg, model.mass_kg)[:, None]
    return Weight(*(rest_prestress(_strained(model, system, n)) for n in (model.gravity_n, thin)))


def _changed(model: FemModel, parts: Parts, support: Support) -> FemModel:
    """The model with the masses and the stiffness with which it stands."""
    kept = 1 - (1 - support.thin_mass) * _share(parts.thin_kg, model.mass_kg)
    return replace(
        model,
        mass_kg=model.mass_kg * kept,
        gravity_n=model.gravity_n * kept[:, None],
        blocks=model.blocks * support.stiffness[:, None, None, None],
    )


def _share(part: Floats, whole: Floats) -> Floats:
    return np.divide(part, whole, out=np.zeros_like(whole), where=whole > 0)


def _loaded(model: FemModel, system: ElementSystem, report: dict[str, Any]) -> Resting:
    """In the given shape, with the strain that balances it. Raises NotPositiveDefinite if it falls."""
    _unload(model, system)
    u_m = loaded_pose(system, model.gravity_n)
    strain_m = strain_displacements(model, u_m)
    system.set_strain(strain_m)
    loaded = replace(model, strain_m=strain_m, gravity_n=with_ground_reaction(model, u_m))
    return _resting(loaded, system, report)


def _strained(model: FemModel, system: ElementSystem, gravity_n: Floats) -> FemModel:
    return replace(model, strain_m=strain_displacements(model, loaded_pose(system, gravity_n)))


def _weightless(model: FemModel, system: ElementSystem) -> Resting:
    _unload(model, system)
    warning = (
        "This tree would buckle under its own weight, so the weight is left out. The tree sways slightly too "
        "fast; with thicker wood or a smaller height it would stand."
    )
    light = replace(model, gravity_n=np.zeros_like(model.gravity_n))
    return _resting(light, system, {"kind": "weightless", "warning": warning})


def _unload(model: FemModel, system: ElementSystem) -> None:
    system.set_prestress(np.zeros_like(model.prestress))
    system.set_strain(np.zeros((*model.elements.shape, 3)))
    system.set_blocks(model.blocks)


def _resting(model: FemModel, system: ElementSystem, report: dict[str, Any]) -> Resting:
    model = replace(model, prestress=rest_prestress(model))
    system.set_prestress(model.prestress)
    count = min(MODE_COUNT, 3 * system.free // 2)
    return Resting(model, natural_modes(model, count, system), report)


def _report(parts: Parts, support: Support) -> dict[str, Any]:
    given = {"load_factor": support.load_factor, "borne_load_factor": support.borne_load_factor}
    own = support.stiffness / support.whole
    if support.thin_mass == 1 and support.stiffness.max() == 1:
        return {"kind": "loaded", **given}
    held = own > 1 + NOTABLE_CHANGE
    found = {
        "kind": "supported",
        **given,
        "thin_mass_kg": float(parts.thin_kg.sum()),
        "thin_mass_factor": support.thin_mass,
        "stiffness_factor": support.whole,
        "supported_limbs": len(np.unique(parts.limb[held])),
        "supported_wood_kg": float(parts.wood_kg[held].sum()),
        "largest_limb_factor": float(own.max()),
    }
    warning = _warning(found, float(parts.wood_kg.sum()))
    return found | ({"warning": warning} if warning else {})


def _warning(found: dict[str, Any], wood_kg: float) -> str:
    """What was changed noticeably, in words; empty: nothing."""
    changes: list[str] = []
    if found["thin_mass_factor"] < 1 - NOTABLE_CHANGE:
        changes.append(
            f"leaves, twigs and thin limbs ({found['thin_mass_kg']:.3g} kg) are simulated with "
            f"{found['thin_mass_factor']:.2f} of their mass"
        )
    if found["stiffness_factor"] > 1 + NOTABLE_CHANGE:
        changes.append(f"all wood is simulated {found['stiffness_factor']:.2f} times as stiff")
    if count := found["supported_limbs"]:
        limbs = "one limb is" if count == 1 else f"{count} limbs are"
        changes.append(
            f"{limbs} ({found['supported_wood_kg'] / wood_kg:.0%} of the wood) simulated stiffer, by up to "
            f"{found['largest_limb_factor']:.3g} times"
        )
    if not changes:
        return ""
    return (
        f"The tree, or a limb of it, bears {found['load_factor']:.0%} of its buckling load; few real "
        f"trees bear more than a third. So {'; '.join(changes)}. Check radii, height and leaves."
    )

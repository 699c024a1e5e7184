"""How a tree bears its weight: one rule for every load, without a jump.

Under its weight a tree has the tangent K + K_σ. In the shape in which it gives way at a load factor ν (weight
over buckling load, `buckling.py`) it keeps the share 1 − ν of its stiffness, and its frequency is √(1 − ν) of
the weightless one. Real trees keep most of it: their heights are about a quarter of that at which they would
buckle (McMahon, Science 179, 1973), and ν grows with the third power of that ratio. A slender forest tree at
0.7 of its buckling height has ν = 1/3. A larger load factor is therefore taken as an error of the data, and
the share that remains bends smoothly from 1 − ν towards a limit (`remaining_share`).

The load factor borne follows from that share. It is reached through what is least certain first: whole trees
by a smaller mass of leaves, twigs and thin limbs, down to a quarter, then by stiffer wood; single limbs by
their stiffness, since it grows with the fourth power of a radius that was drawn or scanned.
"""

from typing import NamedTuple

import numpy as np
from scipy.sparse import csc_matrix

from galewood.solid.fem.buckling import Buckling, buckling, element_energies, geometric_stiffness
from galewood.solid.fem.elements.assembly import ElementSystem
from galewood.util import Array, Floats, Int32s, Ints

SAFE_LOAD_FACTOR = 1 / 3
"""Up to this load factor nothing is changed."""
LARGEST_LOSS = 0.45
"""Largest share of its stiffness that a tree loses to its weight: √0.55 of the frequency remain at least."""
LEAST_THIN_MASS = 0.25
"""Smallest factor of the mass of thin parts. Of felled and weighed trees, cylinder models gave the branches
3.4 times their mass (docs/how-to/scanned-trees.md)."""
LIMB_ENERGY_SHARE = 0.8
"""Share of a mode's elastic energy in the limbs that hold it."""
SHARE_TOLERANCE, LOAD_TOLERANCE = 0.05, 1e-4
"""Relative, of the share that a limb keeps, and of the load factor that a tree bears."""
MAX_ROUNDS = 30
MAX_STIFFENING_FACTOR = 1e4
"""Largest factor; a limb that needs more is damaged input."""
TRUNK_LIMB = 0


class Weight(NamedTuple):
    """Prestress (m,10), N/m, of the given shape by all weight, and the part of it by the thin parts."""

    whole: Floats
    thin: Floats


class Support(NamedTuple):
    """What lets the tree stand: factors of the mass of its thin parts and of the stiffness (m,) of its wood.

    ``whole`` is the part of the stiffness factor that all wood has. Load factors are weight over buckling
    load as given, and as borne.
    """

    thin_mass: float
    whole: float
    stiffness: Floats
    load_factor: float
    borne_load_factor: float
    stands: bool


def remaining_share(load_factor: float) -> float:
    """Share of its stiffness that a tree keeps under its weight: 1 − ν, above a third bent towards 0.55.

    Two derivatives are continuous.
    """
    above = max(load_factor - SAFE_LOAD_FACTOR, 0.0)
    room = LARGEST_LOSS - SAFE_LOAD_FACTOR
    loss = min(load_factor, SAFE_LOAD_FACTOR) + above / np.sqrt(1 + (above / room) ** 2)
    return float(1 - loss)


def borne_load_factor(load_factor: float) -> float:
    """The load factor at which a tree stiffened from the given one keeps `remaining_share`.

    With s times the stiffness K, s K + K_σ leaves (s − ν) K: s = ν + share, and the load factor is ν / s.
    """
    return load_factor / max(load_factor + remaining_share(load_factor), 1e-300)


def holding_limbs(energy_j: Floats, limb: Array) -> Ints:
    """The fewest limbs that hold most of a shape's energy_j (m,); ``limb`` (m,) is the limb of each part."""
    of_limb: Floats = np.bincount(limb, energy_j).astype(np.float64)
    most = np.argsort(-of_limb)
    before = np.concatenate([[0.0], np.cumsum(of_limb[most])[:-1]]) / max(float(of_limb.sum()), 1e-300)
    return most[before < LIMB_ENERGY_SHARE]


def supported(system: ElementSystem, weight: Weight, limb: Int32s) -> Support:
    """How the tree bears its weight; limb (m,) of each element, 0 is the trunk.

    The forces of the prestress do not depend on the stiffness. The blocks and the prestress of the system
    are changed.
    """
    return _Bearing(system, weight, limb).support()


class _Bearing:
    def __init__(self, system: ElementSystem, weight: Weight, limb: Int32s) -> None:
        self.system, self.limb = system, limb
        self.whole = geometric_stiffness(system, weight.whole)
        self.thin = geometric_stiffness(system, weight.thin) if weight.thin.any() else None
        self.blocks = system.blocks.reshape(-1, 10, 3, 3).copy()
        self.factor = np.ones(len(limb))

    def support(self) -> Support:
        first = self._modes(1.0)
        given = float(first.load[0])
        if given <= SAFE_LOAD_FACTOR:
            return Support(1.0, 1.0, self.factor, given, given, True)
        modes = self._with_stiff_limbs(first)
        load = self._of_the_tree(modes)
        borne = borne_load_factor(load)
        thin_mass, whole = self._thin_mass(load, borne), 1.0
        limbs = self.factor.copy()
        if thin_mass < 1:
            modes = self._modes(thin_mass)
        for _ in range(MAX_ROUNDS):  # one is enough, unless the tree stands on a root plate that yields
            excess = self._of_the_tree(modes) / borne if borne else 0.0
            if excess <= 1 + 2 * LOAD_TOLERANCE:
                break
            whole *= excess
            self.factor = limbs * whole
            modes = self._modes(thin_mass)
        now = float(modes.load[0])
        stands = now < 1 and self.factor.max() <= MAX_STIFFENING_FACTOR
        return Support(thin_mass, whole, self.factor, given, now, stands)

    def _with_stiff_limbs(self, modes: Buckling) -> Buckling:
        """Stiffens the limbs that give way by themselves, and gives the modes of the tree with them."""
        for _ in range(MAX_ROUNDS):
            raised = np.ones(int(self.limb.max()) + 1)
            for load, shape in zip(modes.load, modes.shapes, strict=True):
                holding = self._holding(shape)
                if TRUNK_LIMB in holding:
                    continue
                raised[holding] = np.maximum(raised[holding], self._lacking(load, shape))
            if raised.max() == 1:
                return modes
            self.factor = np.minimum(self.factor * raised[self.limb], 2 * MAX_STIFFENING_FACTOR)
            modes = self._modes(1.0)
        return modes

    def _lacking(self, load: float, shape: Floats) -> float:
        """Factor of the present stiffness with which a shape keeps its share, at least 1."""
        energy = element_energies(self.system, shape)
        present = float(energy.sum() / (energy / self.factor).sum())
        given = load * present
        share = remaining_share(given)
        enough = present * (1 - load) >= share * (1 - SHARE_TOLERANCE) and present > 1
        return 1.0 if enough else max((given + share) / present, 1.0)

    def _of_the_tree(self, modes: Buckling) -> float:
        """The largest load factor of the shapes that the trunk takes part in; 0: there is none."""
        for load, shape in zip(modes.load, modes.shapes, strict=True):
            if TRUNK_LIMB in self._holding(shape):
                return float(load)
        return 0.0

    def _thin_mass(self, load: float, borne: float) -> float:
        """Factor of the mass of thin parts with which the tree bears a load factor, or the smallest."""
        if self.thin is None or load - borne <= LOAD_TOLERANCE * load:
            return 1.0
        low, high = LEAST_THIN_MASS, 1.0
        below, above = self._of_the_tree(self._modes(low)) - borne, load - borne
        if below >= 0:
            return low
        for _ in range(MAX_ROUNDS):
            middle = high - above * (high - low) / (above - below)
            excess = self._of_the_tree(self._modes(middle)) - borne
            if abs(excess) <= LOAD_TOLERANCE * borne:
                return middle
            low, below, high, above = (
                (low, below, middle, excess) if excess > 0 else (middle, excess, high, above)
            )
        return low

    def _holding(self, shape: Floats) -> Ints:
        """The limbs that hold a shape (N,3)."""
        return holding_limbs(element_energies(self.system, shape), self.limb)

    def _modes(self, thin_mass: float) -> Buckling:
        self.system.set_blocks(self.blocks * self.factor[:, None, None, None])
        geometric: csc_matrix = self.whole
        if self.thin is not None and thin_mass < 1:
            geometric = csc_matrix(self.whole - (1 - thin_mass) * self.thin)
        return buckling(self.system, geometric)

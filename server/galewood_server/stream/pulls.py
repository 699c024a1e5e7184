"""The pulled trees of each table of a forest. Loads compiled kernels; who pulls is in ``forest_hands``."""

from __future__ import annotations

import logging
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np
from galewood.constants import PULL_EASE_S, PULL_SAME_PLACE_M
from galewood.player import DragConstraint, PullError, WindDrivenTrees, point_response
from galewood.table import Compliance, Table

from galewood_server.stream.forest_hands import ZERO_FORCE
from galewood_server.stream.wire import Pull, Pulling, Trees, Vector

log = logging.getLogger("galewood.stream")


@dataclass
class _Held:
    tree: int
    pull: Pull
    constraint: DragConstraint
    left_s: float = PULL_EASE_S
    """Time in which a tree without oscillators still eases back, s."""


class GroupPulls:
    """The pulled trees of one table. Used by the step only."""

    def __init__(self, table: Table, trees: Trees, compliance: Compliance | None) -> None:
        """trees (n, 4): x (m), z (m), yaw (rad), scale."""
        self._table, self._trees, self._compliance = table, trees, compliance
        self._held: dict[int, _Held] = {}
        self._easing: list[_Held] = []

    def step(self, forest: WindDrivenTrees, pulls: Iterable[Pull], dt_s: float) -> None:
        """Follow the pulls on trees of this table; call after the trees have been stepped.

        Adds to the poses of held trees, and to the state of those released since the last call.
        """
        wanted = {pull.hand: pull for pull in pulls}
        for hand in [hand for hand in self._held if not self._continues(hand, wanted)]:
            self._release(forest, self._held.pop(hand))
        for pull in wanted.values():
            if pull.hand not in self._held:
                self._begin(pull)
        swayed = {held.tree: forest.q[held.tree].astype(np.float64) for held in self._held.values()}
        for held in self._held.values():
            held.pull = wanted[held.pull.hand]
            held.constraint.step(
                dt_s, np.array(held.pull.target), held.constraint.response.point @ swayed[held.tree]
            )
            forest.q[held.tree] += held.constraint.pose
        self._ease(forest, dt_s)

    def _release(self, forest: WindDrivenTrees, held: _Held) -> None:
        if forest.displace(held.tree, *held.constraint.released()):
            forest.q[held.tree] += held.constraint.pose
        else:
            self._easing.append(held)

    def _ease(self, forest: WindDrivenTrees, dt_s: float) -> None:
        for held in self._easing:
            held.left_s -= dt_s
            share = max(held.left_s, 0.0) / PULL_EASE_S
            forest.q[held.tree] += share * share * (3.0 - 2.0 * share) * held.constraint.pose
        self._easing = [held for held in self._easing if held.left_s > 0.0]

    @property
    def forces(self) -> dict[int, Vector]:
        """Hand → force, N, in the tree's frame at scale 1."""
        return {hand: _vector(held.constraint) for hand, held in self._held.items()}

    def _continues(self, hand: int, wanted: dict[int, Pull]) -> bool:
        old, new = self._held[hand].pull, wanted.get(hand)
        return new is not None and (old.x, old.z, old.vertex) == (new.x, new.z, new.vertex)

    def _begin(self, pull: Pull) -> None:
        tree = self._tree_at(pull.x, pull.z)
        if tree is None:
            return
        try:
            response = point_response(self._table, pull.vertex, self._compliance)
        except PullError as error:
            log.debug("ignored a pull: %s", error)  # at every tick, as long as it is held
            return
        self._held[pull.hand] = _Held(tree, pull, DragConstraint(response))

    def _tree_at(self, x_m: float, z_m: float) -> int | None:
        if len(self._trees) == 0:
            return None
        gap = np.hypot(self._trees[:, 0] - x_m, self._trees[:, 1] - z_m)
        nearest = int(np.argmin(gap))
        return nearest if gap[nearest] <= PULL_SAME_PLACE_M else None


def pullings(pulls: Iterable[Pull], groups: Iterable[GroupPulls]) -> tuple[Pulling, ...]:
    """The pulls with their forces; a pull on a tree that is not simulated here has none."""
    forces: dict[int, Vector] = {}
    for group in groups:
        forces |= group.forces
    return tuple(Pulling(pull, forces.get(pull.hand, ZERO_FORCE)) for pull in pulls)


def _vector(constraint: DragConstraint) -> Vector:
    x, y, z = constraint.force_n.tolist()
    return x, y, z

"""A tree as rods under its weight and the wind, from the beams along its branches.

The beams are those of the first table (`galewood.solid.model.beam_model`), with the same masses and wind
areas as the finite elements; no wood is meshed.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import breadth_first_order
from scipy.spatial import KDTree

from galewood.motion.wind import dynamic_pressure
from galewood.solid.beams import JOINT_STIFFNESS_FACTOR, Frame, Rods
from galewood.solid.model import GRAVITY_M_S2, loaded_beams
from galewood.solid.skeleton import CLAMPED_SHARE, longest_branches
from galewood.solid.strain.standing import standing_rods
from galewood.tree import TreeMesh
from galewood.util import Floats, Int64s, Ints
from galewood.wood import Wood

PLACES_PER_ROD = 5
"""Points along a rod at which it may cover another one."""


@dataclass(frozen=True)
class WindRods:
    """The rods of a tree with what wind and weight do to them; entry i of an array is point i, or rod i.

    points_m (n, 3) in the given shape; radius_m (n,) of the rods; branch (n,), 0 the stem, which reaches
    farthest from the root; inside (n,): rods inside another limb, where a fork is one piece of wood. Of the
    wind areas (n,), m², drag coefficient and
    height profile included, and of the weights in ``rods``, those of the leaves are listed apart;
    ``exposed_area_m2`` and ``wind_profile`` (n,) are for the drag on moving points (`galewood.solid.fem`).
    ``load_factor`` is the weight over the buckling load, as given; ``weight_share`` the share of the weight
    that then acts (`standing.py`).
    """

    rods: Rods
    points_m: Floats
    radius_m: Floats
    branch: Ints
    inside: NDArray[np.bool_]
    drag_area_m2: Floats
    leaf_area_m2: Floats
    leaf_weight_n: Floats
    exposed_area_m2: Floats
    wind_profile: Floats
    streamlined_exponent: float
    wood: Wood
    load_factor: float
    weight_share: float

    @property
    def height_m(self) -> float:
        """Height of the tree, m."""
        return float(np.ptp(self.points_m[:, 1]))

    @property
    def section_m(self) -> Floats:
        """(n, 3) middle of each rod in the given shape."""
        return (self.points_m + self.points_m[np.maximum(self.rods.parent, 0)]) / 2

    def wind_load_n(self, wind_m_s: float, direction_deg: float) -> Floats:
        """(n, 3) forces of a steady wind on the points, N.

        The speed is that at the top of the tree; the wind blows towards (cos θ, 0, sin θ).
        """
        direction = np.deg2rad(direction_deg)
        toward = np.array([np.cos(direction), 0.0, np.sin(direction)])
        pressure_pa = float(dynamic_pressure(wind_m_s, self.streamlined_exponent))
        return pressure_pa * self.drag_area_m2[:, None] * toward


def wind_rods(tree: TreeMesh, wood: Wood, *, leaves: bool = True) -> WindRods:
    """The rods of a tree in leaf or bare. Raises ValueError if the surface has no branches."""
    loaded = loaded_beams(tree, wood, leaves)
    frame, crown = loaded.frame, loaded.crown
    order, parent, link = _rooted(frame)
    points = frame.points_m[order]
    radius = np.concatenate([frame.radius_m[link[:1]], frame.radius_m[link]])
    inside = np.concatenate([[True], frame.hidden[link]])
    branch = longest_branches(points, parent)
    inside |= _covered(points, parent, radius, branch)
    second_moment = np.pi / 4 * np.maximum(radius, frame.stiff_radius_m) ** 4
    second_moment *= np.where(inside, JOINT_STIFFNESS_FACTOR, 1.0)
    along = points - points[np.maximum(parent, 0)]
    rods = Rods(
        parent,
        along,
        wood.young_longitudinal_pa * second_moment,
        2 * wood.shear_longitudinal_pa * second_moment,
        _clamped(points, parent),
        GRAVITY_M_S2 * loaded.mass_kg[order],
    )
    standing = standing_rods(rods, branch)
    bare = loaded_beams(tree, wood, leaves=False).crown if leaves else crown
    leaf_weight = GRAVITY_M_S2 * crown.leaf_mass_kg[order] * standing.weight_share
    return WindRods(
        standing.rods,
        points,
        radius,
        branch,
        inside,
        crown.drag_area_m2[order],
        (crown.drag_area_m2 - bare.drag_area_m2)[order],
        leaf_weight,
        crown.exposed_area_m2[order],
        crown.wind_profile[order],
        crown.streamlined_exponent,
        wood,
        standing.load_factor,
        standing.weight_share,
    )


def _rooted(frame: Frame) -> tuple[Ints, Int64s, Ints]:
    """Points of a frame with parents first: their order (n,), parent (n,), and the link (n − 1,) to it."""
    ends, count = frame.links, len(frame.points_m)
    graph = csr_matrix((np.ones(len(ends)), ends.T), shape=(count, count))
    root = int(np.argmin(frame.points_m[:, 1]))
    order, before = breadth_first_order(graph, root, directed=False)
    rank = np.full(count, -1, np.int64)
    rank[order] = np.arange(len(order))
    parent = np.full(len(order), -1, np.int64)
    parent[1:] = rank[before[order[1:]]]
    link = np.zeros(count, np.int64)
    link[rank[ends].max(axis=1)] = np.arange(len(ends))
    return order, parent, link[1 : len(order)]


def _clamped(points: Floats, parent: Int64s) -> Int64s:
    """(n,) 1 for the points that the ground holds: the lowest ones that are connected with the root."""
    low = points[:, 1] <= points[0, 1] + CLAMPED_SHARE * float(np.ptp(points[:, 1]))
    clamped = np.zeros(len(parent), np.int64)
    clamped[0] = 1
    for i in range(1, len(parent)):
        clamped[i] = clamped[parent[i]] and low[i]
    return clamped


def _covered(points: Floats, parent: Int64s, radius: Floats, branch: Ints) -> NDArray[np.bool_]:
    """(n,) whether a rod lies inside a thicker limb that grows from its own, or that it grows from.

    A level set through a fork cuts both limbs where they are still one piece of wood.
    """
    start = points[np.maximum(parent, 0)]
    share = (np.arange(PLACES_PER_ROD) + 0.5)[:, None, None] / PLACES_PER_ROD
    places = (start + share * (points - start))[:, 1:].reshape(-1, 3)
    owner = np.tile(np.arange(1, len(points)), PLACES_PER_ROD)
    grows_from = np.full(int(branch.max()) + 1, -1)
    first = np.flatnonzero(branch != branch[np.maximum(parent, 0)])
    grows_from[branch[first]] = branch[parent[first]]
    middles = (points + start) / 2
    near = KDTree(places).query_ball_point(middles, float(radius.max()))
    found = np.zeros(len(points), bool)
    for i in range(1, len(points)):
        at = np.asarray(near[i], np.int64)
        other = owner[at]
        kin = (grows_from[branch[other]] == branch[i]) | (branch[other] == grows_from[branch[i]])
        within = np.linalg.norm(places[at] - middles[i], axis=1) < radius[other]
        found[i] = bool((kin & within & (radius[other] > radius[i])).any())
    return found


def with_leaves_times(rods: WindRods, factor: float) -> WindRods:
    """The same tree with this many times as many leaves: their wind area and weight."""
    area = np.maximum(rods.drag_area_m2 + (factor - 1) * rods.leaf_area_m2, 0.0)
    weight = rods.rods.weight_n + (factor - 1) * rods.leaf_weight_n
    return replace(rods, drag_area_m2=area, rods=replace(rods.rods, weight_n=weight))

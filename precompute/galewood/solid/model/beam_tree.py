"""The model of the first second: a tree as beams along its branches, before its wood is meshed.

Everything that a table of natural modes needs comes from the surface of the wood: branches and radii from its
level sets, modes from a frame of beams, foliage and wind load on the nearest beam.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from scipy.sparse import csr_matrix, vstack
from scipy.sparse.csgraph import breadth_first_order
from scipy.spatial import KDTree

from galewood.motion.wind import dynamic_pressure
from galewood.solid.beams import Frame, FrameModes, frame_modes, joined_frame
from galewood.solid.fem import LEAST_PROFILE, remaining_share
from galewood.solid.model.construction import GRAVITY_M_S2, STIFFNESS_FLOOR
from galewood.solid.model.foliage import CrownLoads, crown_loads
from galewood.solid.skeleton import (
    CLAMPED_SHARE,
    Outline,
    branch_lines,
    is_chained,
    joined_outline,
    outline_of,
)
from galewood.solid.skinning import LARGEST_RIGID_PIECE, Axis, axis_of_frame, leading_vertices
from galewood.solid.tets import MIN_RADIUS_SHARE
from galewood.tree import RenderPrimitive, TreeMesh
from galewood.util import Floats, Ints
from galewood.wood import Wood

MODE_COUNT = 80
PLACES_PER_BEAM = 4
"""Points along a beam among which the nearest to a vertex is sought."""
FACTOR_ROUNDS = 40
ARM_SHARE = 0.02
"""Distance of the three particles around a point of the frame, relative to the height of the tree."""


@dataclass(frozen=True)
class BeamModel:
    """Natural modes of a tree of beams, at particles.

    ``weightless_hz`` (k,) are the frequencies without gravity; the weight takes the share ``load_factors``
    (k,) of the stiffness of each mode.

    Each point of the frame is four particles: itself, and one beside it along each axis, so that particles
    hold its rotation. The shapes (k, 4n, 3) are mass-normalised, 1/√kg; load (k, 2) is the modal force per
    Pa of wind along x and z. ``embedding`` (v, 4n) moves the render vertices with the particles. The next
    three (4n,) are the drag area without shelter, m², the share of it in shelter, and the wind profile;
    ``place_m`` (4n, 3) is where the points rest. The wind's pressure grows with the power
    ``streamlined_exponent`` of its speed above 5 m/s. What is drawn follows the ``axis``.
    """

    weightless_hz: Floats
    load_factors: Floats
    shapes: Floats
    mass_kg: Floats
    load: Floats
    embedding: csr_matrix
    beams: int
    exposed_area_m2: Floats
    sheltered_share: Floats
    wind_profile: Floats
    place_m: Floats
    streamlined_exponent: float
    axis: Axis
    chained: bool
    """Whether limbs are drawn as many overlapping surfaces, whose joints may be weaker than they look."""

    @property
    def frequencies_hz(self) -> Floats:
        """The frequencies (k,) under the weight of the tree, Hz."""
        return self.frequencies_with(1.0)

    def frequencies_with(self, stiffness_factor: float) -> Floats:
        """The frequencies (k,) under its weight, if its wood were this many times as stiff, Hz."""
        share = np.array([remaining_share(one / stiffness_factor) for one in self.load_factors])
        return self.weightless_hz * np.sqrt(stiffness_factor * share)

    def factor_for(self, first_hz: float) -> float:
        """The factor of the stiffness of the wood with which the lowest frequency is this one."""
        factor = (first_hz / float(self.weightless_hz[0])) ** 2
        for _ in range(FACTOR_ROUNDS):
            factor *= (first_hz / float(self.frequencies_with(factor).min())) ** 2
        return factor

    def steady_sway_m(self, wind_m_s: float) -> float:
        """Largest displacement in a steady wind along x or z, m, for a linear response."""
        return self.sway_m(float(dynamic_pressure(wind_m_s, self.streamlined_exponent)))

    def sway_m(self, pressure_pa: float) -> float:
        """Largest displacement under a steady pressure along x or z, m: linear, without weight."""
        still = self.load / (2 * np.pi * self.weightless_hz[:, None]) ** 2
        bent = pressure_pa * np.einsum("kd,kni->dni", still, self.shapes)
        return float(np.linalg.norm(bent, axis=2).max())


@dataclass(frozen=True)
class _NearestBeams:
    """Points of the frame nearest to some vertices: beam (v,), share (v,) along it, distance_m (v,)."""

    beam: Ints
    share: Floats
    distance_m: Floats


_latest: list[tuple[TreeMesh, Wood, bool, BeamModel]] = []
"""The model that was made last: what an import says of the motion, and its first table, take the same one."""


def beam_model(tree: TreeMesh, wood: Wood, leaves: bool = True) -> BeamModel:
    """The beam model of a tree. Raises ValueError if the surface has no branches.

    Without ``leaves`` they still move, but have neither mass nor wind load.
    """
    for latest, *of, model in _latest:
        if latest is tree and of == [wood, leaves]:
            return model
    model = _beam_model(tree, wood, leaves)
    _latest[:] = [(tree, wood, leaves, model)]
    return model


@dataclass(frozen=True)
class LoadedBeams:
    """The beams along a tree's branches, and what hangs on their points: mass and wind area.

    ``mass_kg`` (n,) is all mass at the points of the frame. ``nearest`` are the beams nearest to the vertices
    of each primitive.
    """

    frame: Frame
    crown: CrownLoads
    mass_kg: Floats
    nearest: list[_NearestBeams]
    chained: bool


def loaded_beams(tree: TreeMesh, wood: Wood, leaves: bool = True) -> LoadedBeams:
    """The beams of a tree under its leaves and twigs. Raises ValueError if the surface has no branches."""
    chained = is_chained(tree.wood_vertices_m, tree.wood_faces)
    outline = (joined_outline if chained else outline_of)(tree.wood_vertices_m, tree.wood_faces)
    frame = replace(frame_of(outline), stiff_radius_m=_stiff_radius_m(tree.wood_vertices_m))
    beams = [_nearest_beams(primitive.positions_m, frame) for primitive in tree.primitives]
    of = {id(primitive): own for primitive, own in zip(tree.primitives, beams, strict=True)}

    def spread(primitive: RenderPrimitive, amount: Floats) -> Floats:
        nearest = of[id(primitive)]
        ends = frame.links[nearest.beam]
        shares = np.column_stack([1 - nearest.share, nearest.share]) * amount[:, None]
        return np.bincount(ends.ravel(), shares.ravel(), len(frame.points_m)).astype(np.float64)

    wood_mass = frame.volume_m3() * wood.density_kg_m3
    crown = crown_loads(tree, wood, frame.points_m[:, 1], spread, wood_mass, leaves, outline)
    return LoadedBeams(frame, crown, _point_mass(frame, wood) + crown.mass_kg, beams, chained)


def _beam_model(tree: TreeMesh, wood: Wood, leaves: bool) -> BeamModel:
    loaded = loaded_beams(tree, wood, leaves)
    frame, crown = loaded.frame, loaded.crown
    clamped_m = CLAMPED_SHARE * float(np.ptp(frame.points_m[:, 1]))
    free = 6 * int((frame.points_m[:, 1] > clamped_m).sum())
    modes = frame_modes(frame, wood, clamped_m, min(MODE_COUNT, free // 2), crown.mass_kg)
    if not (np.isfinite(modes.frequencies_hz).all() and (modes.frequencies_hz > 0).all()):
        raise ValueError("the beams along the branches have no usable frequencies")
    arm_m = ARM_SHARE * tree.height_m
    return BeamModel(
        modes.frequencies_hz,
        load_factors(frame, modes, loaded.mass_kg),
        _at_particles(modes.shapes, arm_m),
        _on_points(loaded.mass_kg),
        np.einsum("kni,n->ki", modes.shapes[:, :, [0, 2]], crown.drag_area_m2),
        _embedding(tree, frame, loaded.nearest, arm_m),
        len(frame.links),
        _on_points(crown.exposed_area_m2),
        np.repeat(crown.drag_area_m2 / np.maximum(crown.exposed_area_m2, 1e-12), 4),
        np.repeat(np.maximum(crown.wind_profile, LEAST_PROFILE), 4),
        np.repeat(frame.points_m, 4, axis=0),
        crown.streamlined_exponent,
        axis_of_frame(frame, arm_m),
        loaded.chained,
    )


def _on_points(values: Floats) -> Floats:
    """(4n,) values (n,) of the points on the first of their four particles, zero on the others."""
    return np.repeat(values, 4) * np.tile([1.0, 0.0, 0.0, 0.0], len(values))


def _stiff_radius_m(vertices_m: Floats) -> float:
    """Radius of the softest tetrahedra that the mesh of this wood will have: beams agree with them."""
    return STIFFNESS_FLOOR * MIN_RADIUS_SHARE * float(np.linalg.norm(np.ptp(vertices_m, axis=0)))


def frame_of(branches: Outline) -> Frame:
    """The frame of a tree's branches; each begins on the axis of its parent limb."""
    lines: list[Ints] = []
    for line in branch_lines(branches.branch):
        base = int(branches.parent[line[0]])
        lines.append(line if base < 0 else np.concatenate([[base], line]))
    lines.sort(key=lambda line: int(line[-1] if len(line) == 1 else line[1]))
    index = np.concatenate(lines)
    owner = np.concatenate([np.full(len(line), branches.branch[line[-1]]) for line in lines])
    starts = np.cumsum([0, *(len(line) for line in lines[:-1])])
    parent = np.arange(-1, len(index) - 1)
    parent[starts[1:]] = [np.flatnonzero(index == line[0])[0] for line in lines[1:]]
    radius = branches.radius_m[index]
    radius[starts[1:]] = radius[starts[1:] + 1]  # a branch is not as thick as its parent limb
    return joined_frame(branches.points_m[index], radius, parent, owner)


def load_factors(frame: Frame, modes: FrameModes, mass_kg: Floats) -> Floats:
    """Share (k,) of the stiffness of each mode that the weight of the points takes, 0 or more.

    A beam that carries the weight W at its end, pressed by N = W cos θ along its axis, does the work
    N |Δu|² / L over its transverse displacement Δu; hanging beams are pulled and gain stiffness.
    """
    ends, sizes = frame.links, len(frame.points_m)
    graph = csr_matrix((np.ones(len(ends)), ends.T), shape=(sizes, sizes))
    order, parent = breadth_first_order(graph, int(np.argmin(frame.points_m[:, 1])), directed=False)
    carried_kg = mass_kg.copy()
    for point in order[:0:-1]:
        carried_kg[parent[point]] += carried_kg[point]
    outer = order[1:]
    inner = parent[outer]
    along = frame.points_m[outer] - frame.points_m[inner]
    length_m = np.maximum(np.linalg.norm(along, axis=1), 1e-9)
    axis = along / length_m[:, None]
    pressed_n = GRAVITY_M_S2 * carried_kg[outer] * axis[:, 1]
    moved = modes.shapes[:, outer, :3] - modes.shapes[:, inner, :3]
    across = (moved**2).sum(axis=2) - np.einsum("kli,li->kl", moved, axis) ** 2
    work = across @ (pressed_n / length_m)
    return np.maximum(work / (2 * np.pi * modes.frequencies_hz) ** 2, 0.0)


def _at_particles(shapes: Floats, arm_m: float) -> Floats:
    """(k, 4n, 3) motion of the particles from displacement and rotation (k, n, 6) of the points."""
    moved, turned = shapes[..., :3], shapes[..., 3:]
    beside = [moved + arm_m * np.cross(turned, axis) for axis in np.eye(3)]
    return np.stack([moved, *beside], axis=2).reshape(len(shapes), -1, 3)


def _point_mass(frame: Frame, wood: Wood) -> Floats:
    """(n,) half the mass of the beams at each point."""
    mass = np.pi * frame.radius_m**2 * frame.length_m * wood.density_kg_m3 * ~frame.hidden
    return np.bincount(frame.links.ravel(), np.repeat(mass / 2, 2), len(frame.points_m)).astype(np.float64)


def _nearest_beams(vertices_m: Floats, frame: Frame) -> _NearestBeams:
    share = (np.arange(PLACES_PER_BEAM) + 0.5) / PLACES_PER_BEAM
    start, along = frame.points_m[frame.links[:, 0]], np.diff(frame.points_m[frame.links], axis=1)[:, 0]
    places = start[:, None] + share[:, None] * along[:, None]
    _, nearest = KDTree(places.reshape(-1, 3)).query(vertices_m)
    beam = np.asarray(nearest, np.int64) // PLACES_PER_BEAM
    offset = vertices_m - start[beam]
    squared = np.einsum("vi,vi->v", along[beam], along[beam])
    at = np.clip(np.einsum("vi,vi->v", offset, along[beam]) / np.maximum(squared, 1e-300), 0.0, 1.0)
    return _NearestBeams(beam, at, np.linalg.norm(offset - at[:, None] * along[beam], axis=1))


def _embedding(tree: TreeMesh, frame: Frame, beams: list[_NearestBeams], arm_m: float) -> csr_matrix:
    """Weights (render vertices, particles): a vertex turns with the beam it is nearest to.

    A piece of foliage or a twig is not deformed: it moves as its vertex that is nearest to the wood.
    """
    rows: list[csr_matrix] = []
    for primitive, own in zip(tree.primitives, beams, strict=True):
        place, nearest = primitive.positions_m, own
        if primitive.kind != "wood":
            leader = leading_vertices(primitive, own.distance_m, LARGEST_RIGID_PIECE * tree.height_m)
            place = place[leader]
            nearest = replace(own, beam=own.beam[leader], share=own.share[leader])
        rows.append(_rows(place, nearest, frame, arm_m))
    return csr_matrix(vstack(rows, format="csr"))


def _rows(place_m: Floats, nearest: _NearestBeams, frame: Frame, arm_m: float) -> csr_matrix:
    ends = frame.links[nearest.beam]
    arm = (place_m[:, None] - frame.points_m[ends]) / arm_m  # (v, 2, 3)
    weight = np.concatenate([1 - arm.sum(axis=2, keepdims=True), arm], axis=2)
    weight *= np.column_stack([1 - nearest.share, nearest.share])[:, :, None]
    column = 4 * ends[:, :, None] + np.arange(4)
    pointer = 8 * np.arange(len(place_m) + 1)
    shape = (len(place_m), 4 * len(frame.points_m))
    return csr_matrix((weight.ravel(), column.ravel(), pointer), shape=shape)

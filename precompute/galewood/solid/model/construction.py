"""Construction of the finite-element model from mesh, skeleton, wood and foliage."""

from dataclasses import asdict, dataclass, replace
from typing import Any, Protocol

import numpy as np

from galewood.solid.fem import (
    TRUNK_LIMB,
    Element,
    ElementSystem,
    FemModel,
    FemSettings,
    damping_report,
    elevate,
    gradients,
    midside_parents,
    moduli,
    node_mass_shares,
    rayleigh,
    stiffness_blocks,
    with_root_springs,
)
from galewood.solid.model.calibration import fit_factors, reference_target
from galewood.solid.model.effective_mass import sway_report
from galewood.solid.model.rest import Parts, at_rest
from galewood.util import Floats, Int32s
from galewood.wood import Wood

GRAVITY_M_S2 = 9.81
THIN_RADIUS_M = 0.02
"""Radius below which a limb is thin: scans are unsure of it (docs/how-to/scanned-trees.md)."""
STIFFNESS_FLOOR = 0.2
"""Lower limit of the radius ratio for the stiffness (the mass always uses the true ratio).

A twig a fifth as thick as the mesh resolves has 1/600 of its stiffness. A still thinner twig (a line, a
game's needle) would hang like a thread under its leaves, and the tree would be considered unable to stand.
The built-in species have ratios of at least 0.22 and are not affected.
"""


class MeshLike(Protocol):
    """The part of a TetMesh used here: vertices (n,3) m, tets (m,4), original over thickened radius (m,)."""

    @property
    def vertices_m(self) -> Floats: ...
    @property
    def tets(self) -> Int32s: ...
    @property
    def radius_ratio(self) -> Floats: ...


class SkeletonLike(Protocol):
    """The part of a Skeleton used here, at each tet: fibre direction (m,3), branch (m,), 0 the trunk, and
    radius of the limb (m,), m.
    """

    @property
    def tet_fibre(self) -> Floats: ...
    @property
    def tet_branch(self) -> Int32s: ...
    @property
    def tet_radius_m(self) -> Floats: ...


class LumpedMassesLike(Protocol):
    """The part of LumpedMasses used here: added mass and that of its leaves (n,) kg, drag area (n,) m², fixed
    vertices (k,), exposed area (n,) m² or None (no shelter), wind profile (n,) or None (the wind of the top
    everywhere), and the power of the wind speed with which the pressure grows above 5 m/s.
    """

    @property
    def mass_kg(self) -> Floats: ...
    @property
    def leaf_mass_kg(self) -> Floats: ...
    @property
    def drag_area_m2(self) -> Floats: ...
    @property
    def fixed(self) -> Int32s: ...
    @property
    def exposed_area_m2(self) -> Floats | None: ...
    @property
    def wind_profile(self) -> Floats | None: ...
    @property
    def streamlined_exponent(self) -> float: ...


@dataclass(frozen=True)
class Material:
    """The linear elements of a tree: geometry, stiffness parts (m,10,3,3) N/m, wood mass (m,) kg."""

    vertices_m: Floats
    tets: Int32s
    grad: Floats
    axial: Floats
    shear: Floats
    element_mass_kg: Floats


@dataclass(frozen=True)
class UnloadedModel:
    """A model whose stiffness is fitted, before its weight acts; ``parts`` and leaves have masses, kg."""

    model: FemModel
    wood: Wood
    parts: Parts
    leaf_mass_kg: Floats
    report: dict[str, Any]

    def standing(self, stiffness_factor: float = 1.0) -> FemModel:
        """The model under its weight, of wood this many times as stiff.

        The fit compares stiffnesses, so that it is the same for all factors.
        """
        wood = self.wood.scaled(stiffness_factor)
        of_wood = {"wood": wood.name, "wood_source": wood.source, "wood_constants": asdict(wood)}
        model = replace(self.model, blocks=self.model.blocks * stiffness_factor)
        return _finished(model, wood, self.parts, self.leaf_mass_kg, of_wood | self.report)


def build_model(
    mesh: MeshLike,
    skeleton: SkeletonLike,
    wood: Wood,
    lumped: LumpedMassesLike,
    settings: FemSettings | None = None,
) -> FemModel:
    """Build the model of a tree: fitted stiffness, masses, gravity rest pose, Rayleigh damping.

    Raises ValueError if the mesh is invalid.
    """
    return unloaded_model(mesh, skeleton, wood, lumped, settings).standing()


def unloaded_model(
    mesh: MeshLike,
    skeleton: SkeletonLike,
    wood: Wood,
    lumped: LumpedMassesLike,
    settings: FemSettings | None = None,
) -> UnloadedModel:
    """The part of ``build_model`` that is the same for wood of any stiffness."""
    settings = settings or FemSettings()
    material = wood_elements(mesh, skeleton, wood, lumped)
    report: dict[str, Any] = {
        "element": settings.element,
        "wood_mass_kg": float(material.element_mass_kg.sum()),
    }
    if settings.element != "fitted":
        model = _raw(material, lumped, settings, settings.element)
    else:
        raw_reference = _raw(material, lumped, settings, "quadratic")
        model, fit = _fitted(material, _raw(material, lumped, settings, "linear"), raw_reference)
        report["fit"] = fit
    limb = np.asarray(skeleton.tet_branch, np.int32)
    thin = (skeleton.tet_radius_m * mesh.radius_ratio < THIN_RADIUS_M) & (limb != TRUNK_LIMB)
    thin_kg = np.where(thin, material.element_mass_kg, 0.0)
    parts = Parts(limb, material.element_mass_kg, _node_masses(model, thin_kg, lumped.mass_kg))
    return UnloadedModel(model, wood, parts, lumped.leaf_mass_kg, report)


def wood_elements(mesh: MeshLike, skeleton: SkeletonLike, wood: Wood, lumped: LumpedMassesLike) -> Material:
    """Stiffness and mass of the tets, corrected for the thickening of the mesh by the radius ratio."""
    vertices = np.ascontiguousarray(mesh.vertices_m, np.float64)
    tets = np.ascontiguousarray(mesh.tets, np.int32)
    grad, volume = gradients(vertices[tets])
    _check_mesh(vertices, volume, lumped)
    ratio = np.asarray(mesh.radius_ratio, np.float64)
    fibre = np.asarray(skeleton.tet_fibre, np.float64)
    axial, shear = stiffness_blocks(grad, volume, fibre, moduli(wood))
    correction = (np.maximum(ratio, STIFFNESS_FLOOR) ** 4)[:, None, None, None]
    return Material(
        vertices, tets, grad, axial * correction, shear * correction, volume * wood.density_kg_m3 * ratio**2
    )


def _check_mesh(vertices: Floats, volume: Floats, lumped: LumpedMassesLike) -> None:
    if not np.isfinite(vertices).all():
        raise ValueError("the mesh has vertices with non-finite coordinates")
    if not (volume > 0).all():
        raise ValueError(f"{int((volume <= 0).sum())} tetrahedra are flat or inverted")
    if len(lumped.fixed) < 3:
        raise ValueError("fewer than three vertices are fixed, so the tree has no root")


def _raw(material: Material, lumped: LumpedMassesLike, settings: FemSettings, element: Element) -> FemModel:
    """The model without rest pose and damping."""
    count = len(material.vertices_m)
    nodes, elements = material.vertices_m, material.tets
    fixed = np.unique(np.asarray(lumped.fixed, np.int32))
    if element == "quadratic":
        nodes, elements = elevate(nodes, elements)
        held = np.isin(midside_parents(count, elements), fixed).all(axis=1)
        fixed = np.concatenate([fixed, (count + np.flatnonzero(held)).astype(np.int32)])
    area = np.zeros(len(nodes))
    area[:count] = lumped.drag_area_m2
    model = FemModel(
        nodes_m=nodes,
        elements=elements,
        grad=material.grad,
        blocks=material.axial + material.shear,
        mass_kg=np.zeros(len(nodes)),
        drag_area_m2=area,
        fixed=fixed,
        gravity_n=np.zeros_like(nodes),
        prestress=np.zeros((len(elements), 10)),
        vertex_count=count,
        alpha=0.0,
        beta=0.0,
        streamlined_exponent=lumped.streamlined_exponent,
        settings=replace(settings, element=element),
        report={},
        exposed_area_m2=_optional(lumped.exposed_area_m2, len(nodes)),
        wind_profile=_optional(lumped.wind_profile, len(nodes)),
    )
    return _weighing(model, _node_masses(model, material.element_mass_kg, lumped.mass_kg))


def _node_masses(model: FemModel, element_kg: Floats, vertex_kg: Floats) -> Floats:
    """Masses (N,), kg, at the nodes, of masses of elements (m,) and of vertices (n,)."""
    shares = np.full(4, 0.25) if model.elements.shape[1] == 4 else node_mass_shares()
    mass: Floats = np.bincount(
        model.elements.ravel(), np.outer(element_kg, shares).ravel(), len(model.nodes_m)
    ).astype(np.float64)
    mass[: model.vertex_count] += vertex_kg
    return mass


def _weighing(model: FemModel, mass_kg: Floats) -> FemModel:
    """The model with these masses (N,), kg, and their weight."""
    gravity = np.zeros_like(model.nodes_m)
    gravity[:, 1] = -GRAVITY_M_S2 * mass_kg * model.settings.gravity
    return replace(model, mass_kg=mass_kg, gravity_n=gravity)


def _at_nodes(of_vertices: Floats, count: int) -> Floats:
    """Values at the vertices, continued by zeros at the nodes in the middle of edges."""
    return np.concatenate([of_vertices, np.zeros(count - len(of_vertices))])


def _optional(of_vertices: Floats | None, count: int) -> Floats | None:
    return None if of_vertices is None else _at_nodes(of_vertices, count)


def _fitted(material: Material, linear: FemModel, reference: FemModel) -> tuple[FemModel, dict[str, Any]]:
    """The linear model with its stiffness fitted to the quadratic one, and the report of the fit."""
    target = reference_target(reference.system(), reference.mass_kg, linear.mass_kg, linear.drag_area_m2)
    fit = fit_factors(linear.system(), material.axial, material.shear, linear.mass_kg, target)
    blocks = fit.apply(material.axial, material.shear)
    return replace(linear, blocks=blocks, settings=replace(linear.settings, element="fitted")), fit.report


def _finished(
    model: FemModel, wood: Wood, parts: Parts, leaf_mass_kg: Floats, report: dict[str, Any]
) -> FemModel:
    """The model on its foundation, with rest pose, frequencies (also without leaves) and damping."""
    if (stiffness := model.settings.root_stiffness_nm_rad) is not None:
        model = with_root_springs(model, stiffness)
        report = {**report, "root_stiffness_nm_rad": stiffness}
    system = model.system()
    if leaf_mass_kg.any():
        report = {**report, "bare": _bare(model, system, parts, leaf_mass_kg)}
    resting = at_rest(model, system, parts)
    model, frequencies = resting.model, resting.frequencies()
    settings = model.settings.resolved(frequencies[0])
    alpha, beta = rayleigh(wood.damping_ratio, frequencies[0], settings.damping_frequency_ratio)
    report = {
        **report,
        "mass_kg": float(model.mass_kg.sum()),
        "rest_pose": resting.report,
        "frequencies_hz": frequencies,
        "sway": sway_report(model, resting.modes),
        "damping": damping_report(settings, alpha, beta, frequencies[0], wood.damping_ratio),
    }
    return replace(model, alpha=alpha, beta=beta, settings=settings, report=report)


def _bare(model: FemModel, system: ElementSystem, parts: Parts, leaf_mass_kg: Floats) -> dict[str, Any]:
    """Frequencies of the tree on the same elements without the mass of its leaves."""
    leaves = _at_nodes(leaf_mass_kg, len(model.nodes_m))
    light = parts._replace(thin_kg=np.maximum(parts.thin_kg - leaves, 0.0))
    resting = at_rest(_weighing(model, model.mass_kg - leaves), system, light)
    return {
        "mass_kg": float(resting.model.mass_kg.sum()),
        "rest_pose": resting.report,
        "frequencies_hz": resting.frequencies(),
        "sway": sway_report(resting.model, resting.modes),
    }

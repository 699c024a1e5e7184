"""The finite-element model of one tree: everything a simulation needs, as plain arrays in one file."""

import json
from dataclasses import asdict, dataclass, fields, replace
from pathlib import Path
from typing import Any, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from precompute.assembly import ElementSystem
from precompute.calibration import fit_factors
from precompute.elasticity import gradients, moduli, stiffness_blocks
from precompute.modal import natural_modes
from precompute.quadratic import elevate, node_mass_shares
from precompute.statics import gravity_rest_pose
from precompute.wood import Wood

Floats = NDArray[np.float64]
Ints = NDArray[np.int32]

Scheme = Literal["backward-euler", "tr-bdf2"]
Element = Literal["fitted", "linear", "quadratic"]

GRAVITY_M_S2 = 9.81
RATIO_FLOOR = 0.5


class MeshLike(Protocol):
    """What of a TetMesh is needed here: vertices (n,3) m, tets (m,4), original over thickened radius (m,)."""

    @property
    def vertices_m(self) -> Floats: ...
    @property
    def tets(self) -> Ints: ...
    @property
    def radius_ratio(self) -> Floats: ...


class SkeletonLike(Protocol):
    """What of a Skeleton is needed here: the fibre direction (m,3) of each tet."""

    @property
    def tet_fibre(self) -> Floats: ...


class LumpsLike(Protocol):
    """What of the foliage is needed here: extra mass (n,) kg, drag area (n,) m², fixed vertices (k,)."""

    @property
    def mass_kg(self) -> Floats: ...
    @property
    def drag_area_m2(self) -> Floats: ...
    @property
    def fixed(self) -> Ints: ...


@dataclass(frozen=True, kw_only=True)
class FemSettings:
    """How a tree is simulated.

    dt_s is the table's step; each is cut into `substeps` equal steps of `scheme`. `j_max` and `tolerance` (relative to
    the first residual) are Algorithm 2's. The damping ratio of the wood holds at the first natural frequency and at
    `damping_frequency_ratio` times it (Rayleigh's two targets).
    """

    dt_s: float = 1 / 30
    substeps: int = 1
    scheme: Scheme = "tr-bdf2"
    element: Element = "fitted"
    j_max: int = 1
    tolerance: float = 1e-6
    damping_frequency_ratio: float = 3.0
    gravity: bool = True

    def __post_init__(self) -> None:
        if not 1e-4 <= self.dt_s <= 1:
            raise ValueError("dt_s must lie between 0.0001 and 1 s")
        if not 1 <= self.substeps <= 64 or not 1 <= self.j_max <= 50:
            raise ValueError("substeps must lie in 1..64 and j_max in 1..50")
        if self.scheme not in ("backward-euler", "tr-bdf2"):
            raise ValueError(f"unknown scheme {self.scheme!r}: backward-euler or tr-bdf2")
        if self.element not in ("fitted", "linear", "quadratic"):
            raise ValueError(f"unknown element {self.element!r}: fitted, linear or quadratic")
        if not 1 < self.damping_frequency_ratio <= 100:
            raise ValueError("damping_frequency_ratio must lie above 1 and at most at 100")


@dataclass(frozen=True, kw_only=True)
class FemModel:
    """A tree ready to be simulated; nodes 0..vertex_count−1 are the vertices of the tetrahedral mesh.

    nodes_m (N,3), elements (m, 4|10), grad (m,4,3) 1/m, blocks (m,10,3,3) N/m, mass_kg (N,), drag_area_m2 (N,),
    fixed (k,), gravity_n (N,3) N, u_rest (N,3) m. alpha 1/s and beta s are Rayleigh's. The report is JSON-able.
    """

    nodes_m: Floats
    elements: Ints
    grad: Floats
    blocks: Floats
    mass_kg: Floats
    drag_area_m2: Floats
    fixed: Ints
    gravity_n: Floats
    u_rest: Floats
    vertex_count: int
    alpha: float
    beta: float
    settings: FemSettings
    report: dict[str, Any]

    def system(self) -> ElementSystem:
        """The assembled-to-be elements with their solver (symbolic analysis included)."""
        return ElementSystem(self.nodes_m, self.elements, self.grad, self.blocks, self.fixed)


def build_model(
    mesh: MeshLike, skeleton: SkeletonLike, wood: Wood, lumps: LumpsLike, settings: FemSettings | None = None
) -> FemModel:
    """Model of a tree: stiffness (fitted), masses, gravity rest pose, Rayleigh damping. ValueError on a bad mesh."""
    settings = settings or FemSettings()
    model = _undamped(mesh, skeleton, wood, lumps, settings)
    pose = gravity_rest_pose(model.system(), model.gravity_n, float(np.ptp(model.nodes_m[:, 1])))
    model = replace(
        model, u_rest=pose.u_m, gravity_n=pose.gravity_n, report={**model.report, "rest_pose": pose.report}
    )
    return _damped(model, wood.damping_ratio)


def _undamped(
    mesh: MeshLike, skeleton: SkeletonLike, wood: Wood, lumps: LumpsLike, settings: FemSettings
) -> FemModel:
    vertices, tets = (
        np.ascontiguousarray(mesh.vertices_m, np.float64),
        np.ascontiguousarray(mesh.tets, np.int32),
    )
    grad, volume = gradients(vertices[tets])
    _check_mesh(vertices, volume, lumps)
    ratio = np.clip(mesh.radius_ratio, RATIO_FLOOR, 1.0)
    axial, shear = stiffness_blocks(grad, volume, np.asarray(skeleton.tet_fibre, np.float64), moduli(wood))
    thinned = (ratio**4)[:, None, None, None]
    axial, shear = axial * thinned, shear * thinned
    report: dict[str, Any] = {"wood": wood.name, "wood_source": wood.source, "element": settings.element}
    nodes, elements, shares = vertices, tets, np.full(4, 0.25)
    blocks = axial + shear
    if settings.element == "quadratic":
        nodes, elements = elevate(vertices, tets)
        shares = node_mass_shares()
    elif settings.element == "fitted":
        fit = fit_factors(vertices, tets, grad, axial, shear, np.asarray(lumps.fixed, np.int32))
        blocks = fit.apply(axial, shear)
        report["fit"] = fit.report
    element_mass = volume * wood.density_kg_m3 * ratio**2
    mass = np.bincount(elements.ravel(), np.outer(element_mass, shares).ravel(), len(nodes))
    mass[: len(vertices)] += lumps.mass_kg
    gravity = np.zeros((len(nodes), 3))
    if settings.gravity:
        gravity[:, 1] = -GRAVITY_M_S2 * mass
    area = np.zeros(len(nodes))
    area[: len(vertices)] = lumps.drag_area_m2
    report["mass_kg"] = float(mass.sum())
    report["wood_mass_kg"] = float(element_mass.sum())
    return FemModel(
        nodes_m=nodes,
        elements=elements,
        grad=grad,
        blocks=blocks,
        mass_kg=mass,
        drag_area_m2=area,
        fixed=np.unique(np.asarray(lumps.fixed, np.int32)),
        gravity_n=gravity,
        u_rest=np.zeros_like(nodes),
        vertex_count=len(vertices),
        alpha=0.0,
        beta=0.0,
        settings=settings,
        report=report,
    )


def _check_mesh(vertices: Floats, volume: Floats, lumps: LumpsLike) -> None:
    if not np.isfinite(vertices).all():
        raise ValueError("the mesh has vertices that are not finite")
    if not (volume > 0).all():
        raise ValueError(f"{int((volume <= 0).sum())} tetrahedra are flat or inside out")
    if len(lumps.fixed) < 3:
        raise ValueError("fewer than three vertices are fixed: the tree has no root")


def _damped(model: FemModel, ratio: float) -> FemModel:
    """The model with Rayleigh's α and β for the wood's damping ratio, its frequencies and dampings in the report."""
    frequencies = natural_modes(model, 10).frequencies_hz
    first = 2 * np.pi * float(frequencies[0])
    second = model.settings.damping_frequency_ratio * first
    alpha = 2 * ratio * first * second / (first + second)
    beta = 2 * ratio / (first + second)
    damping = damping_report(model.settings, alpha, beta, float(frequencies[0]), ratio)
    report = {**model.report, "frequencies_hz": [float(f) for f in frequencies], "damping": damping}
    return replace(model, alpha=alpha, beta=beta, report=report)


def damping_report(
    settings: FemSettings, alpha: float, beta: float, frequency_hz: float, target: float
) -> dict[str, float]:
    """Damping ratio of a mode as given, by Rayleigh, by the time step, and as shown (both together)."""
    omega = 2 * np.pi * frequency_hz
    rayleigh = alpha / (2 * omega) + beta * omega / 2
    shown = shown_damping(settings, omega, rayleigh)
    numerical = shown_damping(settings, omega, 0.0)
    return {"target": target, "rayleigh": rayleigh, "numerical": numerical, "shown": shown}


def shown_damping(settings: FemSettings, omega: float, ratio: float) -> float:
    """Damping ratio that the time-stepping scheme shows for a mode of angular frequency omega (1/s) and this ratio."""
    h = settings.dt_s / settings.substeps
    z = h * omega * complex(-ratio, np.sqrt(1 - ratio**2))
    if settings.scheme == "backward-euler":
        growth = 1 / (1 - z)
    else:
        d = 1 - np.sqrt(0.5)
        growth = (1 + (1 - 2 * d) * z) / (1 - d * z) ** 2
    decay = np.log(growth)
    return float(-decay.real / abs(decay))


_ARRAYS = tuple(f.name for f in fields(FemModel) if f.type in (Floats, Ints, "Floats", "Ints"))


def save_model(model: FemModel, path: Path) -> None:
    """Write the model to one .npz (atomically: a reader never sees half a file)."""
    header = {
        "vertex_count": model.vertex_count,
        "alpha": model.alpha,
        "beta": model.beta,
        "settings": asdict(model.settings),
        "report": model.report,
    }
    part = path.with_name(path.name + ".part")
    with part.open("wb") as file:
        arrays: dict[str, Any] = {name: getattr(model, name) for name in _ARRAYS}
        np.savez(file, header=np.frombuffer(json.dumps(header).encode(), np.uint8), **arrays)
    part.replace(path)


def load_model(path: Path) -> FemModel:
    """Read what `save_model` wrote, bit for bit."""
    with np.load(path, allow_pickle=False) as file:
        header = json.loads(file["header"].tobytes())
        arrays: dict[str, Any] = {name: file[name] for name in _ARRAYS}
    settings = FemSettings(**header.pop("settings"))
    return FemModel(settings=settings, **header, **arrays)

"""The finite-element model of one tree: everything a simulation needs, as plain arrays in one file."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np

from galewood.fem.assembly import ElementSystem
from galewood.util import Floats, Int32s, write_arrays

Scheme = Literal["backward-euler", "tr-bdf2"]
Element = Literal["fitted", "linear", "quadratic"]


@dataclass(frozen=True, kw_only=True)
class FemSettings:
    """Simulation settings; ValueError if a value is out of range.

    dt_s is the table's time step, which is divided into `substeps` equal steps of `scheme`. `j_max` and
    `tolerance` (relative to the first residual) belong to the paper's Algorithm 2. The damping ratio of the
    wood applies at the first natural frequency and at `damping_frequency_ratio` times it (Rayleigh's two
    targets).
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
    """A tree ready for simulation; nodes 0..vertex_count−1 are the vertices of the tetrahedral mesh.

    nodes_m (N,3), elements (m, 4|10), grad (m,4,3) 1/m, blocks (m,10,3,3) N/m, mass_kg (N,), drag_area_m2
    (N,), fixed (k,), gravity_n (N,3) N, u_rest (N,3) m, prestress (m,10) N/m (`prestress.py`). alpha (1/s)
    and beta (s) are Rayleigh's coefficients. The report can be serialised to JSON.
    """

    nodes_m: Floats
    elements: Int32s
    grad: Floats
    blocks: Floats
    mass_kg: Floats
    drag_area_m2: Floats
    fixed: Int32s
    gravity_n: Floats
    u_rest: Floats
    prestress: Floats
    vertex_count: int
    alpha: float
    beta: float
    settings: FemSettings
    report: dict[str, Any]

    def system(self) -> ElementSystem:
        """The element system with its solver, including the symbolic analysis."""
        return ElementSystem(self.nodes_m, self.elements, self.grad, self.blocks, self.fixed, self.prestress)


_ARRAYS = (
    "nodes_m",
    "elements",
    "grad",
    "blocks",
    "mass_kg",
    "drag_area_m2",
    "fixed",
    "gravity_n",
    "u_rest",
    "prestress",
)


def save_model(model: FemModel, path: Path) -> None:
    """Write the model atomically to one .npz file."""
    header = {
        "vertex_count": model.vertex_count,
        "alpha": model.alpha,
        "beta": model.beta,
        "settings": asdict(model.settings),
        "report": model.report,
    }
    arrays: dict[str, Any] = {name: getattr(model, name) for name in _ARRAYS}
    write_arrays(path, header=np.frombuffer(json.dumps(header).encode(), np.uint8), **arrays)


def load_model(path: Path) -> FemModel:
    """Read a model written by `save_model`, bit for bit."""
    with np.load(path, allow_pickle=False) as file:
        header = json.loads(file["header"].tobytes())
        arrays: dict[str, Any] = {name: file[name] for name in _ARRAYS}
    settings = FemSettings(**header.pop("settings"))
    return FemModel(settings=settings, **header, **arrays)

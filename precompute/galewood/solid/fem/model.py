"""The finite-element model of one tree: everything a simulation needs, as plain arrays in one file."""

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from galewood.solid.fem.drag import Drag
from galewood.solid.fem.elements.assembly import ElementSystem
from galewood.solid.fem.settings import FemSettings
from galewood.util import Floats, Int32s, write_arrays


@dataclass(frozen=True, kw_only=True)
class FemModel:
    """A tree ready for simulation; nodes 0..vertex_count−1 are the vertices of the tetrahedral mesh.

    nodes_m (N,3), elements (m, 4|10), grad (m,4,3) 1/m, blocks (m,10,3,3) N/m, mass_kg (N,), drag_area_m2
    (N,), fixed (k,), gravity_n (N,3) N, prestress (m,10) N/m (`prestress.py`). alpha (1/s) and beta (s) are
    Rayleigh's coefficients. The nodes rest where they are given. The report can be serialised to JSON.
    strain_m (m, 4|10, 3) m is the strain that the given shape has under its weight, as displacements of each
    element's nodes; None: it is unstrained. exposed_area_m2 (N,) is the drag area without shelter and
    wind_profile (N,) the wind speed at the nodes over that at the top (`drag.py`); None: no shelter, the same
    speed everywhere. foundation_n_m (N,) N/m are springs between the nodes and the ground (`foundation.py`);
    None: `fixed` is clamped. streamlined_exponent: the wind's pressure grows with this power of its speed
    above 5 m/s.
    """

    nodes_m: Floats
    elements: Int32s
    grad: Floats
    blocks: Floats
    mass_kg: Floats
    drag_area_m2: Floats
    fixed: Int32s
    gravity_n: Floats
    prestress: Floats
    vertex_count: int
    alpha: float
    beta: float
    streamlined_exponent: float
    settings: FemSettings
    report: dict[str, Any]
    strain_m: Floats | None = None
    exposed_area_m2: Floats | None = None
    wind_profile: Floats | None = None
    foundation_n_m: Floats | None = None

    def system(self) -> ElementSystem:
        """The element system with its solver, including the symbolic analysis."""
        shape = (self.nodes_m, self.elements, self.grad, self.blocks, self.fixed)
        return ElementSystem(*shape, self.prestress, self.strain_m, self.foundation_n_m)

    def drag(self, order: Int32s | slice = slice(None)) -> Drag:
        """The drag of the nodes, in mesh order or another one."""
        exposed, profile = (
            None if array is None else array[order] for array in (self.exposed_area_m2, self.wind_profile)
        )
        return Drag(self.drag_area_m2[order], exposed, profile, self.streamlined_exponent)


_ARRAYS = (
    "nodes_m",
    "elements",
    "grad",
    "blocks",
    "mass_kg",
    "drag_area_m2",
    "fixed",
    "gravity_n",
    "prestress",
)
_OPTIONAL_ARRAYS = ("strain_m", "exposed_area_m2", "wind_profile", "foundation_n_m")
"""Arrays of a model that may be None."""


def save_model(model: FemModel, path: Path) -> None:
    """Write the model atomically to one .npz file."""
    header = {
        "vertex_count": model.vertex_count,
        "alpha": model.alpha,
        "beta": model.beta,
        "streamlined_exponent": model.streamlined_exponent,
        "settings": asdict(model.settings),
        "report": model.report,
    }
    arrays: dict[str, Any] = {name: getattr(model, name) for name in _ARRAYS}
    arrays |= {name: array for name in _OPTIONAL_ARRAYS if (array := getattr(model, name)) is not None}
    write_arrays(path, header=np.frombuffer(json.dumps(header).encode(), np.uint8), **arrays)


def load_model(path: Path) -> FemModel:
    """Read a model written by `save_model`, bit for bit."""
    with np.load(path, allow_pickle=False) as file:
        header = json.loads(file["header"].tobytes())
        names = (*_ARRAYS, *(name for name in _OPTIONAL_ARRAYS if name in file.files))
        arrays: dict[str, Any] = {name: file[name] for name in names}
    settings = FemSettings(**header.pop("settings"))
    return FemModel(settings=settings, **header, **arrays)

"""Natural frequencies and modes of a tree about its rest pose."""

from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from scipy.sparse import diags_array
from scipy.sparse.linalg import LinearOperator, eigsh

from galewood.solid.fem.elements.assembly import ElementSystem
from galewood.util import Floats

if TYPE_CHECKING:
    from galewood.solid.fem.model import FemModel


LANCZOS_TOLERANCE: Any = 1e-10  # scipy's type annotation requires an int


class Modes(NamedTuple):
    """Frequencies (k,) Hz, ascending, and mass-normalised shapes (k,N,3), 1/√kg, in mesh order."""

    frequencies_hz: Floats
    shapes: Floats


def frequencies(model: "FemModel", count: int) -> Floats:
    """The first `count` natural frequencies about the gravity rest pose, Hz."""
    return natural_modes(model, count).frequencies_hz


def natural_modes(model: "FemModel", count: int, system: ElementSystem | None = None) -> Modes:
    """Modes of small vibrations about the rest pose, including the softening by gravity (`prestress.py`).

    Passing the model's `system` avoids its symbolic analysis; its matrix is overwritten. Raises
    NotPositiveDefinite if the rest pose is unstable.
    """
    system = system or model.system()
    still = np.zeros_like(system.rest)
    omega, inner = tangent_modes(system, still, model.mass_kg[system.order], count)
    shapes = np.empty_like(inner)
    shapes[:, system.order] = inner
    return Modes(omega / (2 * np.pi), shapes)


def tangent_modes(system: ElementSystem, u: Floats, mass: Floats, count: int) -> tuple[Floats, Floats]:
    """Modes of the corotational tangent: angular frequencies (count,) 1/s, ascending, and shapes (count,N,3).

    The shapes are mass-normalised. Shift-invert Lanczos about zero with the block factor; u, mass and shapes
    are in the system's internal order.
    """
    size = 3 * system.free
    system.assemble(u, np.zeros_like(u), 1.0, np.zeros(len(u)), np.zeros_like(u))
    stiffness = system.solver.to_scipy(system.values)
    system.solver.factorise(system.values)

    def inverse(b: Floats) -> Floats:
        y = np.array(b, np.float64).reshape(-1, 3)
        system.solver.solve(y)
        return y.ravel()

    solver = LinearOperator((size, size), matvec=inverse, dtype=np.float64)  # pyright: ignore[reportCallIssue]
    diagonal = diags_array(np.repeat(mass[: system.free], 3)).tocsc()
    squares, vectors = eigsh(
        stiffness, count, M=diagonal, sigma=0, OPinv=solver, v0=np.ones(size), tol=LANCZOS_TOLERANCE
    )
    modes = np.zeros((count, len(u), 3))
    modes[:, : system.free] = vectors.T.reshape(count, -1, 3)
    rising = np.argsort(squares)
    return np.sqrt(np.maximum(squares[rising], 0)), modes[rising]

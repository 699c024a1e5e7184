"""The one place that calls pytetwild; it runs in a child process, because bad input makes it segfault."""

from __future__ import annotations

import numpy as np

from galewood.sandbox.limited_process import Arrays
from galewood.util import usable_cores


def tetrahedralise_surface(arguments: Arrays) -> Arrays:
    """vertices (n, 3), faces (m, 3), epsilon and edge_length (both of the diagonal), stop_energy →
    vertices, tets."""
    from pytetwild.pytetwild import tetrahedralize  # imports pyvista, which only this child needs

    vertices, tets = tetrahedralize(
        np.ascontiguousarray(arguments["vertices"], dtype=np.float64),
        np.ascontiguousarray(arguments["faces"], dtype=np.int32),
        epsilon=float(arguments["epsilon"]),
        edge_length_fac=float(arguments["edge_length"]),
        stop_energy=float(arguments["stop_energy"]),
        num_threads=usable_cores(),
        vtk_ordering=True,  # without it every tet comes out inverted
        quiet=True,
    )
    return {"vertices": np.asarray(vertices, dtype=np.float64), "tets": np.asarray(tets, dtype=np.int32)}

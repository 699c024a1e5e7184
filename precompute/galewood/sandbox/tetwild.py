"""The only module that calls pytetwild. It runs in a child process because invalid input can crash it."""

from __future__ import annotations

import numpy as np

from galewood.sandbox.arrays import Arrays
from galewood.util import usable_cores


def tetrahedralise_surface(arguments: Arrays) -> Arrays:
    """Fill a closed surface with tetrahedra.

    In: vertices (n, 3), faces (m, 3), epsilon and edge_length (relative to the bounding-box diagonal),
    stop_energy, passes (largest number of optimisation passes). Out: vertices (k, 3), tets (t, 4).
    """
    from pytetwild.pytetwild import tetrahedralize  # imports pyvista, which only this child needs

    vertices, tets = tetrahedralize(
        np.ascontiguousarray(arguments["vertices"], dtype=np.float64),
        np.ascontiguousarray(arguments["faces"], dtype=np.int32),
        epsilon=float(arguments["epsilon"]),
        edge_length_fac=float(arguments["edge_length"]),
        stop_energy=float(arguments["stop_energy"]),
        simplify=False,  # the caller has decimated the surface
        num_opt_iter=int(arguments["passes"]),
        num_threads=usable_cores(),
        vtk_ordering=True,  # otherwise all tets are inverted
        quiet=True,
    )
    return {"vertices": np.asarray(vertices, dtype=np.float64), "tets": np.asarray(tets, dtype=np.int32)}

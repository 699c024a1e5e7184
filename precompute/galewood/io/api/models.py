"""The finite-element model of a tree and its motion in wind: the reference solution."""
# pyright: reportUnknownMemberType=error, reportUnknownVariableType=error
# pyright: reportUnknownArgumentType=error, reportUnknownParameterType=error

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from galewood.io.api.cache import default_cache_dir
from galewood.io.api.expected import expect
from galewood.io.api.trees import Tree
from galewood.motion.wind import Wind, WindField, height_factor
from galewood.options import USUAL_TETS
from galewood.solid.fem import FemModel, FemSettings, Simulator
from galewood.solid.model import tree_model
from galewood.table import Foliage
from galewood.util import Floats, Singles
from galewood.wood import Wood


@dataclass(frozen=True)
class Motion:
    """T frames of a tree's wood, simulated by finite elements from rest."""

    time_s: Floats
    """(T,) time of each frame; the first is one time step after the start."""
    displacement_m: Singles
    """(T, n, 3) displacement of the wood's vertices from the rest pose under gravity."""
    pressure_pa: Floats
    """(T, 2) dynamic pressure along x and z during the step that ends at each frame."""
    base_force_n: Floats
    """(T, 3) force of the tree on the ground, its weight included."""
    base_moment_nm: Floats
    """(T, 3) moment of the tree on the ground about its foot (the origin), its weight included."""

    @property
    def velocity_m_s(self) -> Floats:
        """(T, n, 3) velocity of the vertices, by central differences; T must be at least 2."""
        return np.gradient(self.displacement_m.astype(np.float64), self.time_s, axis=0)

    @property
    def acceleration_m_s2(self) -> Floats:
        """(T, n, 3) acceleration of the vertices, by central differences twice."""
        return np.gradient(self.velocity_m_s, self.time_s, axis=0)


class Model:
    """The corotational finite-element model of a tree, at its rest pose under gravity.

    Meshing takes some seconds the first time; tetrahedra are kept in ``cache_dir``.
    """

    def __init__(
        self,
        tree: Tree,
        *,
        wood: Wood | None = None,
        foliage: Foliage = "leaf",
        target_tets: int = USUAL_TETS,
        settings: FemSettings | None = None,
        cache_dir: Path | None = None,
    ) -> None:
        """Build the model.

        Args:
            tree: The tree (``galewood.read``).
            wood: Elastic constants, density and damping; by default those of the tree's species.
            foliage: "bare" leaves out the mass and the wind area of the leaves.
            target_tets: Number of tetrahedra to aim at.
            settings: Time step, elements and damping of the simulation.
            cache_dir: Folder for meshes; by default the user's cache folder.

        Raises:
            MeshError: The wood cannot be meshed.
            TypeError: ``tree`` or ``wood`` is something else.
        """
        expect("tree", tree, Tree)
        if wood is not None:
            expect("wood", wood, Wood)
        self.tree = tree
        made = tree_model(
            tree.mesh,
            wood,
            target_tets,
            cache_dir or default_cache_dir(),
            settings or FemSettings(),
            leaves=foliage == "leaf",
        )
        self.wood = made.wood
        self.fem: FemModel = made.fem
        """The model itself: nodes, elements, masses, loads."""

    @property
    def frequencies_hz(self) -> list[float]:
        """The first ten natural frequencies about the rest pose, Hz."""
        return list(self.fem.report["frequencies_hz"])

    @property
    def mass_kg(self) -> float:
        """Mass of wood and leaves, kg."""
        return float(self.fem.mass_kg.sum())

    @property
    def rest_vertices_m(self) -> Floats:
        """(n, 3) vertices of the tetrahedra at rest under gravity, m."""
        return self.fem.nodes_m[: self.fem.vertex_count]

    @property
    def report(self) -> dict[str, Any]:
        """Mass, frequencies, damping, rest pose and the constants used; JSON-able."""
        return self.fem.report

    def simulate(
        self,
        wind: Wind,
        *,
        duration_s: float,
        on_progress: Callable[[float], None] | None = None,
    ) -> Motion:
        """Simulate the tree, standing at x = z = 0, from rest at time 0.

        ``on_progress`` receives the fraction done after each step; whatever it raises stops the simulation.

        Raises:
            TypeError: ``wind`` is something else.
            ValueError: ``duration_s`` is shorter than a time step.
            FloatingPointError: The wind is too strong for the time step.
        """
        expect("wind", wind, Wind)
        dt_s = self.fem.settings.dt_s
        frames = round(duration_s / dt_s)
        if frames < 1:
            raise ValueError(f"duration_s must be at least one time step ({dt_s:.4g} s)")
        time_s: Floats = dt_s * np.arange(1, frames + 1, dtype=np.float64)
        pressure_pa = pressure_at_origin(wind, self.tree.height_m, time_s, self.fem.streamlined_exponent)
        simulator = Simulator(self.fem)
        displacement_m = np.empty((frames, self.fem.vertex_count, 3), np.float32)
        momentum, load = np.zeros((frames + 1, 6)), np.zeros((frames, 6))  # it starts at rest
        for frame, pressure in enumerate(pressure_pa):
            simulator.step(pressure)
            displacement_m[frame] = simulator.u
            momentum[frame + 1], load[frame] = simulator.balance()
            if on_progress:
                on_progress((frame + 1) / frames)
        base = load - np.gradient(momentum, dt_s, axis=0)[1:]
        return Motion(time_s, displacement_m, pressure_pa, base[:, :3], base[:, 3:])


def pressure_at_origin(wind: Wind, height_m: float, time_s: Floats, exponent: float) -> Floats:
    """(T, 2) dynamic pressure, Pa, on a tree of this height at x = z = 0, at each time (T,).

    ``exponent`` is the streamlined exponent of the tree.
    """
    field, place = WindField(wind), np.zeros(1)
    factor = height_factor(np.array([height_m]), wind.height_exponent, wind.reference_height_m)
    found = np.zeros((len(time_s), 2))
    pressure_x, pressure_z = np.zeros(1), np.zeros(1)
    for frame, now_s in enumerate(time_s):
        field.pressure(place, place, float(now_s), pressure_x, pressure_z, exponent, factor)
        found[frame] = pressure_x[0], pressure_z[0]
    return found

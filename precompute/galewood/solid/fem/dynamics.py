"""Implicit time integration of a tree in the wind.

The load is the drag of `drag.py`, linearised at the start of each step: its derivative by the velocity adds
to the diagonal blocks of the damping.
"""

import numba
import numpy as np

from galewood.solid.fem.elements.assembly import ElementSystem
from galewood.solid.fem.model import FemModel
from galewood.solid.fem.solver import JIT
from galewood.util import Floats, Int32s

_D = 1 - np.sqrt(0.5)
"""TR-BDF2's implicit coefficient: both stages solve with M + d h C + (d h)² K (γ = 2 − √2, L-stable)."""
_BDF2 = 1 / (2 * _D * (2 - 2 * _D))
"""Explicit part of BDF2 with unequal steps γ h, (1 − γ) h: start + _BDF2 · (middle − start)."""


class Simulator:
    """Integrates a model from its gravity rest pose under wind pressure.

    `u` and `v` (n,3) are the displacement, m, from the gravity rest pose and the velocity, m/s, of the mesh's
    vertices. After a step, `internal_force` and `stiffness_diagonal` refer to the state *before* it.
    """

    def __init__(self, model: FemModel) -> None:
        self.model = model
        self._system = model.system()
        order = self._system.order
        self._mass = model.mass_kg[order]
        self._drag = model.drag(order)
        self._gravity = model.gravity_n[order]
        self._vertices = self._system.rank[: model.vertex_count]
        self._substeps = max(model.settings.substeps, 1)
        self._dt = model.settings.dt_s / self._substeps
        self._force = np.empty_like(self._system.rest)
        self._zero = np.zeros_like(self._force)
        self._near: tuple[bytes, ElementSystem] | None = None
        self._pressure_pa: Floats = np.zeros(2)
        self.reset()

    def reset(self) -> None:
        """Return to the gravity rest pose with zero velocity."""
        self._u = self._zero.copy()
        self._velocity = np.zeros_like(self._u)
        self._last_velocity = self._velocity
        self._before = self._u.copy()

    def displace(self, u_m: Floats) -> None:
        """Start at rest from a displacement (N,3), m, of all nodes relative to the gravity rest pose."""
        self.reset()
        self._u += u_m[self._system.order]
        self._u[self._system.free :] = 0.0
        self._before = self._u.copy()

    @property
    def u(self) -> Floats:
        """(n,3) displacement of the vertices from the gravity rest pose, m (a copy)."""
        return self._u[self._vertices]

    @property
    def v(self) -> Floats:
        """(n,3) velocity of the vertices, m/s (a copy)."""
        return self._velocity[self._vertices]

    @property
    def place_m(self) -> Floats:
        """(N,3) places of all nodes at gravity rest, m."""
        return self.model.nodes_m

    def balance(self) -> tuple[Floats, Floats]:
        """Momentum and external load of the tree, each (6,): N·s, N, then their moments about the origin.

        The load is that of wind, weight and the mass-proportional part of the damping, at the places that the
        nodes have now. What it exceeds the rate of change of the momentum by is borne by the ground.
        """
        arm = self._system.rest + self._u
        momentum = self._mass[:, None] * self._velocity
        drag = self._drag.at(self._velocity, self._pressure_pa).force_n
        load = drag + self._gravity - self.model.alpha * momentum
        both = [np.concatenate([of.sum(axis=0), np.cross(arm, of).sum(axis=0)]) for of in (momentum, load)]
        return both[0], both[1]

    @property
    def internal_force(self) -> Floats:
        """(n,3) internal force before the last step minus the gravity it balances, N.

        It is zero at rest and at fixed vertices.
        """
        return self._internal(self._system)[self._vertices]

    @property
    def stiffness_diagonal(self) -> Floats:
        """(n,3,3) diagonal stiffness blocks before the last step, N/m (zero at fixed vertices)."""
        return self._stiffness(self._system, self._vertices)

    def recorded_force(self, vertices: Int32s) -> Floats:
        """`internal_force` of the given vertices, (q,3) N."""
        nodes = self._vertices[vertices]
        return self._internal(self._system_around(nodes))[nodes]

    def recorded_stiffness(self, vertices: Int32s) -> Floats:
        """`stiffness_diagonal` of the given vertices, (q,3,3) N/m."""
        nodes = self._vertices[vertices]
        return self._stiffness(self._system_around(nodes), nodes)

    def _system_around(self, nodes: Int32s) -> ElementSystem:
        key = nodes.tobytes()
        if self._near is None or self._near[0] != key:
            self._near = (key, self._system.around(nodes))
        return self._near[1]

    def step(self, pressure_pa: Floats) -> None:
        """Advance by the table's time step in a constant wind of dynamic pressure (p_x, p_z), Pa.

        ``pressure_pa`` is (2,), the same everywhere, or (N,2), of each node. Raises FloatingPointError if the
        solution diverges.
        """
        self._pressure_pa = pressure_pa if np.ndim(pressure_pa) == 1 else pressure_pa[self._system.order]
        self._before[:] = self._u
        for _ in range(self._substeps):
            if self.model.settings.scheme == "backward-euler":
                self._backward_euler()
            else:
                self._tr_bdf2()
        if not np.isfinite(self._u).all():
            raise FloatingPointError("the simulation diverged: the wind is far stronger than the design wind")

    def _backward_euler(self) -> None:
        """One step of the paper's Algorithm 2: at most `j_max` Newton steps from the last velocity."""
        h, u, v = self._dt, self._u, self._velocity
        residual, _ = self._linearised(h, u)
        first = float(np.linalg.norm(residual))
        new = self._refined(h, u, v, v + self._solved(residual), first)
        self._last_velocity = v
        self._u, self._velocity = u + h * new, new

    def _tr_bdf2(self) -> None:
        """One step of TR-BDF2 (Bank et al. 1985): trapezoidal rule to γ h, then BDF2 to h, with the same
        matrix; with `j_max` > 1 both stages are iterated (`_tr_bdf2_by_newton`).

        Both stages use forces that are linear about one pose, with the rotations of the elements predicted
        for the middle of the step. The path of a rotating branch is then the tangent to its arc there. The
        tangents of two steps intersect where one ends and the next begins, so no step starts with a
        stretch that it would have to damp out. (Rotations of the start of the step do, and cost a free decay
        from 20 % sway a tenth of its amplitude in six periods.) The second stage needs no new forces, only
        K Δv, which follows from the first solve (`_second_stage`).
        """
        if self.model.settings.j_max > 1:
            self._tr_bdf2_by_newton()
            return
        d, u, v = _D * self._dt, self._u, self._velocity
        half, drag_damping = self._linearised(d, self._middle())
        rise = self._solved(2 * half)
        middle, a = v + rise, _BDF2
        guess, residual = np.zeros_like(v), np.zeros_like(v)
        factors = (d, self.model.alpha, self.model.beta, a)
        _second_stage(factors, self._system.free, self._mass, drag_damping, half, v, rise, guess, residual)
        new = guess + self._solved(residual)
        self._last_velocity = v
        self._u, self._velocity = u + a * d * (v + middle) + d * new, new

    def _tr_bdf2_by_newton(self) -> None:
        """One step of TR-BDF2 with both stages solved by Newton's method, from the last acceleration.

        For the converged reference. Up to `j_max` iterations, until the residual is below `tolerance` times
        the first one.
        """
        d, u, v = _D * self._dt, self._u, self._velocity
        self._assemble(u, self.model.beta * v, d)
        start = d * (self._gravity + self._drag.at(v, self._pressure_pa).force_n - self._force)
        start -= d * self.model.alpha * self._mass[:, None] * v
        rise = (v - self._last_velocity) / self._dt
        known = self._mass[:, None] * v + start
        middle = self._newton(d, u + d * v, known, v + 2 * d * rise)
        a = _BDF2
        known = self._mass[:, None] * (v + a * (middle - v))
        u_known = u + a * d * (v + middle)
        new = self._newton(d, u_known, known, v + self._dt * rise)
        self._last_velocity = v
        self._u, self._velocity = u_known + d * new, new

    def _newton(self, d: float, u_known: Floats, known: Floats, v: Floats) -> Floats:
        """The velocity that solves M v = known + d F(u_known + d v, v), from a first guess."""
        first = 0.0
        for _ in range(self.model.settings.j_max):
            self._assemble(u_known + d * v, self.model.beta * v, d)
            drag = self._drag.at(v, self._pressure_pa)
            inertia = known - (1 + d * self.model.alpha) * self._mass[:, None] * v
            residual = inertia + d * (self._gravity + drag.force_n - self._force)
            residual[self._system.free :] = 0
            size = float(np.linalg.norm(residual))
            first = first or size
            if size <= self.model.settings.tolerance * first:
                break
            self._system.add_to_diagonal(drag.damping, d)
            self._system.solver.factorise(self._system.values)
            v = v + self._solved(residual)
        return v

    def _middle(self) -> Floats:
        """The pose predicted for the middle of the step."""
        h, v = self._dt, self._velocity
        return self._u + 0.5 * h * v + 0.125 * h * (v - self._last_velocity)

    def _linearised(self, d: float, pose: Floats) -> tuple[Floats, Floats]:
        """Residual d (f_ext − f_int − (d K + C) v) at the current state, and the damping (N,9) of the drag.

        The element rotations are those of a pose (N,3). Also factorises A = M + d C + d² K, where C includes
        the drag.
        """
        self._assemble(pose, self._u - pose + (d + self.model.beta) * self._velocity, d)
        drag = self._drag.at(self._velocity, self._pressure_pa)
        self._system.add_to_diagonal(drag.damping, d)
        self._system.solver.factorise(self._system.values)
        residual = d * (
            self._gravity
            + drag.force_n
            - self._force
            - (self.model.alpha * self._mass)[:, None] * self._velocity
        )
        residual[self._system.free :] = 0
        return residual, drag.damping

    def _assemble(self, u: Floats, w: Floats, d: float) -> None:
        """Assemble A = M + d C + d² K at u (not factorised) and the force there."""
        alpha, beta = self.model.alpha, self.model.beta
        self._system.assemble(u, w, d * (d + beta), (1 + d * alpha) * self._mass, self._force)

    def _refined(self, d: float, u_known: Floats, v_known: Floats, guess: Floats, first: float) -> Floats:
        """The other `j_max` − 1 Newton iterations on M (v − v_known) = d F(u_known + d v, v).

        They end when the residual is below `tolerance` times `first`, the norm of the first iteration's. An
        iteration that increases the residual is rejected.
        """
        v = accepted = guess
        size = np.inf
        for _ in range(self.model.settings.j_max - 1):
            self._assemble(u_known + d * v, self.model.beta * v, d)
            drag = self._drag.at(v, self._pressure_pa)
            inertia = self._mass[:, None] * (v_known - v - d * self.model.alpha * v)
            residual = inertia + d * (self._gravity + drag.force_n - self._force)
            residual[self._system.free :] = 0
            before, size = size, float(np.linalg.norm(residual))
            if not size < before:
                return accepted
            if size <= self.model.settings.tolerance * first:
                break
            self._system.add_to_diagonal(drag.damping, d)
            self._system.solver.factorise(self._system.values)
            accepted = v
            v = v + self._solved(residual)
        return v

    def _solved(self, residual: Floats) -> Floats:
        self._system.solver.solve(residual)
        return residual

    def _internal(self, system: ElementSystem) -> Floats:
        system.force(self._before, self._zero, self._force)
        relative = self._force - self._gravity
        relative[self._system.free :] = 0
        return relative

    def _stiffness(self, system: ElementSystem, nodes: Int32s) -> Floats:
        """Diagonal blocks of K before the last step at internal nodes."""
        system.assemble(self._before, self._zero, 1.0, np.zeros(len(self._mass)), self._force)
        return system.diagonal_blocks(nodes)


@numba.njit(**JIT)
def _second_stage(
    factors: tuple[float, float, float, float],
    free: int,
    mass_kg: Floats,
    damping: Floats,
    half: Floats,
    v: Floats,
    rise: Floats,
    guess: Floats,
    residual: Floats,
) -> None:  # pragma: no cover  (compiled)
    """guess and residual (N,3) ← first velocity of the second stage of TR-BDF2, and what it leaves.

    K Δv of the first stage follows from its solution: 2 half = ((1 + d α) M + d C_drag) Δv + d (d + β) K Δv.
    ``factors``: d, α, β and _BDF2.
    """
    d, alpha, beta, a = factors
    kept = 1.0 - 2.0 * a * d / (d + beta)
    for n in range(free):
        mass = mass_kg[n]
        for i in range(3):
            dragged = dragged_change = 0.0
            for j in range(3):
                dragged += damping[n, 3 * i + j] * rise[n, j]
                dragged_change += damping[n, 3 * i + j] * (1.0 - kept) * v[n, j]
            damped = (1.0 + d * alpha) * mass * rise[n, i] + d * dragged
            stiff_rise = (2.0 * half[n, i] - damped) / (d * (d + beta))
            guess[n, i] = kept * v[n, i]
            change = (1.0 - kept) * v[n, i]
            pull = half[n, i] + d * alpha * mass * change + d * dragged_change - a * d * d * stiff_rise
            residual[n, i] = mass * (change + a * rise[n, i]) + pull

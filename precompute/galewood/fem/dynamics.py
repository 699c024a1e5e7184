"""Implicit time integration of a tree in the wind."""

import numpy as np

from galewood.fem.assembly import ElementSystem
from galewood.fem.model import FemModel
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
        self._area = model.drag_area_m2[order]
        self._gravity = model.gravity_n[order]
        self._start = model.u_rest[order]
        self._vertices = self._system.rank[: model.vertex_count]
        self._dt = model.settings.dt_s / model.settings.substeps
        self._force = np.empty_like(self._start)
        self._zero = np.zeros_like(self._start)
        self._near: tuple[bytes, ElementSystem] | None = None
        self.reset()

    def reset(self) -> None:
        """Return to the gravity rest pose with zero velocity."""
        self._u = self._start.copy()
        self._velocity = np.zeros_like(self._u)
        self._before = self._u.copy()
        self._recorded: Floats | None = None

    def displace(self, u_m: Floats) -> None:
        """Start at rest from a displacement (N,3), m, of all nodes relative to the gravity rest pose."""
        self.reset()
        self._u += u_m[self._system.order]
        self._u[self._system.free :] = self._start[self._system.free :]
        self._before = self._u.copy()

    @property
    def u(self) -> Floats:
        """(n,3) displacement of the vertices from the gravity rest pose, m (a copy)."""
        return (self._u - self._start)[self._vertices]

    @property
    def v(self) -> Floats:
        """(n,3) velocity of the vertices, m/s (a copy)."""
        return self._velocity[self._vertices]

    @property
    def internal_force(self) -> Floats:
        """(n,3) internal force before the last step minus the gravity it balances, N.

        It is zero at rest and at fixed vertices.
        """
        return self._internal(self._system)[self._vertices]

    @property
    def stiffness_diagonal(self) -> Floats:
        """(n,3,3) diagonal stiffness blocks before the last step, N/m (zero at fixed vertices)."""
        return self._stiffness(self._vertices)

    def recorded_force(self, vertices: Int32s) -> Floats:
        """`internal_force` of the given vertices, (q,3) N."""
        nodes = self._vertices[vertices]
        key = nodes.tobytes()
        if self._near is None or self._near[0] != key:
            self._near = (key, self._system.around(nodes))
        return self._internal(self._near[1])[nodes]

    def recorded_stiffness(self, vertices: Int32s) -> Floats:
        """`stiffness_diagonal` of the given vertices, (q,3,3) N/m."""
        return self._stiffness(self._vertices[vertices])

    def step(self, pressure_pa: Floats) -> None:
        """Advance by the table's time step under a constant pressure (2,) = (p_x, p_z), Pa.

        Raises FloatingPointError if the solution diverges.
        """
        load = self._gravity.copy()
        load[:, 0] += self._area * pressure_pa[0]
        load[:, 2] += self._area * pressure_pa[1]
        self._before[:] = self._u
        self._recorded = None
        for _ in range(self.model.settings.substeps):
            if self.model.settings.scheme == "backward-euler":
                self._backward_euler(load)
            else:
                self._tr_bdf2(load)
        if not np.isfinite(self._u).all():
            raise FloatingPointError("the simulation diverged: the wind is far stronger than the design wind")

    def _backward_euler(self, load: Floats) -> None:
        """One step of the paper's Algorithm 2: at most `j_max` Newton steps from the last velocity."""
        h, u, v = self._dt, self._u, self._velocity
        residual = self._linearised(load, h)
        first = float(np.linalg.norm(residual))
        new = self._refined(load, h, u, v, v + self._solved(residual), first)
        self._u, self._velocity = u + h * new, new

    def _tr_bdf2(self, load: Floats) -> None:
        """One step of TR-BDF2 (Bank et al. 1985): trapezoidal rule to γ h, then BDF2 to h, with the same
        matrix.

        Newton iterations after the first refine only the second stage; in the trapezoidal stage they feed
        back stretch and diverge. Both stages use the forces linearised at the start of the step with fixed
        rotations: forces at extrapolated poses would include the stretch caused by moving a rotating branch
        along a straight line, and become unstable. The second stage therefore needs no new forces, only K Δv,
        which follows from the first solve: A Δv = (1 + d α) M Δv + d (d + β) K Δv.
        """
        d, u, v = _D * self._dt, self._u, self._velocity
        alpha, beta, mass = self.model.alpha, self.model.beta, self._mass[:, None]
        half = self._linearised(load, d)
        first = 2 * float(np.linalg.norm(half))
        rise = self._solved(2 * half)
        stiff_rise = (2 * half - (1 + d * alpha) * mass * rise) / (d * (d + beta))
        middle = v + rise
        a = _BDF2
        guess = (1 - 2 * a * d / (d + beta)) * v
        pull = half + d * alpha * mass * (v - guess) - a * d * d * stiff_rise
        residual = mass * (v + a * rise - guess) + pull
        residual[self._system.free :] = 0
        new = guess + self._solved(residual)
        u_known = u + a * d * (v + middle)
        new = self._refined(load, d, u_known, v + a * (middle - v), new, first)
        self._u, self._velocity = u_known + d * new, new

    def _linearised(self, load: Floats, d: float) -> Floats:
        """d (f_ext − f_int − (d K + C) v) at the current state; also factorises A = M + d C + d² K there."""
        self._assemble(self._u, (d + self.model.beta) * self._velocity, d)
        if self._recorded is None:
            self._recorded = self._system.values[self._system.diagonal].copy()
            self._recorded_step = d
        self._system.solver.factorise(self._system.values)
        residual = d * (load - self._force - (self.model.alpha * self._mass)[:, None] * self._velocity)
        residual[self._system.free :] = 0
        return residual

    def _assemble(self, u: Floats, w: Floats, d: float) -> None:
        """Assemble A = M + d C + d² K at u (not factorised) and the force there."""
        alpha, beta = self.model.alpha, self.model.beta
        self._system.assemble(u, w, d * (d + beta), (1 + d * alpha) * self._mass, self._force)

    def _refined(
        self, load: Floats, d: float, u_known: Floats, v_known: Floats, guess: Floats, first: float
    ) -> Floats:
        """The other `j_max` − 1 Newton iterations on M (v − v_known) = d (f_ext − f_int(u_known + d v) − C
        v).

        An iteration that increases the residual is rejected.
        """
        v = accepted = guess
        size = np.inf
        for _ in range(self.model.settings.j_max - 1):
            self._assemble(u_known + d * v, self.model.beta * v, d)
            inertia = self._mass[:, None] * (v_known - v - d * self.model.alpha * v)
            residual = inertia + d * (load - self._force)
            residual[self._system.free :] = 0
            before, size = size, float(np.linalg.norm(residual))
            if not size < before:
                return accepted
            if size <= self.model.settings.tolerance * first:
                break
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

    def _stiffness(self, nodes: Int32s) -> Floats:
        """Diagonal blocks of K at internal nodes, recovered from the matrix of the step's first solve."""
        if self._recorded is None:
            self._assemble(self._before, self._zero, 1.0)
            self._recorded = self._system.values[self._system.diagonal].copy()
            self._recorded_step = 1.0
        d = self._recorded_step
        blocks = np.zeros((len(nodes), 3, 3))
        free = nodes < self._system.free
        blocks[free] = self._recorded[nodes[free]].reshape(-1, 3, 3)
        blocks[free] -= ((1 + d * self.model.alpha) * self._mass[nodes[free]])[:, None, None] * np.eye(3)
        return blocks / (d * (d + self.model.beta))

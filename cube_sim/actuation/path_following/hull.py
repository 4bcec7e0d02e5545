"""The moving hull as the path-following verdict sees it: inertia, drag, weight and lift as plain numbers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.spatial import cross
from cube_sim.wrench.axes import Matrix, Vector


@dataclass(frozen=True)
class Hull:
    """A rigid body in still water; 6-D in body axes (x forward, y left, z up) at the body origin, planar or not.

    Attributes:
        mass: M_RB + M_A (6,6) [kg, kg m, kg m^2].
        linear_damping: D (6,6) [N s/m, N s, N m s].
        quadratic_damping: D_q (6,6) [N s^2/m^2, ...], acting on |nu| nu.
        weight: m g [N].
        buoyancy: rho V g [N].
        centre_of_mass: r_CG (3,) [m].
        centre_of_buoyancy: r_CB (3,) [m].
    """

    mass: Matrix
    linear_damping: Matrix
    quadratic_damping: Matrix
    weight: float
    buoyancy: float
    centre_of_mass: Vector
    centre_of_buoyancy: Vector

    @staticmethod
    def neutral(length_m: float) -> Hull:
        """A stand-in when no hull is known: 1 kg of equal inertia and drag in all directions, nothing restoring.

        Args:
            length_m: radius of gyration [m].
        """
        per_mass = np.diag([1.0] * 3 + [length_m**2] * 3)
        return Hull(per_mass, per_mass.copy(), np.zeros((6, 6)), 0.0, 0.0, np.zeros(3), np.zeros(3))

    def steady_wrench(self, nu: Vector, up: Vector) -> Vector:
        """The wrench (6,) [N, N m] that keeps nu (6,) steady: C(nu) nu + D nu + D_q |nu| nu + g (Fossen 2011).

        Args:
            nu: [v; w] [m/s, rad/s].
            up: (3,) world up in body axes.
        """
        drag = self.linear_damping @ nu + self.quadratic_damping @ (np.abs(nu) * nu)
        return self._coriolis(nu) + drag - self._hydrostatic(up)

    def steady_wrenches(self, velocities: Matrix, ups: Matrix) -> Matrix:
        """`steady_wrench` (q,6) of many states at once that do not turn: velocities (q,3) [m/s], ups (q,3)."""
        floating = np.column_stack([self._hydrostatic(e) for e in np.eye(3)])
        v, D, D_q = velocities, self.linear_damping[:, :3], self.quadratic_damping[:, :3]
        moving = v @ D.T + (np.abs(v) * v) @ D_q.T
        moving[:, 3:] += np.cross(v, v @ self.mass[:3, :3].T)
        return moving - ups @ floating.T

    def steady_wrench_slope(self, nu: Vector, swing: Vector | None = None) -> Matrix:
        """(6,6) derivative of `steady_wrench` by nu.

        Quadratic drag has no slope at rest, yet it damps: given a `swing` (6,), the amplitude of oscillations about
        nu, its slope is at least that of its describing function, 8 / (3 pi) times the amplitude.

        C(nu) nu is quadratic in nu, so q(nu + e) - q(nu) - q(e) is its derivative along e exactly.
        """
        q = self._coriolis
        turning = np.column_stack([q(nu + e) - q(nu) - q(e) for e in np.eye(6)])
        slope = 2.0 * np.abs(nu)
        if swing is not None:
            slope = np.maximum(slope, 8.0 / (3.0 * np.pi) * swing)
        return turning + self.linear_damping + self.quadratic_damping * slope

    def restoring_slope(self, up: Vector) -> Matrix:
        """(6,3) derivative of the hydrostatic wrench by a small rotation theta in body axes: up' = up x theta."""
        return np.column_stack([self._hydrostatic(cross(up, e)) for e in np.eye(3)])

    def _hydrostatic(self, up: Vector) -> Vector:
        """Weight and lift, linear in `up`."""
        lever = self.buoyancy * self.centre_of_buoyancy - self.weight * self.centre_of_mass
        return np.concatenate([(self.buoyancy - self.weight) * up, cross(lever, up)])

    def _coriolis(self, nu: Vector) -> Vector:
        """C(nu) nu = [w x p; v x p + w x h] with momenta [p; h] = M nu (Fossen 2011, theorem 3.2)."""
        momentum = self.mass @ nu
        v, w, p, h = nu[:3], nu[3:], momentum[:3], momentum[3:]
        return np.concatenate([cross(w, p), cross(v, p) + cross(w, h)])

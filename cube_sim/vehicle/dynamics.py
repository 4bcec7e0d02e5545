"""The equations of motion of one hull, as a controller, an observer or an analysis of its thrusters uses them."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from cube_sim.spatial import Matrix, Record, Vector, skew
from cube_sim.vehicle.laws.hull_motion import (
    HULL,
    inverse_dynamics_of_arrays,
    restoring_slope,
    steady_wrench_slope,
    steady_wrenches,
)


@dataclass(frozen=True)
class Dynamics:
    """Mass, water and weight of a hull; matrices in body axes (x forward, y left, z up) at the body origin.

    A controller may hold one that differs from the simulated vehicle: its knowledge.

    Attributes:
        mass_matrix: M_RB (6,6) [kg, kg m, kg m^2].
        added_mass: M_A (6,6) [kg, kg m, kg m^2].
        linear_damping: D (6,6) [N s/m, N s, N m s].
        quadratic_damping: D_q (6,6) [N s^2/m^2, ...], acting on |nu| nu.
        displaced_mass: rho V [kg].
        centre_of_mass: r_CG (3,) [m].
        centre_of_buoyancy: r_CB (3,) [m].
        gravity: (3,) [m/s^2], world axes.
        velocity_products: P (6,6,6) and
        absolute_products: Q (6,6,6) of what the flow lifts, F_i = sum P_ijk nu_j nu_k + Q_ijk nu_j |nu_k|, relative to
            the water; default nothing.
    """

    mass_matrix: Matrix
    added_mass: Matrix
    linear_damping: Matrix
    quadratic_damping: Matrix
    displaced_mass: float
    centre_of_mass: Vector
    centre_of_buoyancy: Vector
    gravity: Vector
    velocity_products: Matrix = field(default_factory=lambda: np.zeros((6, 6, 6)))
    absolute_products: Matrix = field(default_factory=lambda: np.zeros((6, 6, 6)))

    @staticmethod
    def neutral(length_m: float) -> Dynamics:
        """A stand-in where no hull is known: 1 kg of equal inertia and drag in all directions, without weight or lift.

        Args:
            length_m: radius of gyration [m].
        """
        per_mass = np.diag([1.0] * 3 + [length_m**2] * 3)
        none, origin = np.zeros((6, 6)), np.zeros(3)
        return Dynamics(per_mass, none, per_mass.copy(), none, 0.0, origin, origin, origin)

    @cached_property
    def record(self) -> Record:
        """The same numbers and what follows from them, as compiled functions take them: (1,) of `HULL`."""
        record = np.zeros(1, HULL)
        for name in HULL.names or ():
            record[name] = getattr(self, name)
        return record

    @property
    def lifts(self) -> bool:
        """Whether the flow lifts it."""
        return bool(self.velocity_products.any() or self.absolute_products.any())

    @cached_property
    def total_mass(self) -> Matrix:
        """M = M_RB + M_A (6,6): what accelerates with the hull in still water [kg, kg m, kg m^2]."""
        return self.mass_matrix + self.added_mass

    @property
    def weight(self) -> float:
        """The magnitude of m g [N]."""
        return float(self.mass_matrix[0, 0]) * float(np.linalg.norm(self.gravity))

    @property
    def buoyancy(self) -> float:
        """The magnitude of rho V g [N]."""
        return self.displaced_mass * float(np.linalg.norm(self.gravity))

    @cached_property
    def righting_moment(self) -> Vector:
        """r = rho V |g| r_CB - m |g| r_CG (3,) [N m], body axes: buoyancy and weight turn the hull by r x R' e_z."""
        g = float(np.linalg.norm(self.gravity))
        mass = float(self.mass_matrix[0, 0])
        return g * (self.displaced_mass * self.centre_of_buoyancy - mass * self.centre_of_mass)

    @cached_property
    def hydrostatics(self) -> Matrix:
        """(6,3) [N, N m], body axes: times world up in body axes, R_WB' e_z, the wrench of weight and lift."""
        return np.vstack([(self.buoyancy - self.weight) * np.eye(3), skew(self.righting_moment)])

    def wrench(self, rotation: Matrix, nu: Vector, nu_dot: Vector, current: Vector) -> Vector:
        """Inverse dynamics: the wrench (6,) [N, N m], body axes, under which nu changes at the rate nu_dot.

        Args:
            rotation: R_WB (3,3).
            nu: [v; w] (6,) over ground, body axes.
            nu_dot: its derivative in body axes (6,).
            current: (3,) [m/s], world axes, steady.
        """
        return inverse_dynamics_of_arrays(self.record, rotation, nu, nu_dot, current)

    def damping(self, nu_r: Vector) -> Vector:
        """D nu_r + D_q |nu_r| nu_r (6,) [N, N m]: the wrench against which the water damps, body axes.

        Args:
            nu_r: [v; w] (6,) [m/s, rad/s] relative to the water, body axes.
        """
        return self.linear_damping @ nu_r + self.quadratic_damping @ (np.abs(nu_r) * nu_r)

    def steady_wrenches(self, velocities: Matrix, ups: Matrix) -> Matrix:
        """The wrenches (q,6) [N, N m] that keep q motions without rotation steady, in still water.

        `wrench` of many states at once: drag, Munk moment, what the flow lifts, weight and buoyancy.

        Args:
            velocities: v (q,3) [m/s], body axes.
            ups: (q,3) world up in body axes, R_WB' e_z.
        """
        return steady_wrenches(self.record, np.ascontiguousarray(velocities), np.array(ups))

    def turning_wrenches(self, nus: Matrix, rotations: Matrix) -> Matrix:
        """The wrenches (q,6) [N, N m] under which q motions stand still in body axes, in still water.

        Where they turn, that is a steady turn or a helix about the vertical.

        Args:
            nus: [v; w] (q,6) [m/s, rad/s], body axes.
            rotations: R_WB (q,3,3).
        """
        still, water = np.zeros(6), np.zeros(3)
        wrenches = [self.wrench(R, nu, still, water) for R, nu in zip(rotations, nus, strict=True)]
        return np.array(wrenches).reshape(-1, 6)

    def steady_wrench_slope(self, nu: Vector, swing: Vector | None = None) -> Matrix:
        """(6,6) derivative by nu of the wrench that keeps nu steady in still water: of C(nu) nu + D nu + D_q |nu| nu.

        What the flow lifts is taken off.

        Args:
            nu: [v; w] (6,) [m/s, rad/s], body axes.
            swing: (6,) amplitude of oscillations about nu [m/s, rad/s]. Quadratic drag has no slope at rest, yet it
                damps: its slope is taken to be at least that of its describing function, 8 / (3 pi) times the
                amplitude. Default none.
        """
        return steady_wrench_slope(self.record, nu, np.zeros(6) if swing is None else swing)

    def restoring_slope(self, up: Vector) -> Matrix:
        """(6,3) [N/rad, N m/rad] derivative of weight and lift by a small rotation theta in body axes.

        Args:
            up: (3,) world up in body axes; it turns as up' = up x theta.
        """
        return restoring_slope(self.record, (up[0], up[1], up[2]))

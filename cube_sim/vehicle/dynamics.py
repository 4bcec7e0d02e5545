"""The equations of motion of one hull, as a controller, an observer or an analysis of its thrusters uses them."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Matrix, Vector, skew
from cube_sim.vehicle.laws.hydrodynamics import coriolis, water_wrench
from cube_sim.vehicle.laws.tuples import cross_tuples, matrix_times_tuple, to_body


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
    """

    mass_matrix: Matrix
    added_mass: Matrix
    linear_damping: Matrix
    quadratic_damping: Matrix
    displaced_mass: float
    centre_of_mass: Vector
    centre_of_buoyancy: Vector
    gravity: Vector

    @staticmethod
    def neutral(length_m: float) -> Dynamics:
        """A stand-in where no hull is known: 1 kg of equal inertia and drag in all directions, without weight or lift.

        Args:
            length_m: radius of gyration [m].
        """
        per_mass = np.diag([1.0] * 3 + [length_m**2] * 3)
        none, origin = np.zeros((6, 6)), np.zeros(3)
        return Dynamics(per_mass, none, per_mass.copy(), none, 0.0, origin, origin, origin)

    @property
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

    @property
    def righting_moment(self) -> Vector:
        """r = rho V |g| r_CB - m |g| r_CG (3,) [N m], body axes: buoyancy and weight turn the hull by r x R' e_z."""
        g = float(np.linalg.norm(self.gravity))
        mass = float(self.mass_matrix[0, 0])
        return g * (self.displaced_mass * self.centre_of_buoyancy - mass * self.centre_of_mass)

    @property
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
        return np.array(
            inverse_dynamics(
                self.mass_matrix,
                self.added_mass,
                self.linear_damping,
                self.quadratic_damping,
                self.displaced_mass,
                self.centre_of_mass,
                self.centre_of_buoyancy,
                self.gravity,
                rotation,
                nu,
                nu_dot,
                current,
            )
        )

    def damping(self, nu_r: Vector) -> Vector:
        """D nu_r + D_q |nu_r| nu_r (6,) [N, N m]: the wrench against which the water damps, body axes.

        Args:
            nu_r: [v; w] (6,) [m/s, rad/s] relative to the water, body axes.
        """
        return self.linear_damping @ nu_r + self.quadratic_damping @ (np.abs(nu_r) * nu_r)

    def steady_wrenches(self, velocities: Matrix, ups: Matrix) -> Matrix:
        """The wrenches (q,6) [N, N m] that keep q motions without rotation steady, in still water.

        `wrench` of many states at once: drag, Munk moment, weight and lift.

        Args:
            velocities: v (q,3) [m/s], body axes.
            ups: (q,3) world up in body axes, R_WB' e_z.
        """
        v, D, D_q = velocities, self.linear_damping[:, :3], self.quadratic_damping[:, :3]
        moving = v @ D.T + (np.abs(v) * v) @ D_q.T
        moving[:, 3:] += np.cross(v, v @ self.total_mass[:3, :3].T)
        return moving - ups @ self.hydrostatics.T

    def steady_wrench_slope(self, nu: Vector, swing: Vector | None = None) -> Matrix:
        """(6,6) derivative by nu of the wrench that keeps nu steady in still water: of C(nu) nu + D nu + D_q |nu| nu.

        With the momenta [p; h] = M nu, C(nu) nu = [w x p; v x p + w x h] (Fossen 2011, theorem 3.2). Its derivative is
        [[S(w), 0], [S(v), S(w)]] M - [[0, S(p)], [S(p), S(h)]].

        Args:
            nu: [v; w] (6,) [m/s, rad/s], body axes.
            swing: (6,) amplitude of oscillations about nu [m/s, rad/s]. Quadratic drag has no slope at rest, yet it
                damps: its slope is taken to be at least that of its describing function, 8 / (3 pi) times the
                amplitude. Default none.
        """
        M = self.total_mass
        momentum, none = M @ nu, np.zeros((3, 3))
        v, w, p, h = skew(nu[:3]), skew(nu[3:]), skew(momentum[:3]), skew(momentum[3:])
        turning = np.block([[w, none], [v, w]]) @ M - np.block([[none, p], [p, h]])
        slope = 2.0 * np.abs(nu)
        if swing is not None:
            slope = np.maximum(slope, 8.0 / (3.0 * np.pi) * swing)
        return turning + self.linear_damping + self.quadratic_damping * slope

    def restoring_slope(self, up: Vector) -> Matrix:
        """(6,3) [N/rad, N m/rad] derivative of weight and lift by a small rotation theta in body axes.

        Args:
            up: (3,) world up in body axes; it turns as up' = up x theta.
        """
        return self.hydrostatics @ skew(up)


@compiled
def inverse_dynamics(M_RB, M_A, D, D_q, displaced_mass, r_CG, r_CB, gravity, R_WB, nu, nu_dot, v_c_W):
    """tau = M_RB nu' + C_RB nu + M_A a - (everything else the water does) - weight, as a 6-tuple.

    Arguments as in `Dynamics`; a = [v' + w x v; w'] as in `cube_sim.vehicle.laws.hydrodynamics.water_wrench`.
    """
    velocity = (nu[0], nu[1], nu[2], nu[3], nu[4], nu[5])
    rate = (nu_dot[0], nu_dot[1], nu_dot[2], nu_dot[3], nu_dot[4], nu_dot[5])
    turning = cross_tuples(velocity[3:], velocity[:3])
    classical = (rate[0] + turning[0], rate[1] + turning[1], rate[2] + turning[2], rate[3], rate[4], rate[5])
    rigid, c = matrix_times_tuple(M_RB, rate), coriolis(M_RB, velocity)
    added = matrix_times_tuple(M_A, classical)
    lift = (-displaced_mass * gravity[0], -displaced_mass * gravity[1], -displaced_mass * gravity[2])
    current = (v_c_W[0], v_c_W[1], v_c_W[2])
    water = water_wrench(M_A, D, D_q, R_WB, velocity, current, lift, (r_CB[0], r_CB[1], r_CB[2]))
    m = M_RB[0, 0]
    weight = to_body(R_WB, (m * gravity[0], m * gravity[1], m * gravity[2]))
    moment = cross_tuples((r_CG[0], r_CG[1], r_CG[2]), weight)
    return (
        rigid[0] + c[0] + added[0] - water[0] - weight[0],
        rigid[1] + c[1] + added[1] - water[1] - weight[1],
        rigid[2] + c[2] + added[2] - water[2] - weight[2],
        rigid[3] + c[3] + added[3] - water[3] - moment[0],
        rigid[4] + c[4] + added[4] - water[4] - moment[1],
        rigid[5] + c[5] + added[5] - water[5] - moment[2],
    )

"""Small motions about a steady straight course: what the thrusters steer and what the water damps.

The state is x = [e, theta, delta nu]: position off the course, small rotation and velocity change, all in the axes
the body has on the course. With v_0 the course velocity
    e' = delta v + theta x v_0,   theta' = delta w,
    M delta nu' = A delta F_m - (d steady wrench / d nu) delta nu + (d hydrostatic / d theta) theta.
Position along the course is left out: the target on the path waits (s' = v_T + k2 s1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.spatial import cross, skew
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.axes import PLANAR, SPATIAL, Matrix, Vector
from cube_sim.wrench.zonotope import facets

_NEUTRAL = 1e-6
_STEERED = 1e-6
_VERTICAL = 1e-6


@dataclass(frozen=True)
class LinearMotion:
    """x' = drift x + steer delta F_m.

    Attributes:
        drift: (k,k).
        steer: (k,m).
        off_course: (c,k) rows that read the cross-track displacements [m] from x.
        names: (k,) what the states are.
    """

    drift: Matrix
    steer: Matrix
    off_course: Matrix
    names: tuple[str, ...]

    def loose(self, time_s: float, length_m: float) -> tuple[str, ...]:
        """Motions that neither thrusters nor water hold: those in uncontrollable modes that do not decay (PBH test).

        Args:
            time_s: unit of time the test is made in.
            length_m: unit of length.
        """
        drift, steer = self._scaled(time_s, length_m)
        found: set[str] = set()
        for at in _lasting(drift):
            pencil = np.hstack([at * np.eye(len(drift)) - drift, steer])
            U, sigma, _ = np.linalg.svd(pencil)
            for w in np.abs(U[:, sigma < _STEERED * max(sigma[0], 1.0)]).T:
                found.update(self._moving_in(w))
        return self._motions(found)

    def one_way(self, low: Vector, high: Vector, time_s: float, length_m: float) -> tuple[str, ...]:
        """Motions that do not decay and that the thrusters, within their limits, push in one direction only.

        Along a left eigenvector w of an eigenvalue that is real and not negative, w . x obeys the forces alone; it can
        be brought back from both sides only if w . steer delta F takes both signs (Brammer, SIAM J. Control 10, 1972).

        Args:
            low: (m,) what each force may change by downwards [N].
            high: (m,) and upwards [N].
            time_s: unit of time the test is made in.
            length_m: unit of length.
        """
        drift, steer = self._scaled(time_s, length_m)
        found: set[str] = set()
        for at in _lasting(drift):
            if np.iscomplex(at):
                continue
            U, sigma, _ = np.linalg.svd(at.real * np.eye(len(drift)) - drift)
            W = U[:, sigma < _STEERED * max(sigma[0], 1.0)]
            pushes = W.T @ steer
            if W.shape[1] == 0 or np.linalg.matrix_rank(pushes, _STEERED) < W.shape[1]:
                continue
            normals, reach = facets(pushes, low, high)
            for w in np.abs(normals[reach <= _STEERED * np.max(reach)] @ W.T):
                found.update(self._moving_in(w))
        return self._motions(found)

    def sampled(self, step_s: float) -> tuple[Matrix, Matrix]:
        """x_j+1 = forward x_j + push u_j for forces held over a step."""
        from scipy.linalg import expm

        k, m = self.steer.shape
        together = np.zeros((k + m, k + m))
        together[:k, :k], together[:k, k:] = self.drift, self.steer
        whole = np.asarray(expm(together * step_s), dtype=np.float64)
        return whole[:k, :k], whole[:k, k:]

    @property
    def angles(self) -> list[int]:
        """Which states are small rotations [rad]."""
        return [i for i, name in enumerate(self.names) if name in _ANGLES]

    @property
    def speeds(self) -> list[int]:
        """Which states are changes of the velocity [m/s]."""
        return [i for i, name in enumerate(self.names) if name in _VELOCITIES[:3]]

    @property
    def rates(self) -> list[int]:
        """Which states are angular velocities [rad/s]."""
        return [i for i, name in enumerate(self.names) if name in _VELOCITIES[3:]]

    def _scaled(self, time_s: float, length_m: float) -> tuple[Matrix, Matrix]:
        """Drift and steer in units of the body and its course, or of its fastest motion where that is faster."""
        time_s = 1.0 / max(1.0 / time_s, float(np.max(np.abs(np.linalg.eigvals(self.drift)))))
        unit = np.array([length_m if name in _LENGTHS else 1.0 for name in self.names])
        rate = np.array([time_s if name in _RATES else 1.0 for name in self.names])
        T = rate / unit
        steer = T[:, None] * self.steer
        return time_s * T[:, None] * self.drift / T, steer / max(float(np.linalg.norm(steer, 2)), np.finfo(float).tiny)

    def _moving_in(self, w: Vector) -> list[str]:
        return [self.names[i] for i in np.flatnonzero(w > 0.3 * np.max(w))]

    def _motions(self, found: set[str]) -> tuple[str, ...]:
        return tuple(dict.fromkeys(name.split()[0] for name in self.names if name in found))


def _lasting(drift: Matrix) -> list[complex]:
    """Eigenvalues that do not decay. A defective one comes out spread by the root of round-off: neutral ones are 0."""
    lasting = [value for value in np.linalg.eigvals(drift) if value.real >= -_NEUTRAL]
    return list(dict.fromkeys(0j if abs(value) < 1e-3 else complex(value) for value in lasting))


_LENGTHS = {"sway off course", "heave off course", "surge speed", "sway speed", "heave speed"}
_RATES = {"surge speed", "sway speed", "heave speed", "roll rate", "pitch rate", "yaw rate"}
_VELOCITIES = ("surge speed", "sway speed", "heave speed", "roll rate", "pitch rate", "yaw rate")
_ANGLES = ("roll", "pitch", "yaw")


def linearise(hull: Dynamics, A: Matrix, velocity: Vector, up: Vector, swing: Vector | None = None) -> LinearMotion:
    """Small motions about a straight course.

    Args:
        hull: the body.
        A: (6,m), or (3,m) for motion in the plane z = 0 only.
        velocity: v_0 (3,) [m/s], body axes, not zero.
        up: (3,) world up in body axes.
        swing: (6,) amplitude [m/s, rad/s] at which quadratic drag is taken to damp; default none.
    """
    planar = len(A) == 3
    moving = (PLANAR if planar else SPATIAL).rows
    turning = [2] if planar else [0, 1, 2]
    across = _across(velocity, up, planar)
    c, r, k = len(across), len(turning), len(moving)
    M = hull.total_mass[np.ix_(moving, moving)]
    damping = hull.steady_wrench_slope(np.concatenate([velocity, np.zeros(3)]), swing)[np.ix_(moving, moving)]
    restoring = hull.restoring_slope(up)[np.ix_(moving, turning)]
    translation = [i for i, axis in enumerate(moving) if axis < 3]
    drift = np.zeros((c + r + k, c + r + k))
    drift[:c, c : c + r] = across @ -skew(velocity)[:, turning]
    drift[:c, [c + r + i for i in translation]] = across[:, [moving[i] for i in translation]]
    drift[c : c + r, [c + r + moving.index(3 + t) for t in turning]] = np.eye(r)
    drift[c + r :, c : c + r] = np.linalg.solve(M, restoring)
    drift[c + r :, c + r :] = -np.linalg.solve(M, damping)
    steer = np.zeros((c + r + k, A.shape[1]))
    steer[c + r :] = np.linalg.solve(M, A)
    return LinearMotion(
        drift=drift,
        steer=steer,
        off_course=np.eye(c, c + r + k),
        names=(
            *("sway off course", "heave off course")[:c],
            *(_ANGLES[t] for t in turning),
            *(_VELOCITIES[i] for i in moving),
        ),
    )


def _across(velocity: Vector, up: Vector, planar: bool) -> Matrix:
    """(c,3) orthonormal directions across the course: to the side and, in 3-D, upwards."""
    side = cross(np.array([0.0, 0.0, 1.0]) if planar else up, velocity)
    if np.linalg.norm(side) <= _VERTICAL * np.linalg.norm(velocity):
        return np.linalg.svd(velocity[None, :])[2][1:]
    across = np.array([side, cross(velocity, side)])[: 1 if planar else 2]
    return across / np.linalg.norm(across, axis=1, keepdims=True)

"""Small motions about a trim condition: what the thrusters control and what the water damps.

The state is x = [e, theta, delta nu]: position off the course, small rotation and velocity change, all in the axes
the body has on the course. With v_0 the velocity of the course
    e' = delta v + theta x v_0,   theta' = delta w,
    (M_RB + M_A) delta nu' = A_F delta F_m - (d steady wrench / d nu) delta nu + (d hydrostatic / d theta) theta,
A_F the actuation matrix. Together they are x' = A x + B delta F_m.
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
_CONTROLLED = 1e-6
_VERTICAL = 1e-6


@dataclass(frozen=True)
class LinearMotion:
    """x' = A x + B delta F_m, displacements C x; x in m, rad, m/s and rad/s, delta F_m in N.

    Attributes:
        A: (k,k).
        B: (k,m).
        C: (c,k) rows that read the cross-track displacements [m] from x.
        names: (k,) what the states are.
    """

    A: Matrix
    B: Matrix
    C: Matrix
    names: tuple[str, ...]

    def uncontrolled_modes(self, time_s: float, length_m: float) -> tuple[str, ...]:
        """Motions in modes that neither decay nor are controllable.

        The test is that of Popov, Belevitch and Hautus: a mode of the eigenvalue lambda is not controllable where
        w' [lambda 1 - A, B] = 0 for some w.

        Args:
            time_s: unit of time the test is made in.
            length_m: unit of length.
        """
        A, B = self._scaled(time_s, length_m)
        found: set[str] = set()
        for at in _lasting(A):
            pencil = np.hstack([at * np.eye(len(A)) - A, B])
            U, sigma, _ = np.linalg.svd(pencil)
            for w in np.abs(U[:, sigma < _CONTROLLED * max(sigma[0], 1.0)]).T:
                found.update(self._moving_in(w))
        return self._motions(found)

    def one_sided_modes(self, low: Vector, high: Vector, time_s: float, length_m: float) -> tuple[str, ...]:
        """Motions in modes that do not decay and that the thrusters, within their limits, push to one side only.

        Along a left eigenvector w of an eigenvalue that is real and not negative, w . x obeys the forces alone. It can
        be brought back from both sides only if w . B delta F_m takes both signs (Brammer, SIAM J. Control 10, 1972).

        Args:
            low: (m,) what each force may change by downwards [N].
            high: (m,) and upwards [N].
            time_s: unit of time the test is made in.
            length_m: unit of length.
        """
        A, B = self._scaled(time_s, length_m)
        found: set[str] = set()
        for at in _lasting(A):
            if np.iscomplex(at):
                continue
            U, sigma, _ = np.linalg.svd(at.real * np.eye(len(A)) - A)
            W = U[:, sigma < _CONTROLLED * max(sigma[0], 1.0)]
            pushes = W.T @ B
            if W.shape[1] == 0 or np.linalg.matrix_rank(pushes, _CONTROLLED) < W.shape[1]:
                continue
            normals, offsets = facets(pushes, low, high)
            for w in np.abs(normals[offsets <= _CONTROLLED * np.max(offsets)] @ W.T):
                found.update(self._moving_in(w))
        return self._motions(found)

    def sampled(self, step_s: float) -> tuple[Matrix, Matrix]:
        """A_d (k,k) and B_d (k,m) of x_j+1 = A_d x_j + B_d u_j, for forces held over a step (zero-order hold).

        exp([[A, B], [0, 0]] T) = [[A_d, B_d], [0, 1]].

        Args:
            step_s: T.
        """
        from scipy.linalg import expm

        k, m = self.B.shape
        together = np.zeros((k + m, k + m))
        together[:k, :k], together[:k, k:] = self.A, self.B
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
        """A and B in units of the body and its course, or of its fastest motion where that is faster; |B| = 1."""
        time_s = 1.0 / max(1.0 / time_s, float(np.max(np.abs(np.linalg.eigvals(self.A)))))
        unit = np.array([length_m if name in _LENGTHS else 1.0 for name in self.names])
        rate = np.array([time_s if name in _RATES else 1.0 for name in self.names])
        T = rate / unit
        B = T[:, None] * self.B
        return time_s * T[:, None] * self.A / T, B / max(float(np.linalg.norm(B, 2)), np.finfo(float).tiny)

    def _moving_in(self, w: Vector) -> list[str]:
        """The states that take the larger part in a mode, |w| (k,)."""
        return [self.names[i] for i in np.flatnonzero(w > 0.3 * np.max(w))]

    def _motions(self, found: set[str]) -> tuple[str, ...]:
        """Surge, sway, heave, roll, pitch and yaw of these states, each once."""
        return tuple(dict.fromkeys(name.split()[0] for name in self.names if name in found))


def _lasting(A: Matrix) -> list[complex]:
    """Eigenvalues of modes that do not decay.

    Round-off spreads a defective one by its root: those next to 0 are 0.
    """
    lasting = [value for value in np.linalg.eigvals(A) if value.real >= -_NEUTRAL]
    return list(dict.fromkeys(0j if abs(value) < 1e-3 else complex(value) for value in lasting))


_LENGTHS = {"sway off course", "heave off course", "surge speed", "sway speed", "heave speed"}
_RATES = {"surge speed", "sway speed", "heave speed", "roll rate", "pitch rate", "yaw rate"}
_VELOCITIES = ("surge speed", "sway speed", "heave speed", "roll rate", "pitch rate", "yaw rate")
_ANGLES = ("roll", "pitch", "yaw")


def linearise(
    hull: Dynamics, actuation_matrix: Matrix, velocity: Vector, up: Vector, swing: Vector | None = None
) -> LinearMotion:
    """Small motions about a straight course.

    Args:
        hull: the body.
        actuation_matrix: A_F (6,m), or (3,m) for motion in the plane z = 0 only.
        velocity: v_0 (3,) [m/s], body axes, not zero.
        up: (3,) world up in body axes.
        swing: (6,) amplitude [m/s, rad/s] at which quadratic drag is taken to damp; default none.
    """
    planar = len(actuation_matrix) == 3
    moving = (PLANAR if planar else SPATIAL).rows
    turning = [2] if planar else [0, 1, 2]
    across = _across(velocity, up, planar)
    c, r, k = len(across), len(turning), len(moving)
    M = hull.total_mass[np.ix_(moving, moving)]
    damping = hull.steady_wrench_slope(np.concatenate([velocity, np.zeros(3)]), swing)[np.ix_(moving, moving)]
    restoring = hull.restoring_slope(up)[np.ix_(moving, turning)]
    translation = [i for i, axis in enumerate(moving) if axis < 3]
    A = np.zeros((c + r + k, c + r + k))
    A[:c, c : c + r] = across @ -skew(velocity)[:, turning]
    A[:c, [c + r + i for i in translation]] = across[:, [moving[i] for i in translation]]
    A[c : c + r, [c + r + moving.index(3 + t) for t in turning]] = np.eye(r)
    A[c + r :, c : c + r] = np.linalg.solve(M, restoring)
    A[c + r :, c + r :] = -np.linalg.solve(M, damping)
    B = np.zeros((c + r + k, actuation_matrix.shape[1]))
    B[c + r :] = np.linalg.solve(M, actuation_matrix)
    return LinearMotion(
        A=A,
        B=B,
        C=np.eye(c, c + r + k),
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

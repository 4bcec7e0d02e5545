"""Published equations of motion of torpedo-shaped vehicles, as their authors print them: FRD, z down, scalar by scalar.

Nothing here knows cube_sim, but for the turn between its axes and these.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from scipy.integrate import solve_ivp

FLIP = np.array([1.0, -1.0, -1.0])


@dataclass(frozen=True)
class RigidBody:
    """Mass; moments (I_x, I_y, I_z) and products (I_xy, I_xz, I_yz) of inertia about the origin; centre of mass."""

    mass: float
    inertia: tuple[float, float, float]
    centre: tuple[float, float, float]
    added: dict[str, float] = field(default_factory=dict)
    products: tuple[float, float, float] = (0.0, 0.0, 0.0)

    def matrix(self) -> np.ndarray:
        """What multiplies the accelerations (u', v', w', p', q', r'); X_udot and the like on their places."""
        m, (x, y, z) = self.mass, self.centre
        M = np.diag([m, m, m, *self.inertia])
        M[0, 4], M[0, 5], M[1, 3], M[1, 5], M[2, 3], M[2, 4] = m * z, -m * y, -m * z, m * x, m * y, -m * x
        M[3:, :3] = M[:3, 3:].T
        M[3:, 3:] -= self._off_diagonal()
        for name, value in self.added.items():
            M["XYZKMN".index(name[0]), "uvwpqr".index(name[1])] -= value
        return M

    def turning(self, nu: np.ndarray) -> np.ndarray:
        """What else stands on their left side (Prestero 2001, equation 3.8; with products of inertia, w x I w)."""
        m, (xg, yg, zg), (Ix, Iy, Iz) = self.mass, self.centre, self.inertia
        u, v, w, p, q, r = nu.tolist()
        lopsided = np.concatenate([np.zeros(3), np.cross(nu[3:], -self._off_diagonal() @ nu[3:])])
        return lopsided + np.array(
            [
                m * (-v * r + w * q - xg * (q * q + r * r) + yg * p * q + zg * p * r),
                m * (-w * p + u * r - yg * (r * r + p * p) + zg * q * r + xg * q * p),
                m * (-u * q + v * p - zg * (p * p + q * q) + xg * r * p + yg * r * q),
                (Iz - Iy) * q * r + m * (yg * (-u * q + v * p) - zg * (-w * p + u * r)),
                (Ix - Iz) * r * p + m * (zg * (-v * r + w * q) - xg * (-u * q + v * p)),
                (Iy - Ix) * p * q + m * (xg * (-w * p + u * r) - yg * (-v * r + w * q)),
            ]
        )

    def _off_diagonal(self) -> np.ndarray:
        Ixy, Ixz, Iyz = self.products
        return np.array([[0.0, Ixy, Ixz], [Ixy, 0.0, Iyz], [Ixz, Iyz, 0.0]])


def hydrostatics(rotation: np.ndarray, W: float, B: float, centre, buoyant) -> np.ndarray:
    """Weight at the centre of mass, lift at that of buoyancy; rotation from FRD to NED."""
    down = rotation[2]
    lever = skew(W * np.array(centre) - B * np.array(buoyant))
    return np.concatenate([(W - B) * down, lever @ down])


def skew(a: np.ndarray) -> np.ndarray:
    """S(a) b = a x b."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def servo(target: float, angle: float, lag_s: float, rate: float) -> float:
    return min(max((target - angle) / lag_s, -rate), rate)


def rotation(q: np.ndarray) -> np.ndarray:
    w, x, y, z = (q / np.sqrt(q @ q)).tolist()
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )


def kinematics(q: np.ndarray, nu: np.ndarray) -> np.ndarray:
    """d/dt of position and quaternion."""
    w, x, y, z = q.tolist()
    p, r_, s = nu[3:].tolist()
    turned = 0.5 * np.array(
        [-x * p - y * r_ - z * s, w * p + y * s - z * r_, w * r_ + z * p - x * s, w * s + x * r_ - y * p]
    )
    return np.concatenate([rotation(q) @ nu[:3], turned])


def integrated(rate: Callable, start: np.ndarray, duration: float) -> np.ndarray:
    """The state after `duration` of constant inputs, by DOP853."""
    return solve_ivp(rate, (0.0, duration), start, method="DOP853", rtol=1e-10, atol=1e-11).y[:, -1]

"""The inertial unit's readings integrated: one tick of the nominal state and of its covariance.

The state x is [p (3), v (3), q_WB (4), b_gyro (3), b_accelerometer (3), constants of the aids (c)], p and v in world
axes; its error, by which the covariance P is taken, is [dp, dv, phi, db_gyro, db_accelerometer, d constants] with
R_true = Exp(phi) R: the attitude error is a rotation vector in world axes, without a singularity at any attitude.
"""

from __future__ import annotations

from math import atan2, cos, sin, sqrt

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.tuples import quaternion_from_matrix

POSITION, VELOCITY, ATTITUDE = slice(0, 3), slice(3, 6), slice(6, 9)
GYRO_BIAS, ACCELEROMETER_BIAS = slice(9, 12), slice(12, 15)
CONSTANTS = 15
"""Where the constants of the aids begin in the error; in x one place later."""


@compiled
def turned(q, angle):
    """Quaternion (4,) wxyz after a turn by a rotation vector (3,) in body axes, q * exp(angle / 2)."""
    size = sqrt(angle[0] ** 2 + angle[1] ** 2 + angle[2] ** 2)
    # sin(size / 2) / size, by its series where the quotient would lose digits
    scale = 0.5 - size * size / 48.0 if size < 1e-4 else sin(0.5 * size) / size
    w, x, y, z = cos(0.5 * size), scale * angle[0], scale * angle[1], scale * angle[2]
    a = q[0] * w - q[1] * x - q[2] * y - q[3] * z
    b = q[0] * x + q[1] * w + q[2] * z - q[3] * y
    c = q[0] * y - q[1] * z + q[2] * w + q[3] * x
    d = q[0] * z + q[1] * y - q[2] * x + q[3] * w
    norm = sqrt(a * a + b * b + c * c + d * d)
    product = np.empty(4)
    product[0], product[1], product[2], product[3] = a / norm, b / norm, c / norm, d / norm
    return product


@compiled
def rotation(q):
    """R (3,3) of a unit quaternion wxyz."""
    w, x, y, z = q[0], q[1], q[2], q[3]
    R = np.empty((3, 3))
    R[0, 0], R[0, 1], R[0, 2] = 1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)
    R[1, 0], R[1, 1], R[1, 2] = 2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)
    R[2, 0], R[2, 1], R[2, 2] = 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
    return R


@compiled
def rotation_vector(R):
    """The rotation vector, a 3-tuple [rad], of R (3,3), at most pi long."""
    w, x, y, z = quaternion_from_matrix(R)
    size = sqrt(x * x + y * y + z * z)
    scale = 2.0 * atan2(size, w) / size if size > 0.0 else 2.0
    return (scale * x, scale * y, scale * z)


@compiled
def carried_on(P, D):
    """(I + D) P (I + D)', a new array, where only the first rows of D, which are given, are not zero.

    A function of its own: known to have nine rows, its loops would be unrolled into a hundred.
    """
    size = len(P)
    half = P.copy()
    for i in range(D.shape[0]):
        for k in range(D.shape[1]):
            if D[i, k] != 0.0:
                for j in range(size):
                    half[i, j] += D[i, k] * P[k, j]
    whole = half.copy()
    for j in range(D.shape[0]):
        for k in range(D.shape[1]):
            if D[j, k] != 0.0:
                for i in range(size):
                    whole[i, j] += D[j, k] * half[i, k]
    return whole


@compiled
def predict(x, P, mean, gravity, dt, noise, walk):
    """State and covariance one tick later.

    q+ = q exp(w dt / 2) and v+ = v + (R f + g) dt hold exactly, w and f being means as the unit makes them; of position
    p+ = p + (v + v+) dt / 2 is exact to second order in dt. The error obeys dp' = dv, dv' = -S(a) phi - R db_a - n_a,
    phi' = -R db_g - n_g, a = R f: phi is constant but for the gyro's errors, because it is taken in world axes (J. Sola
    2017, "Quaternion kinematics for the error-state Kalman filter", section 7, gives the same with `global` angular
    errors).

    Args:
        x: (16 + c,) state at the earlier tick.
        P: (15 + c, 15 + c) covariance of its error.
        mean: (6,) angular velocity [rad/s] and specific force [m/s^2] over the tick, or more numbers behind them, as in
            a reading of `cube_sim.navigation.imu`.
        gravity: (3,) world axes [m/s^2].
        dt: length of the tick [s].
        noise: (6,) densities of the noise [rad/s/sqrt(Hz), m/s^2/sqrt(Hz)].
        walk: (6,) densities of the biases' walks.

    Returns:
        The later x and P, new arrays.
    """
    angle, a = np.empty(3), np.zeros(3)
    for i in range(3):
        angle[i] = dt * (mean[i] - x[10 + i])
    q_now = turned(x[6:10], angle)
    R, R_now = rotation(x[6:10]), rotation(q_now)
    for i in range(3):
        for j in range(3):
            a[i] += R[i, j] * (mean[3 + j] - x[13 + j])
    later = x.copy()
    for i in range(3):
        later[i] += dt * x[3 + i] + 0.5 * dt * dt * (a[i] + gravity[i])
        later[3 + i] += dt * (a[i] + gravity[i])
    for i in range(4):
        later[6 + i] = q_now[i]

    # D: what the error's first nine rows gain over the tick from its rows 3 to 14
    D = np.zeros((9, 15))
    S = np.zeros((3, 3))
    S[0, 1], S[0, 2], S[1, 2] = -a[2], a[1], -a[0]
    S[1, 0], S[2, 0], S[2, 1] = a[2], -a[1], a[0]
    for i in range(3):
        D[i, 3 + i] = dt
        for j in range(3):
            D[3 + i, 6 + j] = -dt * S[i, j]
            D[3 + i, 12 + j] = -dt * R[i, j]
            D[6 + i, 9 + j] = -0.5 * dt * (R[i, j] + R_now[i, j])
            D[i, 6 + j] = 0.5 * dt * D[3 + i, 6 + j]
            D[i, 12 + j] = 0.5 * dt * D[3 + i, 12 + j]
    whole, size = carried_on(P, D), len(P)
    for i in range(3):
        n_a = noise[3 + i] ** 2
        whole[i, i] += n_a * dt**3 / 3.0
        whole[i, 3 + i] += n_a * dt**2 / 2.0
        whole[3 + i, i] += n_a * dt**2 / 2.0
        whole[3 + i, 3 + i] += n_a * dt
        whole[6 + i, 6 + i] += noise[i] ** 2 * dt
        whole[9 + i, 9 + i] += walk[i] ** 2 * dt
        whole[12 + i, 12 + i] += walk[3 + i] ** 2 * dt
    for i in range(size):
        for j in range(i):
            whole[i, j] = whole[j, i] = 0.5 * (whole[i, j] + whole[j, i])
    return later, whole

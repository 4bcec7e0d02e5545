"""Rotations and cross products: the few formulas every other module leans on.

Quaternions are wxyz, unit, body to world.
"""

from __future__ import annotations

from math import atan2, cos, sin, sqrt
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

Vector = NDArray[np.float64]
Matrix = NDArray[np.float64]
Record = NDArray[np.void]
"""A structured array of one element: named numbers, as compiled functions take them."""


LARGEST = 1e30
"""No number from outside may be larger: the fourth powers of such are still numbers."""


def real_numbers(thing: Any) -> Vector | None:
    """A copy of what is real numbers, as float64; None for what is not: text that reads like one, complex numbers."""
    try:
        array = np.asarray(thing)
        strange = array.dtype.kind not in "biufO" or any(isinstance(each, str | bytes) for each in array.flat)
        return None if strange else np.array(array, dtype=np.float64)
    except Exception:  # whatever an object says that is no array
        return None


class State(NamedTuple):
    """Where a vehicle is and how it moves.

    Attributes:
        position: p_WB (3,) [m], world axes.
        quaternion: q_WB (4,) wxyz.
        rotation: R_WB (3,3), the same attitude.
        velocity: v (3,) of the body origin [m/s], body axes.
        rates: w (3,) [rad/s], body axes.
    """

    position: Vector
    quaternion: Vector
    rotation: Matrix
    velocity: Vector
    rates: Vector


def skew(a: ArrayLike) -> Matrix:
    """S(a) with S(a) b = a x b."""
    x, y, z = np.asarray(a, dtype=float)
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def cross(a: Vector, b: Vector) -> Vector:
    """a x b of two (3,) arrays; np.cross costs ten times as much on vectors this short."""
    return np.array([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


def rotation_from_quaternion(q: ArrayLike) -> Matrix:
    """R (3,3) of a unit quaternion wxyz."""
    return np.array(rotation_components(tuple(float(value) for value in np.asarray(q))))


def rotation_components(q):  # type: ignore[no-untyped-def]
    """`rotation_from_quaternion` of a 4-tuple, as a tuple of rows; compiled in `cube_sim.tuples`."""
    w, x, y, z = q
    return (
        (1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)),
        (2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)),
        (2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)),
    )


def quaternion_components(R):  # type: ignore[no-untyped-def]
    """`quaternion_from_rotation` as a 4-tuple; compiled in `cube_sim.tuples`."""
    r, s, t = R[0, 0], R[1, 1], R[2, 2]
    trace = r + s + t
    x2, y2, z2 = 2.0 * r - trace, 2.0 * s - trace, 2.0 * t - trace  # 4 q_i^2 - 1
    if trace >= max(x2, y2, z2):
        w, x, y, z = trace + 1.0, R[2, 1] - R[1, 2], R[0, 2] - R[2, 0], R[1, 0] - R[0, 1]
    elif x2 >= max(y2, z2):
        w, x, y, z = R[2, 1] - R[1, 2], x2 + 1.0, R[1, 0] + R[0, 1], R[0, 2] + R[2, 0]
    elif y2 >= z2:
        w, x, y, z = R[0, 2] - R[2, 0], R[1, 0] + R[0, 1], y2 + 1.0, R[2, 1] + R[1, 2]
    else:
        w, x, y, z = R[1, 0] - R[0, 1], R[0, 2] + R[2, 0], R[2, 1] + R[1, 2], z2 + 1.0
    scale = sqrt(w * w + x * x + y * y + z * z)
    if w < 0.0:
        scale = -scale
    return (w / scale, x / scale, y / scale, z / scale)


def quaternion_from_rotation(R: Matrix) -> Vector:
    """Unit quaternion wxyz with w >= 0, from the largest of its four components (Shepperd 1978)."""
    return np.array(quaternion_components(R))


def rotation_about(axis: Vector, angle: float) -> Matrix:
    """R (3,3) of a turn by `angle` [rad] about a unit axis (Rodrigues)."""
    S = skew(axis)
    return np.eye(3) + sin(angle) * S + (1.0 - cos(angle)) * S @ S


def product_components(p, q):  # type: ignore[no-untyped-def]
    """`multiply` as a 4-tuple; compiled in `cube_sim.tuples`."""
    a, b, c, d = p
    w, x, y, z = q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def multiply(p: Vector, q: Vector) -> Vector:
    """Quaternion product p q."""
    return np.array(product_components(p, q))


def conjugate(q: Vector) -> Vector:
    """The inverse of a unit quaternion."""
    return np.array([q[0], -q[1], -q[2], -q[3]])


def quaternion_from_euler(roll: float, pitch: float, yaw: float) -> Vector:
    """Unit quaternion of R = Rz(yaw) Ry(pitch) Rx(roll), angles in radians."""
    half = [0.5 * angle for angle in (roll, pitch, yaw)]
    qx = np.array([cos(half[0]), sin(half[0]), 0.0, 0.0])
    qy = np.array([cos(half[1]), 0.0, sin(half[1]), 0.0])
    qz = np.array([cos(half[2]), 0.0, 0.0, sin(half[2])])
    return multiply(qz, multiply(qy, qx))


def angle_between(p: Vector, q: Vector) -> float:
    """Angle [rad] of the rotation between two attitudes, 0 to pi."""
    w, x, y, z = multiply(conjugate(p), q)
    return 2.0 * atan2(sqrt(x * x + y * y + z * z), abs(w))

"""Actuation matrices from the drawings of the vehicles; nothing of cube_sim takes part."""

from __future__ import annotations

import numpy as np


def cube(arm_m: float = 0.2, direction_noise: float = 0.0, position_noise_m: float = 0.0, seed: int = 0) -> np.ndarray:
    """(6, 8) unit thrusts at the corners of a cube, tangent to its sphere; with noise, the cube as built."""
    p, q, c = 0.5 + 1 / np.sqrt(12), 0.5 - 1 / np.sqrt(12), 1 / np.sqrt(3)
    quarter = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    corners, axes = [], []
    for z in (1.0, -1.0):
        corner, axis = arm_m * np.array([1.0, 1.0, z]), np.array([q, -p, z * c])
        for _ in range(4):
            corners.append(corner)
            axes.append(axis)
            corner, axis = quarter @ corner, quarter @ axis
    rng = np.random.default_rng(seed)
    r = np.array(corners) + position_noise_m * rng.normal(size=(8, 3))
    u = np.array(axes) + direction_noise * rng.normal(size=(8, 3))
    u /= np.linalg.norm(u, axis=1)[:, None]
    return np.vstack([u.T, np.cross(r, u).T])


def jack() -> np.ndarray:
    """(3, 4) planar vehicle with four tilted horizontal motors; its kernel is (1, 1, 1, 1)."""
    return np.array([[0.966, 0.966, -0.966, -0.966], [-0.259, 0.259, -0.259, 0.259], [-0.245, 0.245, 0.245, -0.245]])


def bluerov2_heavy() -> np.ndarray:
    """(6, 8) four horizontal thrusters at 45 degrees, which make surge, sway and yaw, and four vertical ones."""
    c, x, y = np.sqrt(0.5), np.array([1.0, 1, -1, -1]), np.array([1.0, -1, 1, -1])
    A = np.zeros((6, 8))
    A[[0, 1, 5], :4] = c * np.ones(4), c * x * y, 0.18 * y
    A[[2, 3, 4], 4:] = np.ones(4), 0.218 * y, -0.12 * x
    return A

"""An estimate of the current from how a hull is accelerated that its model says it is not."""

from __future__ import annotations

from math import cos, exp, hypot, sin

import numpy as np

from cube_sim.control.planar.model import (
    PlanarModel,
    PlanarMotion,
    sway_resistance,
    sway_resistance_slopes,
)
from cube_sim.native.compiled import compiled
from cube_sim.spatial import Record, Vector
from cube_sim.tuples import solve_positive

USUAL_CURRENT = 0.3
"""What is expected of a current before anything is known [m/s], one standard deviation."""
WRONG = 0.3
"""What is expected of a coefficient's mistake, and of what comes and goes of each force, as a share of it."""
LEAST_NOISE = 0.02
"""Noise below which nothing is believed, as a share of the acceleration that stops the hull in one length of time."""
MISTAKES = 5
"""How many terms may be wrong one by one."""
MEMORY = 100.0
"""How long current and mistakes last, in time constants of the filter."""

N = 2 + MISTAKES

FILTER = np.dtype(
    [
        ("time", np.float64),
        ("bound", np.float64),
        ("least", np.float64, 3),
        ("spread", np.float64, N),
        ("expected", np.float64, 2),
    ]
)
"""Parameters of a `CurrentFilter`: its time and bound; the noise below which nothing is believed, squared below the
root [m/s^2, m/s^2, rad/s^2]; the variances expected of current and mistakes; the current expected."""
FILTERED = np.dtype([("covariance", np.float64, (N, N)), ("kappa", np.float64, MISTAKES), ("current", np.float64, 2)])
"""What it remembers: P, kappa and c_hat."""


class CurrentFilter:
    """A Kalman filter of the current and of the model's mistakes, told apart as the hull moves.

    With nu = (u, v, r) over ground, what the model a leaves of the acceleration in the current as estimated is

        nu' - a(nu, c_hat) = J R' (c - c_hat) + B kappa + noise      J = da/dc, body axes

    c stands still in world axes. B holds the terms of a, kappa the shares by which they are wrong. Where both explain
    the same, as on a straight line, it is shared by what was expected of each; a turn tells them apart. Both are taken
    to fade away over a long time (Ornstein-Uhlenbeck processes). So they form a stable system, which is detectable
    whatever the hull does: the filter's error is exponentially stable, and its covariance never above that of the
    processes (B. Anderson and J. Moore 1981, SIAM J. Control 19, on time-varying Kalman filters). c_hat is kept within
    `bound`: the projection onto a ball that holds c brings it no farther from c.

    P. Encarnacao, A. Pascoal and M. Arcak 2000 estimate the current with an observer driven by the position, from a
    measured velocity through the water. No such log is needed here: the model of the hull stands for it.

    Args:
        model: the controller's knowledge of the hull.
        time: T_c [s]: what lasts shorter is noise.
        current: what is expected (2,) [m/s], world axes.
        speed: at which the hull moves [m/s], for what is negligible.
        bound: on the speed of the estimate [m/s].
    """

    def __init__(self, model: PlanarModel, time: float, current: Vector, speed: float, bound: float) -> None:
        self._hull = model.record
        ahead = PlanarMotion(speed, 0.0, 0.0)
        least = LEAST_NOISE * speed * np.linalg.norm(current_slope(self._hull[0], ahead), axis=1) + 1e-9
        spread = np.concatenate([np.full(2, USUAL_CURRENT), np.full(MISTAKES, WRONG)]) ** 2
        self.parameters: Record = np.array([(time, bound, least, spread, current)], FILTER)
        self.memory: Record = np.array([(np.diag(spread), np.zeros(MISTAKES), current)], FILTERED)

    @property
    def current(self) -> Vector:
        """c_hat (2,) [m/s], world axes."""
        return self.memory["current"][0].copy()

    @property
    def spread(self) -> Vector:
        """One standard deviation of each component of the current (2,) [m/s]."""
        return np.sqrt(np.diag(self.memory["covariance"][0])[:2])

    def update(
        self, psi_B: float, through: PlanarMotion, unexplained: Vector, accelerations: tuple[Vector, Vector], dt: float
    ) -> None:
        """Learn from one tick, see `filter_current`."""
        filter_current(self.parameters, self.memory, self._hull[0], psi_B, through, unexplained, *accelerations, dt)


@compiled
def mistakes(hull, through):
    """B (3,5) [m/s^2, m/s^2, rad/s^2]: the parts of (u', v', r') whose coefficients may be wrong one by one.

    Drag ahead; the push outwards in a turn; drag and lift to the side; what resists turning; what a side-slip turns.

    Args:
        hull: element of `cube_sim.control.planar.model.HULL`.
        through: `PlanarMotion` through the water.
    """
    u, v, r = through
    B = np.zeros((3, MISTAKES))
    B[0, 0] = -(hull.D_u * u + hull.D_uu * u * abs(u)) / hull.m_u
    B[1, 1] = -hull.m_ur * u * r / hull.m_v
    B[1, 2] = -sway_resistance(hull, u, v) / hull.m_v
    B[2, 3] = -(hull.K_r * r + hull.K_rr * r * abs(r) + hull.K_ur * u * r) / hull.m_r
    B[2, 4] = -(hull.K_v * v + hull.K_vv * v * abs(v) + hull.K_uv * u * v) / hull.m_r
    return B


@compiled
def current_slope(hull, through):
    """J (3,2) [1/s, 1/s, 1/(m s)]: how (u', v', r') over ground grow with the current, body axes; see `mistakes`."""
    u, v, r = through
    d_v_u, d_v_v = sway_resistance_slopes(hull, u, v)
    J = np.empty((3, 2))
    J[0, 0], J[0, 1] = (hull.D_u + 2.0 * hull.D_uu * abs(u)) / hull.m_u, r - hull.m_vr * r / hull.m_u
    J[1, 0], J[1, 1] = (hull.m_ur * r + d_v_u) / hull.m_v - r, d_v_v / hull.m_v
    J[2, 0] = (hull.K_uv * v + hull.K_ur * r) / hull.m_r
    J[2, 1] = (hull.K_v + 2.0 * hull.K_vv * abs(v) + hull.K_uv * u) / hull.m_r
    return J


@compiled
def filter_current(parameters, memory, hull, psi_B, through, unexplained, moved, pushed, dt):
    """One tick of `CurrentFilter`.

    Args:
        parameters: record `FILTER`.
        memory: record `FILTERED`, moved on.
        hull: element of `cube_sim.control.planar.model.HULL`.
        psi_B: heading [rad].
        through: `PlanarMotion` through the water as estimated.
        unexplained: nu' - a(nu, c_hat), three numbers, over the tick [m/s^2, m/s^2, rad/s^2].
        moved: nu', three numbers. It counts as noise, as does the next: as large as they are in a sharp turn, wrong
            masses and thrusters that lag explain more than a current does.
        pushed: the part of it that is the thrusters'.
        dt: length of the tick [s].
    """
    k, m = parameters[0], memory[0]
    c, s = cos(psi_B), sin(psi_B)
    B, J, H = mistakes(hull, through), current_slope(hull, through), np.empty((3, N))
    for a in range(3):
        H[a, 0], H[a, 1] = J[a, 0] * c - J[a, 1] * s, J[a, 0] * s + J[a, 1] * c
        for i in range(MISTAKES):
            H[a, 2 + i] = B[a, i]
    kept = exp(-dt / (MEMORY * k.time))
    P, kappa = m.covariance, m.kappa
    for i in range(N):
        for j in range(N):
            P[i, j] *= kept**2
        P[i, i] += (1.0 - kept**2) * k.spread[i]
    # S = H P H' + noise, what is left to be explained, and the gain P H' S^-1, one row for each component
    HP, S, left = np.zeros((3, N)), np.zeros((3, 3)), np.empty(3)
    for a in range(3):
        noise = k.least[a] ** 2 + moved[a] ** 2 + pushed[a] ** 2
        left[a] = unexplained[a]
        for i in range(MISTAKES):
            noise += (WRONG * B[a, i]) ** 2
            left[a] -= B[a, i] * (kept * kappa[i])
        for j in range(N):
            for i in range(N):
                HP[a, j] += H[a, i] * P[i, j]
        for b in range(a + 1):
            for j in range(N):
                S[a, b] += HP[a, j] * H[b, j]
        S[a, a] += noise * k.time / dt
    step, gain = np.empty(N), np.empty((N, 3))
    for i in range(N):
        gain[i, 0], gain[i, 1], gain[i, 2] = solve_positive(S, (HP[0, i], HP[1, i], HP[2, i]))
        step[i] = gain[i, 0] * left[0] + gain[i, 1] * left[1] + gain[i, 2] * left[2]
    for i in range(N):
        for j in range(i + 1):
            P[i, j] -= gain[i, 0] * HP[0, j] + gain[i, 1] * HP[1, j] + gain[i, 2] * HP[2, j]
            P[j, i] = P[i, j]
    for i in range(MISTAKES):
        kappa[i] = kept * kappa[i] + step[2 + i]
    x = k.expected[0] + kept * (m.current[0] - k.expected[0]) + step[0]
    y = k.expected[1] + kept * (m.current[1] - k.expected[1]) + step[1]
    share = min(1.0, k.bound / max(hypot(x, y), 1e-12))
    m.current[0], m.current[1] = x * share, y * share

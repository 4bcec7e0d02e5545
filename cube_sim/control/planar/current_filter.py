"""An estimate of the current from how a hull is accelerated that its model says it is not."""

from __future__ import annotations

from math import cos, exp, hypot, sin

import numpy as np

from cube_sim.control.planar.model import PlanarModel, PlanarMotion
from cube_sim.spatial import Matrix, Vector

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
        self._model, self._time, self._bound = model, time, bound
        self._least = LEAST_NOISE * speed * np.linalg.norm(slope(model, PlanarMotion(speed, 0.0, 0.0)), axis=1) + 1e-9
        self._spread = np.concatenate([np.full(2, USUAL_CURRENT), np.full(MISTAKES, WRONG)]) ** 2
        self._P = np.diag(self._spread)
        self._kappa = np.zeros(MISTAKES)
        self._expected, self.current = np.array(current), np.array(current, dtype=float)

    @property
    def spread(self) -> Vector:
        """One standard deviation of each component of the current (2,) [m/s]."""
        return np.sqrt(np.diag(self._P)[:2])

    def update(
        self, psi_B: float, through: PlanarMotion, unexplained: Vector, accelerations: tuple[Vector, Vector], dt: float
    ) -> None:
        """Learn from one tick.

        Args:
            psi_B: heading [rad].
            through: motion through the water as estimated.
            unexplained: nu' - a(nu, c_hat) (3,) over the tick [m/s^2, m/s^2, rad/s^2].
            accelerations: nu' and the part of it that is the thrusters' (3,) each. They count as noise: as large as
                they are in a sharp turn, wrong masses and thrusters that lag explain more than a current does.
            dt: length of the tick [s].
        """
        c, s = cos(psi_B), sin(psi_B)
        B = terms(self._model, through)
        H = np.hstack([slope(self._model, through) @ np.array([[c, s], [-s, c]]), B])
        kept = exp(-dt / (MEMORY * self._time))
        P = kept**2 * self._P + (1.0 - kept**2) * np.diag(self._spread)
        kappa = kept * self._kappa
        moved, pushed = accelerations
        noise = self._least**2 + WRONG**2 * np.sum(B**2, axis=1) + moved**2 + pushed**2
        S = H @ P @ H.T + np.diag(noise * self._time / dt)
        gain = np.linalg.solve(S, H @ P).T
        step = gain @ (unexplained - B @ kappa)
        self._P = P - gain @ S @ gain.T
        self._kappa = kappa + step[2:]
        wanted = self._expected + kept * (self.current - self._expected) + step[:2]
        self.current = wanted * min(1.0, self._bound / max(hypot(*wanted), 1e-12))


def terms(model: PlanarModel, through: PlanarMotion) -> Matrix:
    """B (3,5) [m/s^2, m/s^2, rad/s^2]: the parts of (u', v', r') whose coefficients may be wrong one by one.

    Drag ahead; the push outwards in a turn; drag and lift to the side; what resists turning; what a side-slip turns.
    """
    u, v, r = through
    return np.array(
        [
            [-(model.D_u * u + model.D_uu * u * abs(u)) / model.m_u, 0.0, 0.0, 0.0, 0.0],
            [0.0, -model.m_ur * u * r / model.m_v, -model.d_v(u, v) / model.m_v, 0.0, 0.0],
            [
                0.0,
                0.0,
                0.0,
                -(model.K_r * r + model.K_rr * r * abs(r) + model.K_ur * u * r) / model.m_r,
                -(model.K_v * v + model.K_vv * v * abs(v) + model.K_uv * u * v) / model.m_r,
            ],
        ]
    )


def slope(model: PlanarModel, through: PlanarMotion) -> Matrix:
    """J (3,2) [1/s, 1/s, 1/(m s)]: how (u', v', r') over ground grow with the current, body axes."""
    u, v, r = through
    d_v_u, d_v_v = model.d_v_slopes(u, v)
    return np.array(
        [
            [(model.D_u + 2.0 * model.D_uu * abs(u)) / model.m_u, r - model.m_vr * r / model.m_u],
            [(model.m_ur * r + d_v_u) / model.m_v - r, d_v_v / model.m_v],
            [
                (model.K_uv * v + model.K_ur * r) / model.m_r,
                (model.K_v + 2.0 * model.K_vv * abs(v) + model.K_uv * u) / model.m_r,
            ],
        ]
    )

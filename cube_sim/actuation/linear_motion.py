"""Small motions about a steady straight course: what the thrusters steer, what the water damps, how fast it goes.

The state is x = [e, theta, delta nu]: position off the course, small rotation and velocity change, all in the axes
the body has on the course. With v_0 the course velocity
    e' = delta v + theta x v_0,   theta' = delta w,
    M delta nu' = A delta F_m - (d steady wrench / d nu) delta nu + (d hydrostatic / d theta) theta.
Position along the course is left out: the target on the path waits (s' = v_T + k2 s1).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.actuation.hull import Hull
from cube_sim.actuation.wrench_axes import Matrix, Vector
from cube_sim.spatial import skew

_SAMPLES = 40
_SIDES = 12
_NEUTRAL = 1e-6
_STEERED = 1e-6
_MADE_GOOD = 1e-6


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
        unit = np.array([length_m if name in _LENGTHS else 1.0 for name in self.names])
        rate = np.array([time_s if name in _RATES else 1.0 for name in self.names])
        T = rate / unit
        drift = time_s * T[:, None] * self.drift / T
        steer = T[:, None] * self.steer
        steer = steer / max(float(np.linalg.norm(steer, 2)), np.finfo(float).tiny)
        found: set[str] = set()
        for eigenvalue in np.linalg.eigvals(drift):
            if eigenvalue.real < -_NEUTRAL:
                continue
            # A defective eigenvalue comes out of eigvals spread by the root of round-off: neutral ones are zero.
            at = 0.0 if abs(eigenvalue) < 1e-3 else eigenvalue
            pencil = np.hstack([at * np.eye(len(drift)) - drift, steer])
            U, sigma, _ = np.linalg.svd(pencil)
            for w in np.abs(U[:, sigma < _STEERED * max(sigma[0], 1.0)]).T:
                found.update(self.names[i] for i in np.flatnonzero(w > 0.3 * np.max(w)))
        motions = (name.split()[0] for name in self.names if name in found)
        return tuple(dict.fromkeys(motions))

    def side_step(self, margins: Vector, horizon_s: float, most_turn_rad: float) -> float:
        """Largest displacement [m] that can be made good in a time, in the worst direction across the course.

        From the course to a parallel one, back in attitude and velocity at the end, by the thruster forces of least
        sum (delta F_i / margin_i)^2 over the time (the controllability Gramian's solution, forces held over each
        sample). It ends where a thruster has used its margin or the body has turned further than allowed, beyond
        which small motions say nothing. 0 when no forces make it.

        Args:
            margins: (m,) force each thruster has left about the course, in both directions [N].
            horizon_s: the time.
            most_turn_rad: largest rotation on the way.
        """
        forward, push = self._sampled(self.steer * margins, horizon_s / _SAMPLES)
        blocks = [push]
        for _ in range(_SAMPLES - 1):
            blocks.append(forward @ blocks[-1])
        transfer = np.hstack(blocks[::-1])
        aim = self.off_course.T
        used = np.linalg.lstsq(transfer, aim, rcond=1e-10)[0]
        if np.max(np.abs(transfer @ used - aim)) > _MADE_GOOD:
            return 0.0
        used = used.reshape(_SAMPLES, -1, aim.shape[1])
        turning = np.flatnonzero([name in _ANGLES for name in self.names])
        turned = np.empty((_SAMPLES, len(turning), aim.shape[1]))
        x = np.zeros_like(aim)
        for sample in range(_SAMPLES):
            x = forward @ x + push @ used[sample]
            turned[sample] = x[turning]
        directions = _half_circle(aim.shape[1]).T
        force = np.max(np.abs(used @ directions), axis=(0, 1))
        turn = np.max(np.linalg.norm(turned @ directions, axis=1), axis=0)
        return float(np.min(1.0 / np.maximum(force, turn / most_turn_rad)))

    def _sampled(self, steer: Matrix, step_s: float) -> tuple[Matrix, Matrix]:
        """x_k+1 = forward x_k + push u_k for inputs held over a step."""
        k, m = steer.shape
        together = np.zeros((k + m, k + m))
        together[:k, :k], together[:k, k:] = self.drift * step_s, steer * step_s
        whole = _exponential(together)
        return whole[:k, :k], whole[:k, k:]


_LENGTHS = {"sway off course", "heave off course", "surge speed", "sway speed", "heave speed"}
_RATES = {"surge speed", "sway speed", "heave speed", "roll rate", "pitch rate", "yaw rate"}
_VELOCITIES = ("surge speed", "sway speed", "heave speed", "roll rate", "pitch rate", "yaw rate")
_ANGLES = ("roll", "pitch", "yaw")


def linearise(hull: Hull, A: Matrix, velocity: Vector, up: Vector, swing: Vector | None = None) -> LinearMotion:
    """Small motions about a straight course.

    Args:
        hull: the body.
        A: (6,m), or (3,m) for motion in the plane z = 0 only.
        velocity: v_0 (3,) [m/s], body axes, not zero.
        up: (3,) world up in body axes.
        swing: (6,) amplitude [m/s, rad/s] at which quadratic drag is taken to damp; default none.
    """
    planar = len(A) == 3
    moving = [0, 1, 5] if planar else list(range(6))
    turning = [2] if planar else [0, 1, 2]
    across = _across(velocity, planar)
    c, r, k = len(across), len(turning), len(moving)
    M = hull.mass[np.ix_(moving, moving)]
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


def _across(velocity: Vector, planar: bool) -> Matrix:
    """(c,3) orthonormal directions across the course; in the plane the one that is horizontal."""
    if planar:
        return np.array([[-velocity[1], velocity[0], 0.0]]) / np.hypot(velocity[0], velocity[1])
    return np.linalg.svd(velocity[None, :])[2][1:]


def _half_circle(dimensions: int) -> Matrix:
    """(p,dimensions) unit vectors over all directions up to sign."""
    if dimensions == 1:
        return np.ones((1, 1))
    angles = np.pi * np.arange(_SIDES) / _SIDES
    return np.column_stack([np.cos(angles), np.sin(angles)])


def _exponential(X: Matrix) -> Matrix:
    """exp(X) by its Taylor series after halving X until it is small, then squaring back."""
    halvings = max(0, int(np.ceil(np.log2(max(float(np.linalg.norm(X, 1)), 1e-9)))) + 2)
    Y = X / 2.0**halvings
    term = total = np.eye(len(X))
    for order in range(1, 13):
        term = term @ Y / order
        total = total + term
    for _ in range(halvings):
        total = total @ total
    return total

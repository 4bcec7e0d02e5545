"""Gain and phase margins of a loop, opened where its wrench goes to the thrusters, one direction at a time."""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import numpy as np

from closed_loop.linear_loop import LinearLoop
from cube_sim.spatial import Matrix, Vector

SLOWEST = 1e-3
"""Lowest frequency looked at [rad/s]."""
SAMPLES = 700


class Margins(NamedTuple):
    """How far one loop is from the edge of stability.

    Attributes:
        more: factor on the gain at which it is unstable; infinite where none.
        less: the same below 1; 0 where none.
        phase_deg: phase lag, at any frequency where the gain is 1, at which it is unstable; infinite where none.
        at_rad_s: that frequency.
    """

    more: float
    less: float
    phase_deg: float
    at_rad_s: float

    @property
    def gain_db(self) -> float:
        """The smaller of the two factors [dB]."""
        up = 20.0 * np.log10(self.more)
        down = -20.0 * np.log10(self.less) if self.less > 0.0 else inf
        return float(min(up, down))


def frequencies(loop: LinearLoop) -> Vector:
    """(q,) from the slowest to half of the sampling frequency [rad/s]."""
    return np.geomspace(SLOWEST, np.pi / loop.period, SAMPLES)


def responses(loop: LinearLoop, at: Vector, output: Matrix | None = None) -> Matrix:
    """(q,k,r) of an output (k,n) to what is pushed along the loop's directions, with the loop open, at z = exp(j w T).

    Args:
        loop: about steady motion.
        at: (q,) frequencies [rad/s].
        output: by default the demand along the same directions, with the sign turned: the loop's own gains.
    """
    along = np.linalg.pinv(loop.directions)
    C = -along @ loop.demand if output is None else output
    z = np.exp(1j * at * loop.period)
    n = len(loop.open)
    return C @ np.linalg.solve(z[:, None, None] * np.eye(n) - loop.open, loop.push @ loop.directions + 0j)


def one_by_one(gains: Matrix) -> Matrix:
    """(q,r) the gain of each loop with the others closed, from all of them open (q,r,r)."""
    q, r, _ = gains.shape
    alone = np.empty((q, r), dtype=complex)
    for i in range(r):
        rest = np.delete(np.arange(r), i)
        others = np.eye(r - 1) + gains[:, rest][:, :, rest]
        back = np.linalg.solve(others, gains[:, rest, i][:, :, None])[:, :, 0]
        alone[:, i] = gains[:, i, i] - np.einsum("qk,qk->q", gains[:, i, rest], back)
    return alone


def margins_of(gain: Vector, at: Vector) -> Margins:
    """Read off a Nyquist curve (q,) at frequencies (q,) [rad/s]."""
    size, phase = np.log(np.abs(gain)), np.unwrap(np.angle(gain))
    more, less = inf, 0.0
    # where it crosses the negative real axis
    turns = (phase + np.pi) / (2.0 * np.pi)
    for i in np.flatnonzero(np.floor(turns[:-1]) != np.floor(turns[1:])):
        level = max(np.floor(turns[i]), np.floor(turns[i + 1]))
        share = (level - turns[i]) / (turns[i + 1] - turns[i])
        factor = float(np.exp(-(size[i] + share * (size[i + 1] - size[i]))))
        more, less = (min(more, factor), less) if factor > 1.0 else (more, max(less, factor))
    if gain[-1].real < 0.0:  # half the sampling frequency: real there
        factor = 1.0 / abs(gain[-1])
        more, less = (min(more, factor), less) if factor > 1.0 else (more, max(less, factor))
    worst, where = inf, 0.0
    for i in np.flatnonzero(np.sign(size[:-1]) != np.sign(size[1:])):
        share = size[i] / (size[i] - size[i + 1])
        angle = phase[i] + share * (phase[i + 1] - phase[i])
        off = abs((angle + np.pi + np.pi) % (2.0 * np.pi) - np.pi)
        if off < worst:
            worst, where = off, float(at[i] ** (1.0 - share) * at[i + 1] ** share)
    return Margins(more, less, float(np.degrees(worst)), where)


def all_margins(loop: LinearLoop) -> list[Margins]:
    """Of each direction of the wrench, the others closed."""
    at = frequencies(loop)
    alone = one_by_one(responses(loop, at))
    return [margins_of(column, at) for column in alone.T]

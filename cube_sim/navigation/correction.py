"""A reading fused into the state: its normalised innovation squared (NIS), and the update."""

from __future__ import annotations

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.navigation.strapdown import turned


@compiled
def corrected(x, P, H, innovation, variance):
    """State and covariance after a reading whose components have independent noise.

    The components are taken one after the other, which is the same as at once and needs no inverse. For one, of row h:
    g = P h', s = h g + variance, k = g / s and P+ = (I - k h) P (I - k h)' + k variance k', the form of Joseph, which
    rounding does not make indefinite. The squares of what each says beyond the ones before it, over s, add up to
    y' S^-1 y of the whole reading.

    The attitude's part phi of the correction turns the estimate in world axes, R+ = Exp(phi) R. What this turn does to
    the error's own axes is of second order in phi and left out.

    Args:
        x: (16 + c,) state, laid out as in `cube_sim.navigation.strapdown`.
        P: (15 + c, 15 + c) covariance of its error.
        H: (m, 15 + c) dh / d error.
        innovation: y (m,).
        variance: of each component of the reading.

    Returns:
        The corrected x and P, new arrays, and the NIS y' S^-1 y with S = H P H' + variance I, which is chi-square
        with m degrees of freedom.
    """
    size = len(P)
    later, covariance = x.copy(), P.copy()
    step, g, left, half = np.zeros(size), np.empty(size), np.empty(size), np.empty((size, size))
    nis = 0.0
    for m in range(len(innovation)):
        s, beyond = variance, innovation[m]
        g[:], left[:] = 0.0, 0.0
        for j in range(size):
            if H[m, j] != 0.0:  # most are not
                for i in range(size):
                    g[i] += covariance[j, i] * H[m, j]
                beyond -= H[m, j] * step[j]
        for j in range(size):
            s += H[m, j] * g[j]
        nis += beyond * beyond / s
        for i in range(size):
            k = g[i] / s
            step[i] += k * beyond
            for j in range(size):
                half[i, j] = covariance[i, j] - k * g[j]
        for j in range(size):
            if H[m, j] != 0.0:
                for i in range(size):
                    left[i] += half[i, j] * H[m, j]
        for i in range(size):
            k = g[i] / s
            for j in range(size):
                covariance[i, j] = half[i, j] + (variance * k - left[i]) * g[j] / s
        for i in range(size):
            for j in range(i):
                covariance[i, j] = covariance[j, i] = 0.5 * (covariance[i, j] + covariance[j, i])
    for i in range(6):
        later[i] += step[i]
    # Exp(phi) q = (q* exp(-phi))*, and `turned` takes angles on the right
    conjugate = np.empty(4)
    conjugate[0], conjugate[1], conjugate[2], conjugate[3] = x[6], -x[7], -x[8], -x[9]
    q = turned(conjugate, -step[6:9])
    later[6], later[7], later[8], later[9] = q[0], -q[1], -q[2], -q[3]
    for i in range(9, size):
        later[i + 1] += step[i]
    return later, covariance, nis

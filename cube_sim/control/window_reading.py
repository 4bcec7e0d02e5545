"""What one thruster is, read from one window of its expected and measured forces.

Whole and weak thrusters lie on a line y = e x, a dead one on y = 0, a stuck one on y = c. Each of these is a least
squares fit. Between two of them decides the difference of their sums of squares, which for white noise is the logarithm
of a likelihood ratio: of two fits whose forces differ by M in norm, it is M^2 apart with a standard deviation of
2 sigma M, so that 25 sigma^2 is never reached by five standard deviations from the wrong side.

Where readings are noisy more is asked of a window before it is believed: that the force expected stands out enough for
the share of it to be known to a twentieth. Without noise this asks for nothing.
"""

from __future__ import annotations

from math import inf, sqrt
from typing import NamedTuple

import numpy as np

from cube_sim.native.compiled import compiled
from cube_sim.spatial import Vector

WHOLE = 0.9
"""Efficiencies above this count as whole; a characteristic is not known better."""
DEAD = 0.1
"""Efficiencies below this count as dead."""

_SHARE_DEVIATION = 0.05
"""The largest standard deviation with which a share says something."""
_FAINT = 0.35
"""A thruster of which little is expected is believed dead when its share lies below this for certain."""
_DECISIVE = 25.0
"""By how many sigma^2 one fit has to be better than another."""
_RARE = 15.0
"""-log of the probability with which noise alone exceeds its allowance."""
FAR = 10.0
"""A force that is so many thresholds, and standard deviations, from all that a working thruster gives needs no long
look."""


class WindowReading(NamedTuple):
    """What a window says of a thruster.

    Attributes:
        efficiency: share of its force it gives, 0 for a dead and a stuck one.
        stuck: force [N] it holds; NaN where it responds, or is dead.
        certain: whether it can be nothing else; if not, it may as well be stuck.
    """

    efficiency: float
    stuck: float = np.nan
    certain: bool = True


class Evidence(NamedTuple):
    """How far forces may be trusted.

    Attributes:
        threshold: forces and differences below this say nothing [N].
        noise: standard deviation of a measured force [N], white.
        gain: (least, most) that a whole thruster is measured to give of what is expected.
    """

    threshold: float
    noise: float
    gain: tuple[float, float]

    def size(self, n: int) -> float:
        """Norm of n differences that say nothing, noise aside [N]."""
        return sqrt(n) * self.threshold

    def noise_energy(self, n: int) -> float:
        """What the squares of n noises sum up to at most [N^2]."""
        return self.noise**2 * _noise_energy(n)


@compiled
def _noise_energy(n: int) -> float:
    """What the squares of n unit noises sum up to at most.

    By the bound of Laurent and Massart (2000, Annals of Statistics 28(5), lemma 1) on chi squared of n degrees of
    freedom: P(chi2 >= n + 2 sqrt(n t) + 2 t) <= exp(-t).
    """
    return n + 2.0 * sqrt(n * _RARE) + 2.0 * _RARE


@compiled
def contradicts(expected, measured, first, n, efficiency, stuck, gain, threshold, noise):
    """(m,) bool: which measured forces are not those believed.

    Noise hides most of a difference that is spread over all n readings, but little of one that has the shape of a
    fault: a constant and a share of what is expected.

    Args:
        expected: (k,m) [N], a ring of rows.
        measured: (k,m) [N], likewise.
        first: the first row of the window; it runs over the end of the ring.
        n: how many rows the window has.
        efficiency: (m,) believed share.
        stuck: (m,) force [N] believed to be held; NaN where none is.
        gain: (m,) by which measured forces are divided.
        threshold: differences below this say nothing [N].
        noise: standard deviation of a measured force [N].
    """
    k, m = expected.shape
    result = np.zeros(m, np.bool_)
    if noise == 0.0:
        squares = np.zeros(m)
        for j in range(n):
            row = (first + j) % k
            for i in range(m):
                believed = efficiency[i] * expected[row, i] if np.isnan(stuck[i]) else stuck[i]
                r = measured[row, i] / gain[i] - believed
                squares[i] += r * r
        for i in range(m):
            result[i] = sqrt(squares[i]) > sqrt(n) * threshold
        return result
    for i in range(m):
        total = sum_x = sum_r = sum_xx = sum_xr = 0.0
        for j in range(n):
            row = (first + j) % k
            x = expected[row, i]
            believed = efficiency[i] * x if np.isnan(stuck[i]) else stuck[i]
            r = measured[row, i] / gain[i] - believed
            total += r * r
            sum_x += x
            sum_r += r
            sum_xx += x * x
            sum_xr += x * r
        noise2 = (noise / gain[i]) ** 2
        swing, along = sum_xx - sum_x * sum_x / n, sum_xr - sum_x * sum_r / n
        shaped = sum_r * sum_r / n + (along * along / swing if swing > 1e-9 else 0.0)
        allowed = n * threshold**2
        result[i] = shaped > allowed + 2.0 * _RARE * noise2 or total > allowed + _noise_energy(n) * noise2
    return result


def read_window(x: Vector, y: Vector, evidence: Evidence, idle: bool) -> WindowReading | None:
    """What a thruster is that does not do what is believed of it.

    Args:
        x: (n,) forces [N] expected of it if it were whole, oldest first.
        y: (n,) forces [N] measured.
        evidence: how far these may be trusted.
        idle: whether it is believed to give no answer, and so is asked for none.

    Returns:
        None when the window mixes two truths, or says nothing.
    """
    n, size, noise2 = len(x), evidence.size(len(x)), evidence.noise**2
    noise_energy = evidence.noise_energy(n)
    energy = float(x @ x)
    most = evidence.gain[1]
    share = min(most, max(0.0, float(x @ y) / energy)) if energy > 0.0 else 0.0
    deviation = evidence.noise / sqrt(energy) if energy > 0.0 else inf
    line, level = y - share * x, y - y.mean()
    off_line, off_level = float(line @ line), float(level @ level)
    clearer = off_line - off_level  # by how much a constant fits better than a line
    proportional = (
        energy > size**2
        and (deviation <= _SHARE_DEVIATION or noise2 == 0.0)
        and off_line <= (0.5 * size) ** 2 + noise_energy
        and clearer <= (0.5 * size) ** 2 + _DECISIVE * noise2
    )
    if proportional and share >= DEAD and not _holds_for_newer_half(x, line, share, evidence):
        return None  # the fault came amid the window
    if _is_silent(y, share, deviation, evidence, idle):
        # So little that it does not matter whether it is weak or stuck at that; or a stuck one that has let go.
        return WindowReading(_efficiency(share, deviation, evidence) if proportional else 0.0)
    if proportional:
        moved = off_level > (0.5 * size) ** 2 and max(0.0, off_line - noise_energy) <= 0.25 * off_level
        return WindowReading(_efficiency(share, deviation, evidence), certain=moved and clearer <= -_DECISIVE * noise2)
    held = float(y.mean())
    if noise2 == 0.0:
        constant = sqrt(off_level) < 0.2 * size and bool(np.all(np.abs(y) > evidence.threshold))
    else:
        constant = (
            clearer > (0.5 * size) ** 2 + _DECISIVE * noise2
            and off_level <= (0.2 * size) ** 2 + noise_energy
            and abs(held) > evidence.threshold + 3.0 * evidence.noise / sqrt(n)
        )
    return WindowReading(0.0, held) if constant else None


def read_at_once(x: Vector, y: Vector, evidence: Evidence) -> WindowReading | None:
    """The thruster that a few readings show to be stuck: they stand still, far from all that a working one could give.

    A whole and a weak thruster give something between nothing and what is expected of them. One that is stuck at a
    large force does not, and throws the hull about for as long as nobody knows.

    Args:
        x: (n,) forces [N] expected of it if it were whole, oldest first.
        y: (n,) forces [N] measured.
        evidence: how far these may be trusted.

    Returns:
        None when it may be something else, or is not far from it.
    """
    far, most = FAR * (evidence.threshold + evidence.noise), evidence.gain[1]
    outside = (y < most * np.minimum(x, 0.0) - far) | (y > most * np.maximum(x, 0.0) + far)
    still = float(np.ptp(y)) <= 0.2 * evidence.threshold + 6.0 * evidence.noise
    return WindowReading(0.0, float(y.mean())) if still and bool(outside.all()) else None


def _is_silent(y: Vector, share: float, deviation: float, evidence: Evidence, idle: bool) -> bool:
    if evidence.noise == 0.0:
        return bool(np.all(np.abs(y) <= evidence.threshold))
    n = len(y)
    small = float(y @ y) <= evidence.size(n) ** 2 + evidence.noise_energy(n)
    level = abs(float(y.mean())) <= evidence.threshold + 3.0 * evidence.noise / sqrt(n)
    return small and level and (idle or share + 3.0 * deviation <= _FAINT)


def _holds_for_newer_half(x: Vector, line: Vector, share: float, evidence: Evidence) -> bool:
    """Whether y = share x, found over the window, holds for its newer half too; `line` is y - share x."""
    newer, r = x[len(x) // 2 :], line[len(x) // 2 :]
    norm = float(np.linalg.norm(newer))
    tolerance = max(0.2 * share * norm, 0.1 * evidence.size(len(x)))
    if evidence.noise == 0.0:
        return bool(np.linalg.norm(r) <= tolerance)
    return norm == 0.0 or abs(float(newer @ r)) / norm <= tolerance + 4.0 * evidence.noise


def _efficiency(share: float, deviation: float, evidence: Evidence) -> float:
    if share < DEAD:
        return 0.0
    whole = WHOLE * evidence.gain[0] - (4.0 * deviation if evidence.noise > 0.0 else 0.0)
    return 1.0 if share > whole else round(share, 2)

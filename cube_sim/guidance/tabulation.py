"""From smooth pieces of a curve, in whatever parameter, to a table in arc length.

Every piece is halved until two functions on each cell are polynomials of the given degrees to `ACCURACY`: the speed as
a function of the parameter, and the unit tangent as a function of arc length. Arc length, position and the angle of the
parallel-transport frame are then exact integrals of polynomials. Position, tangent and arc length are right to about
1e-12 of the curve's size, the curvature to about 1e-9 and its derivative to about 1e-6 of their own.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from math import cos, sin
from typing import NamedTuple

import numpy as np
from numpy.polynomial import chebyshev
from numpy.typing import ArrayLike, NDArray

from cube_sim.errors import PathError
from cube_sim.guidance.frame import starting_frame
from cube_sim.guidance.tabulated import Cells, TabulatedPath
from cube_sim.spatial import Matrix, cross

Array = NDArray[np.float64]

ACCURACY = 1e-13
"""Size of the last coefficients, relative to the tangent's length of one, at which a cell is resolved."""
SPEED_DEGREE, TANGENT_DEGREE = 24, 14
LARGEST_TURN = 0.8
"""Angle by which the tangent may turn within a cell [rad]; the smallest rotation needs far less than pi."""
MOST_HALVINGS = 20
MOST_CELLS = 50_000
"""Cells of the longest table, some ten seconds of work."""
LARGEST_KINK = 1e-6
"""Change of the unit tangent between two cells up to which the curve is taken to go on smoothly."""
NEWTON_STEPS = 8
"""Enough from any start: a resolved speed varies little within a cell."""


class Piece(NamedTuple):
    """A smooth stretch of a curve p(u), u from 0 to `end`.

    Attributes:
        derivative: dp/du at many u: (k,) -> (k, 3).
        end: last value of u.
        below: where a mistake in this piece is to be reported.
    """

    derivative: Callable[[Array], Array]
    end: float
    below: tuple[str | int, ...] = ()


def _fit(degree: int) -> tuple[Array, Array]:
    """Chebyshev points of the first kind, and the matrix from values there to Chebyshev coefficients."""
    x = chebyshev.chebpts1(degree + 1)
    matrix: Array = chebyshev.chebvander(x, degree).T.astype(float) * (2.0 / (degree + 1))
    matrix[0] *= 0.5
    return x, matrix


# All matrices act on values at the nodes; "integral" gives Chebyshev coefficients of the one that is 0 at x = -1.
SPEED_NODES, SPEED_FIT = _fit(SPEED_DEGREE)
TANGENT_NODES, TANGENT_FIT = _fit(TANGENT_DEGREE)
SPEED_INTEGRAL = chebyshev.chebint(SPEED_FIT, lbnd=-1)
TANGENT_INTEGRAL = chebyshev.chebint(TANGENT_FIT, lbnd=-1)
SLOPE = chebyshev.chebval(TANGENT_NODES, chebyshev.chebder(TANGENT_FIT)).T
END_VALUES = chebyshev.chebval(np.array([-1.0, 1.0]), TANGENT_FIT).T
TO_POWERS = np.zeros((TANGENT_DEGREE + 2, TANGENT_DEGREE + 2))
"""From Chebyshev coefficients to those of powers of x."""
for _i, _row in enumerate(np.eye(TANGENT_DEGREE + 2)):
    TO_POWERS[: _i + 1, _i] = chebyshev.cheb2poly(_row)[: _i + 1]


class _Stretch(NamedTuple):
    """A part of a piece, u from `first` to `last`."""

    piece: int
    first: float
    last: float


class _Resolved(NamedTuple):
    """What a resolved stretch becomes: its length [m] and its unit tangents at TANGENT_NODES (k, 3)."""

    stretch: _Stretch
    length: float
    tangents: Array


def tabulate(start: ArrayLike, pieces: Sequence[Piece], closed: bool = False) -> TabulatedPath:
    """The path that begins at `start` (3,) [m] and runs through the pieces, the tangent continuous between them.

    Raises:
        PathError: the curve stops, has a kink or turns too sharply to be a path, or takes too many cells.
    """
    cells = _resolve(pieces)
    lengths = np.array([cell.length for cell in cells])
    half = 0.5 * lengths[:, None, None]
    T = np.array([cell.tangents for cell in cells])
    step = half * (TANGENT_INTEGRAL @ T)  # (n, degree + 2, 3), zero at x = -1
    ends = np.asarray(start, dtype=float) + np.cumsum(step.sum(axis=1), axis=0)
    step[:, 0] += np.vstack([np.asarray(start, dtype=float)[None], ends[:-1]])

    first, last = (_unit(value @ T) for value in END_VALUES)
    _require_smooth(pieces, cells, first, last, closed)
    cosine = np.einsum("nkj,nj->nk", T, first)
    spin = np.einsum("nkj,nj->nk", np.cross(T, SLOPE @ T), first) / (1.0 + cosine)
    angle = spin @ TANGENT_INTEGRAL.T
    turned = angle.sum(axis=1)

    frames = np.empty((len(cells) + 1, 3, 3))
    frames[0] = starting_frame(first[0])
    for i in range(len(cells)):
        frames[i + 1] = _carry(frames[i], last[i], float(turned[i]))
    edges = np.concatenate([[0.0], np.cumsum(lengths)])
    table = Cells(edges, TO_POWERS @ step, angle @ TO_POWERS.T, frames[:-1].copy())
    return TabulatedPath(table, frames[-1], closed)


def _resolve(pieces: Sequence[Piece]) -> list[_Resolved]:
    """Cells that cover all pieces, in order. Each round tries all open stretches and halves those that fail."""
    resolved: list[_Resolved] = []
    open_stretches = [_Stretch(i, 0.0, piece.end) for i, piece in enumerate(pieces)]
    for _ in range(MOST_HALVINGS):
        found = _try(pieces, open_stretches)
        resolved += [cell for cell in found if cell is not None]
        failed = [stretch for stretch, cell in zip(open_stretches, found, strict=True) if cell is None]
        if not failed:
            return sorted(resolved, key=lambda cell: cell.stretch)
        if len(resolved) + 2 * len(failed) > MOST_CELLS:
            at_fault = pieces[failed[0].piece]
            raise PathError(f"the path bends too often: it takes more than {MOST_CELLS} polynomials", *at_fault.below)
        open_stretches = [
            half
            for piece, first, last in failed
            for half in (
                _Stretch(piece, first, 0.5 * (first + last)),
                _Stretch(piece, 0.5 * (first + last), last),
            )
        ]
    at_fault = pieces[open_stretches[0].piece]
    raise PathError("the path has a kink or a cusp here", *at_fault.below)


def _require_smooth(pieces: Sequence[Piece], cells: list[_Resolved], first: Array, last: Array, closed: bool) -> None:
    """Refuse a curve that stops at the end of a cell and goes on in another direction: no cell by itself shows it."""
    kinks = np.linalg.norm(first - np.roll(last, 1, axis=0), axis=1)
    if not closed:
        kinks[0] = 0.0
    worst = int(np.argmax(kinks))
    if not kinks[worst] <= LARGEST_KINK:
        raise PathError("the path has a kink or a cusp here", *pieces[cells[worst].stretch.piece].below)


def _try(pieces: Sequence[Piece], stretches: list[_Stretch]) -> list[_Resolved | None]:
    """Each stretch as a cell, None where the degrees do not resolve it."""

    def derivative(x: Array) -> Array:
        return np.array(
            [
                pieces[piece].derivative(first + 0.5 * (last - first) * (1.0 + row))
                for (piece, first, last), row in zip(stretches, x, strict=True)
            ]
        )

    n = len(stretches)
    half = np.array([0.5 * (last - first) for _, first, last in stretches])
    speed = half[:, None] * np.linalg.norm(derivative(np.tile(SPEED_NODES, (n, 1))), axis=2)
    coefficients = speed @ SPEED_FIT.T
    length = speed @ SPEED_INTEGRAL.T
    total = length.sum(axis=1)
    moves = (speed > 1e-9 * speed.max(axis=1, keepdims=True)).all(axis=1)
    good = moves & (np.abs(coefficients[:, -4:]).max(axis=1) <= ACCURACY * total)

    # x at Chebyshev points of the arc length: Newton on length(x) = sigma
    x = np.tile(TANGENT_NODES, (n, 1))
    sigma = 0.5 * total[:, None] * (1.0 + TANGENT_NODES)
    for _ in range(NEWTON_STEPS):
        rate = np.where(good[:, None], _evaluate(coefficients, x), 1.0)
        x = np.clip(x - (_evaluate(length, x) - sigma) / rate, -1.0, 1.0)
    along = np.where(good[:, None, None], derivative(x), 1.0)
    T = along / np.linalg.norm(along, axis=2, keepdims=True)
    tail = np.abs((TANGENT_FIT @ T)[:, -2:]).max(axis=(1, 2))
    turn = np.arccos(np.clip(np.einsum("nkj,nj->nk", T, T[:, 0]), -1.0, 1.0)).max(axis=1)
    good &= (tail <= ACCURACY) & (turn < LARGEST_TURN)
    return [_Resolved(stretch, float(total[i]), T[i]) if good[i] else None for i, stretch in enumerate(stretches)]


def _evaluate(coefficients: Array, x: Array) -> Array:
    """Chebyshev series (n, d) at (n, k), row by row (Clenshaw 1955)."""
    b1, b2 = np.zeros_like(x), np.zeros_like(x)
    for column in coefficients.T[:0:-1]:
        b1, b2 = column[:, None] + 2.0 * x * b1 - b2, b1
    return coefficients[:, :1] + x * b1 - b2


def _unit(vectors: Array) -> Array:
    return vectors / np.linalg.norm(vectors, axis=-1, keepdims=True)


def _carry(frame: Matrix, T: Array, angle: float) -> Matrix:
    """The frame after parallel transport to the tangent T: smallest rotation, then the tabulated angle."""
    T0, N1, _ = frame.T
    U1 = N1 - (T @ N1) / (1.0 + T0 @ T) * (T0 + T)
    carried = cos(angle) * U1 + sin(angle) * cross(T, U1)
    carried -= T * (T @ carried)
    carried /= np.sqrt(carried @ carried)
    return np.column_stack([T, carried, cross(T, carried)])

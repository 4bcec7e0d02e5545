"""All that a compiled call needs in one array: what it is handed costs time by the piece.

First `HEADER` integers: n, m, k, rank A, number of alternatives, planar, scaled, h, rank W A, and where `Beyond` and
`Room` begin. Then `Tables`, `Beyond`, `Room`, and `Memory` last. Integers lie in the bits of a float's place.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.problem import Beyond, Tables
from cube_sim.allocation.exact.solutions import WrenchDistance, WrenchFibre
from cube_sim.allocation.exact.step import Memory
from cube_sim.allocation.exact.workspace import Room, room_at, room_size
from cube_sim.native.compiled import compiled, cut

HEADER = 11


def pack(t: Tables, far: Beyond, memory: NDArray[np.float64]) -> NDArray[np.float64]:
    """Put everything into one array, in the order the functions below take it out.

    Args:
        t: of the vehicle.
        far: of the vehicle.
        memory: (3, m), copied to the end.
    """
    fibre, distance = t.fibre, far.distance
    n, m = t.A.shape
    numbers = t.reversal_penalty, t.switching_penalty, t.change_limit, t.tolerance, t.reach
    rows = t.error_scale, t.weights, t.masks.view(np.float64)
    matrices = t.A, fibre.particular, fibre.kernel, fibre.equations, fibre.unreachable, t.plane
    sides = t.low, t.high, t.penalty, t.edge, t.targets, t.relaxed
    near = np.concatenate([np.ravel(part) for part in (*numbers, *rows, *matrices, *sides)])
    last = distance.spread, distance.kernel, distance.basis, distance.gain, far.facets, distance.weights
    beyond = np.concatenate([np.ravel(part) for part in last])
    begins = HEADER + len(near), HEADER + len(near) + len(beyond)
    header = n, m, fibre.kernel.shape[1], fibre.rank, len(t.targets), t.planar, t.scaled, len(far.facets)
    header = np.array((*header, len(distance.gain), *begins), np.int64)
    return np.concatenate([header.view(np.float64), near, beyond, np.zeros(room_size(n, m)), memory.ravel()])


@compiled
def unpack(packed: NDArray[np.float64]) -> Tables:
    """Tables whose arrays are views of the packed numbers."""
    header, real = cut(packed, 0, (HEADER,), np.int64), np.float64
    n, m, k, rank, alternatives = header[0], header[1], header[2], header[3], header[4]
    numbers = cut(packed, HEADER, (5,), real)
    error_scale = HEADER + 5
    weights = error_scale + n
    masks = weights + m
    A = masks + m
    particular = A + n * m
    kernel = particular + n * m
    equations = kernel + m * k
    unreachable = equations + rank * m
    plane = unreachable + n * n
    low = plane + 2 * m
    targets = low + 12 * m
    side = (m, 3)
    return Tables(
        cut(packed, A, (n, m), real),
        cut(packed, error_scale, (n,), real),
        WrenchFibre(
            cut(packed, particular, (m, n), real),
            cut(packed, kernel, (m, k), real),
            cut(packed, equations, (rank, m), real),
            cut(packed, unreachable, (n, n), real),
            rank,
        ),
        cut(packed, plane, (m, 2), real),
        header[5] != 0,
        header[6] != 0,
        cut(packed, weights, (m,), real),
        cut(packed, low, side, real),
        cut(packed, low + 3 * m, side, real),
        cut(packed, masks, (m,), np.int64),
        cut(packed, targets, (alternatives, m, 3), real),
        cut(packed, low + 6 * m, side, real),
        cut(packed, targets + alternatives * m * 3, (alternatives, m, 8, 4), real),
        cut(packed, low + 9 * m, side, real),
        numbers[0],
        numbers[1],
        numbers[2],
        numbers[3],
        numbers[4],
    )


@compiled
def unpack_beyond(packed: NDArray[np.float64]) -> Beyond:
    """What lies beyond the tables, as views."""
    header, real = cut(packed, 0, (HEADER,), np.int64), np.float64
    n, m, h, r, spread = header[0], header[1], header[7], header[8], header[9]
    kernel = spread + m * r
    basis = kernel + m * (m - r)
    gain = basis + n * r
    facets = gain + r * m
    return Beyond(
        WrenchDistance(
            cut(packed, spread, (m, r), real),
            cut(packed, kernel, (m, m - r), real),
            cut(packed, basis, (n, r), real),
            cut(packed, gain, (r, m), real),
            cut(packed, facets + h * r, (n,), real),
        ),
        cut(packed, facets, (h, r), real),
    )


@compiled
def unpack_room(packed: NDArray[np.float64]) -> Room:
    """The room to work in, as views."""
    header = cut(packed, 0, (HEADER,), np.int64)
    return room_at(packed, header[10], header[0], header[1])


@compiled
def unpack_memory(packed: NDArray[np.float64]) -> Memory:
    """The previous answer, as views."""
    m = cut(packed, 1, (1,), np.int64)[0]
    at = packed.shape[0] - 3 * m
    return Memory(
        cut(packed, at, (m,), np.float64),
        cut(packed, at + m, (m,), np.float64),
        cut(packed, at + 2 * m, (m,), np.float64),
    )


def memory_rows(packed: NDArray[np.float64], m: int) -> NDArray[np.float64]:
    """(3, m) the same as one view, for Python."""
    return packed[-3 * m :].reshape(3, m)

"""One allocation after the other, compiled whole: exact, else a share, else closest; then wrench, error and memory."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.cheapest import cheapest, cost_on, snap
from cube_sim.allocation.demand import attainable_origin, nearest_origins, share_origin
from cube_sim.allocation.memory import memory_of, remember, this_tick
from cube_sim.allocation.tables import unpack, unpack_beyond
from cube_sim.allocation.ties import changed, preferred
from cube_sim.compiled import borrowed, compiled

EXACT, CLOSEST, INVALID_WRENCH, UNPROVEN, UNPROVEN_CLOSEST, SCALED, YIELDED = 0, 1, 2, 5, 6, 7, 8
"""The numbers of `Status`."""

HUGE = 1e300
"""Errors beyond this are all the same [N]; it keeps the residual of the largest demands a number."""


class Answer(NamedTuple):
    """One row of answers, by name.

    Attributes:
        force: (m,) [N].
        wrench: (n,) A f.
        error: (n,) demanded minus achieved.
        subset: (m,) side each motor is on, -1, 0, +1.
        multiplier: (m,) of the interval ends at the solution of the subset's problem.
        low: (m,) lower end of the side each motor is on [N].
        high: (m,) upper end of it [N].
        rest: (6,) residual [N], cost [N^2], status, winning alternative of the objective, nodes looked at, and 1
            where the answer is not proven.
    """

    force: NDArray[np.float64]
    wrench: NDArray[np.float64]
    error: NDArray[np.float64]
    subset: NDArray[np.float64]
    multiplier: NDArray[np.float64]
    low: NDArray[np.float64]
    high: NDArray[np.float64]
    rest: NDArray[np.float64]


def blank_answers(count: int, rows: int, motors: int) -> NDArray[np.float64]:
    """(count, 5 m + 2 n + 6) room for answers, one row each; `answer_of` says what is where."""
    return np.zeros((count, 5 * motors + 2 * rows + 6))


@compiled
def answer_of(row: NDArray[np.float64], n: int, m: int) -> Answer:
    """Name the parts of one row of answers."""
    a, b = m + n, m + 2 * n
    return Answer(
        row[:m], row[m:a], row[a:b], row[b : b + m], row[b + m : b + 2 * m], row[b + 2 * m : b + 3 * m],
        row[b + 3 * m : b + 4 * m], row[b + 4 * m :],
    )  # fmt: skip


@compiled
def complete(
    A: NDArray[np.float64], error_scale: NDArray[np.float64], demand: NDArray[np.float64], answer: Answer
) -> None:
    """Write the wrench of the answer's forces, its error against the demand (n,), and the residual."""
    largest = 0.0
    for a in range(demand.shape[0]):
        answer.wrench[a] = 0.0
        for i in range(A.shape[1]):
            answer.wrench[a] += A[a, i] * answer.force[i]
        answer.error[a] = demand[a] - answer.wrench[a]
        largest = max(largest, min(abs(answer.error[a] * error_scale[a]), HUGE))
    square = 0.0
    if largest > 0.0:
        for a in range(demand.shape[0]):
            square += (min(abs(answer.error[a] * error_scale[a]), HUGE) / largest) ** 2
    answer.rest[0] = largest * math.sqrt(square)


@compiled
def allocate_each(
    numbers: NDArray[np.float64],
    integers: NDArray[np.int64],
    memory: NDArray[np.float64],
    primary: NDArray[np.float64],
    secondary: NDArray[np.float64],
    answers: NDArray[np.float64],
) -> None:
    """Allocate N demands ``primary + secondary`` in order, each remembering the one before.

    A demand that holds a NaN or an infinity counts as zero. A demand that is not attainable yields its secondary part
    first: the largest share of it is made that is attainable together with the primary part. Scaling a demand is the
    same with a primary part of zero.

    Args:
        numbers: see `Packed`.
        integers: see `Packed`.
        memory: (3, m) see `Memory`; changed in place.
        primary: (N, n) [N], [N m].
        secondary: (N, n), or (0, n) for demands that have no such part.
        answers: (N, ...) from `blank_answers`.
    """
    answers, primary, secondary = borrowed(answers), borrowed(primary), borrowed(secondary)
    numbers, integers = borrowed(numbers), borrowed(integers)
    t, known = unpack(numbers, integers), memory_of(borrowed(memory))
    n, m = t.A.shape
    wrenches, motors = np.zeros((4, n)), np.empty((7, m))  # two pieces of memory cost less time than eleven
    demand, base, direction, part = wrenches[0], wrenches[1], wrenches[2], wrenches[3]
    origin, trial, sides, mu, spare = motors[:1], motors[1], motors[2], motors[3], motors[4:]
    two_parts = secondary.shape[0] > 0
    for at in range(primary.shape[0]):
        answer = answer_of(answers[at], n, m)
        status, valid = EXACT, True
        for a in range(n):
            demand[a] = primary[at, a] + secondary[at, a] if two_parts else primary[at, a]
            valid = valid and math.isfinite(demand[a])
        for a in range(n):
            demand[a] = demand[a] if valid else 0.0
            base[a] = primary[at, a] if two_parts and valid else 0.0
            direction[a] = secondary[at, a] if two_parts and valid else demand[a]
            part[a] = base[a] if two_parts else demand[a]
        tick = this_tick(t, known)
        found, best, winner, changes_best, nodes, proven = False, math.inf, 0, 0, 0, True
        for stage in range(3):
            origins, count, looked, sure = origin, 0, 0, True
            if stage == 0:
                count = int(attainable_origin(t.fibre, t.reach, t.tolerance, demand, origin[0]))
            elif stage == 1:
                status = CLOSEST
                if valid and (two_parts or t.scaled):
                    far = unpack_beyond(numbers, integers)
                    share, looked, sure = share_origin(far, t.reach, tick, base, direction, origin[0], part)
                    count = int(share >= 0.0 or not two_parts)
                    status = YIELDED if two_parts else SCALED
            else:
                status = CLOSEST if status == YIELDED else status
                far = unpack_beyond(numbers, integers)
                origins, looked, sure = nearest_origins(t.A, far.distance, t.fibre, t.reach, tick, part)
                count = origins.shape[0]
            nodes += looked
            proven = proven and sure
            for c in range(count):
                there, cost, alternative, looked, sure = cheapest(
                    t.fibre, t.plane, t.planar, tick, known.subset, origins[c], spare, trial, sides, mu
                )
                nodes += looked
                proven = proven and sure
                if not there:
                    if stage < 2:
                        continue
                    cost, alternative = snap(tick, origins[c], trial, sides)
                    for i in range(m):
                        mu[i] = 0.0
                changes = changed(sides, known.subset)
                if found and not preferred(cost, best, sides, answer.subset, changes, changes_best):
                    continue
                found, best, winner, changes_best = True, cost, alternative, changes
                for i in range(m):
                    answer.force[i], answer.subset[i], answer.multiplier[i] = trial[i], sides[i], mu[i]
            if found:
                break
        complete(t.A, t.error_scale, demand, answer)
        if not valid:
            status = INVALID_WRENCH
        elif not proven:
            status = UNPROVEN if status == EXACT else UNPROVEN_CLOSEST
        answer.rest[1] = cost_on(tick, winner, answer.force, answer.subset)
        answer.rest[2], answer.rest[3], answer.rest[4], answer.rest[5] = status, winner, nodes, 0.0 if proven else 1.0
        for i in range(m):
            s = int(answer.subset[i]) + 1
            answer.low[i], answer.high[i] = tick.low[i, s], tick.high[i, s]
        remember(t.edge, known, answer.force, answer.subset)

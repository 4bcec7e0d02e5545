"""What an allocation answers: forces, the wrench they make, and how far that is from the demand."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Status(IntEnum):
    """How an allocation ended; the numbers are stable, recordings store them.

    Attributes:
        EXACT: the forces make the demanded wrench at the least cost over every subset. Nothing to mend.
        CLOSEST: no allowed forces make the demanded wrench; these make the closest attainable one.
            Remedy: ask for less, allow thrusters to rest, or change ``wrench_weights`` to say which rows may give.
        INVALID_WRENCH: the demand holds a NaN or an infinity, so it was answered as a zero demand.
            Remedy: mend the controller that produced it; the vehicle coasts meanwhile.
        MISSED: a method that is not exact made another wrench than the demanded one; whether that was attainable it
            does not know. Remedy: an exact method, or a controller that makes up for the error.
        FORBIDDEN_FORCE: a method blind to limits asks a thruster for a force outside its allowed set, which will
            make another. Remedy: a method that knows the limits.
        UNPROVEN: the forces make the demanded wrench, but the search gave up before it had proof that none do at
            less cost. Remedy: the objective ``energy``, fewer thrusters to choose between, or patience with the cost.
        UNPROVEN_CLOSEST: no forces that make the demanded wrench were found; these make the closest wrench found (or
            the largest scale found), without proof. Remedy: as for ``UNPROVEN`` and ``CLOSEST``.
        SCALED: no allowed forces make the demanded wrench; these make the largest part of it that keeps its direction
            and is attainable. Remedy: as for ``CLOSEST``.
        YIELDED: the primary part of the demand is made, and the largest share of the secondary part that is
            attainable together with it. Remedy: none where that is what priorities are for, else as for ``CLOSEST``.
    """

    EXACT = 0
    CLOSEST = 1
    INVALID_WRENCH = 2
    MISSED = 3
    FORBIDDEN_FORCE = 4
    UNPROVEN = 5
    UNPROVEN_CLOSEST = 6
    SCALED = 7
    YIELDED = 8

    @property
    def message(self) -> str:
        """What happened, for a log."""
        return _MESSAGES[self]


_MESSAGES = {
    Status.EXACT: "the demanded wrench is attainable again",
    Status.CLOSEST: "the demanded wrench is out of reach: the closest attainable one is made",
    Status.INVALID_WRENCH: "the demanded wrench is not finite: it counts as zero",
    Status.MISSED: "the allocation misses the demanded wrench",
    Status.FORBIDDEN_FORCE: "the allocation asks a thruster for a force outside its allowed set",
    Status.UNPROVEN: "the demanded wrench is made, perhaps not at the least cost",
    Status.UNPROVEN_CLOSEST: "no forces making the demanded wrench were found: the best wrench found is made",
    Status.SCALED: "the demanded wrench is out of reach: the largest part of it in its direction is made",
    Status.YIELDED: "the demanded wrench is out of reach: its secondary part gives way to the primary one",
}


class Allocation(NamedTuple):
    """Thruster forces for one demanded wrench.

    Attributes:
        force: (m,) thruster forces [N], each inside its allowed set.
        wrench: (n,) the wrench these forces make, ``A @ force`` [N, N m].
        wrench_error: (n,) demanded minus achieved wrench [N, N m]; NaN nowhere, also for an invalid demand,
            which counts as zero.
        residual: norm of ``wrench_error`` [N], its torque rows divided by ``Allocator.length_m``.
        cost: ``sum w (f - target)^2`` of the objective plus reversal penalties [N^2].
        subset: (m,) int8, the side each thruster works on: -1 negative, 0 off, +1 positive.
        status: how the allocation ended.
    """

    force: NDArray[np.float64]
    wrench: NDArray[np.float64]
    wrench_error: NDArray[np.float64]
    residual: float
    cost: float
    subset: NDArray[np.int8]
    status: Status


class Allocations(NamedTuple):
    """Thruster forces for N demanded wrenches in order, the fields of `Allocation` with N rows each.

    Attributes:
        force: (N, m) [N].
        wrench: (N, n) [N, N m].
        wrench_error: (N, n) [N, N m].
        residual: (N,) [N].
        cost: (N,) [N^2].
        subset: (N, m) int8.
        status: (N,) int8, the numbers of `Status`.
    """

    force: NDArray[np.float64]
    wrench: NDArray[np.float64]
    wrench_error: NDArray[np.float64]
    residual: NDArray[np.float64]
    cost: NDArray[np.float64]
    subset: NDArray[np.int8]
    status: NDArray[np.int8]

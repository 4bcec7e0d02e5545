"""The three stages of an answer, the same for every exact method: the demand itself, else a share of it, else closest.

========  ==================================  =============================================  ===================
stage     tried                               makes                                          status
========  ==================================  =============================================  ===================
EXACTLY   always                              the demand                                     EXACT
SHARE     when a part of it may give way      the primary part and the largest attainable    YIELDED, or SCALED
                                              share of the secondary one; of a single part   for one part only
                                              only where that is more than nothing
NEAREST   always                              the wrench closest to the part made so far,    CLOSEST, or as
                                              or to the demand                               above
========  ==================================  =============================================  ===================

What SHARE and NEAREST make lies at the border of what is attainable, where the rounding of A's entries decides much. By
the matrix that was meant, a whole line of forces may make the same wrench, or several wrenches may be as close. By one
published to seven digits, one of these is closer by 1e-5 N, and all forces but one need a thruster 1e-6 N beyond its
limit: nothing, for which up to eighty times the cost was paid. So both stages look once more, within what the rounding
hides (`MATRIX_ROUNDING`), for forces that save more than that gives away (`WORTHWHILE`).

A share lies at the border of what is attainable. Rounding may leave too little for the forces of the second stage; the
third then makes the closest wrench to that share, with the status of the second.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation.exact.origins import nearest_origins, share_origin
from cube_sim.allocation.exact.problem import AllocationProblem, ClosestWrenchData
from cube_sim.allocation.exact.step import StepLimits
from cube_sim.native.compiled import inlined

EXACT, CLOSEST, INVALID_WRENCH, UNPROVEN, UNPROVEN_CLOSEST, SCALED, YIELDED = 0, 1, 2, 5, 6, 7, 8
"""The numbers of `Status`."""

WORTHWHILE = 1e-3
"""Share of the cost that must be saved to miss a wrench by the rounding of A: to widen limits saves a little always."""

STAGES = 3
EXACTLY, SHARE, NEAREST = 0, 1, 2


class Demand(NamedTuple):
    """One demanded wrench and its parts, (n,) each [N], [N m].

    Attributes:
        whole: all that is demanded.
        primary: the part that does not give way; zero where a demand of one part is scaled.
        secondary: the part that does.
        part: what the last stage makes the closest wrench to.
    """

    whole: NDArray[np.float64]
    primary: NDArray[np.float64]
    secondary: NDArray[np.float64]
    part: NDArray[np.float64]


@inlined
def read_demand(demands: NDArray[np.float64], at: int, two_parts: bool, demand: Demand) -> bool:
    """Take one demand apart; return whether it is finite. One that is not counts as zero.

    Args:
        demands: flat; from ``at`` on (n,), or (2 n,) with the secondary part behind the primary one.
        at: where the demand begins.
        two_parts: whether there are two.
        demand: out.
    """
    n = demand.whole.shape[0]
    second = at + n if two_parts else at
    valid = True
    for a in range(n):
        demand.whole[a] = demands[at + a] + demands[second + a] if two_parts else demands[at + a]
        valid = valid and math.isfinite(demand.whole[a])
    for a in range(n):
        demand.whole[a] = demand.whole[a] if valid else 0.0
        demand.primary[a] = demands[at + a] if two_parts and valid else 0.0
        demand.secondary[a] = demands[second + a] if two_parts and valid else demand.whole[a]
        demand.part[a] = demand.primary[a] if two_parts else demand.whole[a]
    return valid


@inlined
def origins_of_stage(
    stage: int,
    status: int,
    problem: AllocationProblem,
    closest: ClosestWrenchData,
    limits: StepLimits,
    demand: Demand,
    valid: bool,
    two_parts: bool,
    origin: NDArray[np.float64],
) -> tuple[NDArray[np.float64], int, int, int, bool]:
    """Forces of the wrenches that SHARE or NEAREST tries to make, dead zones aside.

    EXACTLY is `attainable_origin`, which callers call themselves: most demands end there, and handing all of this
    over takes as long as a tenth of the search for their forces.

    Args:
        stage: SHARE or NEAREST.
        status: of the stage before.
        problem: of the vehicle.
        closest: of the vehicle.
        limits: sides of this call.
        demand: from `read_demand`; its ``part`` is changed by SHARE.
        valid: from `read_demand`.
        two_parts: whether the demand has two parts.
        origin: (1, m) to write one row of forces to [N].

    Returns:
        (c, m) forces [N]; how many of the rows, the first, make what the stage is after; the status; nodes looked at;
        whether the stage is proven. Rows of NEAREST beyond those make wrenches as close but for the rounding of A.
    """
    origins, count, looked, proven = origin, 0, 0, True
    if stage == NEAREST:
        origins, count, looked, proven = nearest_origins(
            problem.A, closest.metric, problem.solutions, problem.largest_wrench, limits, problem.hidden, demand.part
        )
    else:
        status = CLOSEST
        if valid and (two_parts or problem.scaled):
            share, looked, proven = share_origin(
                closest, problem.largest_wrench, limits, demand.primary, demand.secondary, origin[0], demand.part
            )
            count = int(share >= 0.0) if two_parts else int(makes_any(origin[0], limits.tolerance))
            if count > 0:
                status = YIELDED if two_parts else SCALED
            elif not two_parts:
                # To make nothing of a demand that stays would be to make nothing for ever.
                for a in range(demand.part.shape[0]):
                    demand.part[a] = demand.whole[a]
    return origins, count, status, looked, proven


@inlined
def makes_any(force: NDArray[np.float64], tolerance: float) -> bool:
    """Whether any of the forces (m,) [N] is more than rounding."""
    some = False
    for i in range(force.shape[0]):
        some = some or abs(force[i]) > tolerance
    return some


@inlined
def final_status(status: int, valid: bool, proven: bool) -> int:
    """The status of an answer, from that of the stage which made it."""
    if not valid:
        return INVALID_WRENCH
    if proven:
        return status
    return UNPROVEN if status == EXACT else UNPROVEN_CLOSEST

"""What is left after every possible loss of a few thrusters."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from math import comb

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.actuation.attainable.extents import Extent, extents, force_corners, torque_corners
from cube_sim.actuation.directions.subspaces import subspaces
from cube_sim.actuation.path_following.requirements import PathRequirements
from cube_sim.actuation.path_following.verdict import Verdict, judge
from cube_sim.errors import ActuationError
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.limits import thruster_limits
from cube_sim.wrench.matrix import actuation_matrix, lever_arm
from cube_sim.wrench.names import left_after, thruster_names

MOST_CASES = 2000
"""Of a table; they take some minutes."""


@dataclass(frozen=True)
class LossCase:
    """A vehicle without some of its thrusters.

    Attributes:
        lost: their names, beside those of `Survivability.already`; empty for the vehicle as it is.
        rank: of what is left.
        pure_forces: number of independent forces producible with zero torque.
        pure_torques: number of independent torques producible with zero force.
        unreachable: the lost combinations in words.
        strongest_force: largest force [N] with zero torque, in its best direction, dead zones left out.
        strongest_torque: largest torque [N m] with zero force, in its best direction.
        extents: attainable range of each component, with and without dead zones.
        verdict: whether a path can still be followed.
    """

    lost: tuple[str, ...]
    rank: int
    pure_forces: int
    pure_torques: int
    unreachable: tuple[str, ...]
    strongest_force: float
    strongest_torque: float
    extents: tuple[Extent, ...]
    verdict: Verdict


@dataclass(frozen=True)
class Survivability:
    """A vehicle as it is and every loss of up to `most` more of its thrusters.

    Attributes:
        names: (m,) the thrusters it has.
        already: names of those it has lost before.
        most: largest number of thrusters lost together.
        cases: by number of losses, then in the order of the thrusters; no further loss first.
    """

    names: tuple[str, ...]
    already: tuple[str, ...]
    most: int
    cases: tuple[LossCase, ...]

    def case(self, *lost: str) -> LossCase:
        """The case of exactly these losses, in any order.

        Raises:
            ActuationError: it was not computed.
        """
        for case in self.cases:
            if set(case.lost) == set(lost):
                return case
        raise ActuationError(
            f"no case without {', '.join(lost)}; up to {self.most} of {', '.join(self.names)} are lost"
        )

    def of(self, losses: int) -> tuple[LossCase, ...]:
        """All cases of this many losses."""
        return tuple(case for case in self.cases if len(case.lost) == losses)


def survivability(
    A: ArrayLike,
    limits: ArrayLike,
    *,
    names: Sequence[str] | None = None,
    lost: Sequence[str] = (),
    hull: Dynamics | None = None,
    requirements: PathRequirements | None = None,
    most: int = 3,
    length_m: float | None = None,
    rank_tolerance: float | None = None,
    cost_limit: float | None = None,
    rest: bool = True,
    progress: Callable[[int, int], None] | None = None,
) -> Survivability:
    """Judge every loss of up to `most` thrusters on top of those already lost.

    Arguments as in `cube_sim.actuation.analyse`.

    Args:
        A: (6,m) or (3,m).
        limits: (m,4), (m,2) or one row [N].
        names: of the thrusters, default T1..Tm.
        lost: names of thrusters that are dead already.
        hull: the moving body, a vehicle's `dynamics`.
        requirements: what the verdict asks for.
        most: thrusters lost together at most; one is always left. Every case takes some tenths of a second.
        length_m: default the rms lever arm of the intact vehicle, for all cases.
        rank_tolerance: relative to the largest singular value of each case.
        cost_limit: [N/N], in each case.
        rest: whether a thruster may stand still inside its dead zone.
        progress: called with (cases done, all cases).

    Raises:
        ActuationError: the matrix, the limits or `most` are malformed, or there are more than `MOST_CASES` cases.
    """
    matrix, axes = actuation_matrix(A)
    everyone = thruster_names(names, matrix.shape[1])
    if most < 0:
        raise ActuationError(f"{most} thrusters cannot be lost")
    every_limit, present = thruster_limits(limits, len(everyone)), left_after(everyone, lost)
    table = every_limit[present]
    length = lever_arm(matrix, axes) if length_m is None else length_m
    matrix, all_names, m = matrix[:, present], tuple(everyone[i] for i in present), len(present)
    deepest = min(most, m - 1)
    total = sum(comb(m, k) for k in range(deepest + 1))
    if total > MOST_CASES:
        raise ActuationError(
            f"{deepest} of {m} thrusters are lost in {total} ways; {MOST_CASES} are the most: ask for fewer"
        )
    cases: list[LossCase] = []
    for losses in range(deepest + 1):
        for more in combinations(range(m), losses):
            keep = [i for i in range(m) if i not in more]
            left, left_limits = matrix[:, keep], table[keep]
            spaces = subspaces(left, length_m=length, rank_tolerance=rank_tolerance, cost_limit=cost_limit)
            allowed = AllowedForces.from_limits(left_limits, len(keep), dead_zones=False)
            cases.append(
                LossCase(
                    lost=tuple(all_names[i] for i in more),
                    rank=spaces.rank,
                    pure_forces=spaces.pure_forces.shape[1],
                    pure_torques=spaces.pure_torques.shape[1],
                    unreachable=tuple(str(combination) for combination in spaces.unreachable),
                    strongest_force=float(np.max(np.linalg.norm(force_corners(left, left_limits), axis=1))),
                    strongest_torque=float(np.max(np.linalg.norm(torque_corners(left, left_limits), axis=1))),
                    extents=extents(left, left_limits, rest=rest),
                    verdict=judge(spaces, hull, allowed, requirements),
                )
            )
            if progress is not None:
                progress(len(cases), total)
    already = tuple(name for name in everyone if name not in all_names)
    return Survivability(all_names, already, deepest, tuple(cases))

"""One call from an actuation matrix to everything there is to know about it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from numpy.typing import ArrayLike

from cube_sim.actuation.attainable.extents import Extent, extents
from cube_sim.actuation.directions.design_indices import Indices, indices
from cube_sim.actuation.directions.lost_combinations import Combination
from cube_sim.actuation.directions.selection_criteria import Directions, final_approach, first_approach, second_approach
from cube_sim.actuation.directions.subspaces import Subspaces, subspaces
from cube_sim.actuation.path_following.requirements import PathRequirements
from cube_sim.actuation.path_following.verdict import Verdict, judge
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.allowed_forces import AllowedForces
from cube_sim.wrench.axes import Matrix, Vector
from cube_sim.wrench.limits import thruster_limits
from cube_sim.wrench.matrix import actuation_matrix, lever_arm
from cube_sim.wrench.names import left_after, thruster_names


@dataclass(frozen=True)
class Analysis:
    """What a set of thrusters can do.

    Attributes:
        names: (m,) of the thrusters that are left.
        lost: names of those that are not.
        subspaces: range, kernel, projector, all solutions, of the thrusters that are left.
        gains: (rank,) the report's first approach with singular vectors [N/N].
        component_costs: (n,) second approach: least thruster-force norm per scaled newton of each component alone.
        directions: final approach: eigen directions and their costs, least costly first.
        kept: the `rank` least costly of them: those that count, for a controller to work with.
        dropped: (d,) why each of the directions is not among these: "rank", "cost", or "" for one that is.
        extents: attainable range of each component; None without limits.
        indices: figures of merit of the layout.
        verdict: whether a path can be followed, and why.
    """

    names: tuple[str, ...]
    lost: tuple[str, ...]
    subspaces: Subspaces
    gains: Vector
    component_costs: Vector
    directions: Directions
    kept: Directions
    dropped: tuple[str, ...]
    extents: tuple[Extent, ...] | None
    indices: Indices
    verdict: Verdict

    @property
    def matrix(self) -> Matrix:
        """A (n,m) of the thrusters that are left."""
        return self.subspaces.matrix

    @property
    def rank(self) -> int:
        """How many directions count: by the relative threshold, or by cost where a limit was given."""
        return self.subspaces.rank

    @property
    def redundancy(self) -> int:
        """m - rank."""
        return self.subspaces.redundancy

    @property
    def unreachable(self) -> tuple[Combination, ...]:
        """Independent combinations of wrench components that stay zero, or as good as zero, in numbers and words."""
        return self.subspaces.unreachable


def analyse(
    A: ArrayLike,
    limits: ArrayLike | None = None,
    *,
    names: Sequence[str] | None = None,
    lost: Sequence[str] = (),
    hull: Dynamics | None = None,
    requirements: PathRequirements | None = None,
    length_m: float | None = None,
    rank_tolerance: float | None = None,
    cost_limit: float | None = None,
    rest: bool = True,
) -> Analysis:
    """Analyse an actuation matrix, with all its thrusters or without some.

    Args:
        A: (6,m) rows Fx Fy Fz Mx My Mz, or (3,m) rows Fx Fy Mz; F_B = A F_m.
        limits: (m,4) [F_max-, F_DZ-, F_DZ+, F_max+] [N], (m,2), or one row; without them no extents.
        names: of the thrusters, default T1..Tm.
        lost: names of thrusters that are dead.
        hull: the moving body for the verdict, a vehicle's `dynamics`; without one, `Dynamics.neutral`.
        requirements: what the verdict asks for; default `PathRequirements()`.
        length_m: what torques are divided by [m]; default the rms lever arm of all thrusters, lost ones included.
        rank_tolerance: relative to the largest singular value; by default 1 %, and with a cost limit nothing but
            rounding: cost then decides alone.
        cost_limit: [N/N] above which a direction is dropped, as if the thrusters could not produce it; default none.
        rest: whether a thruster may stand still inside its dead zone.

    Raises:
        ActuationError: something among the arguments is malformed, or no thruster is left.
    """
    matrix, axes = actuation_matrix(A)
    m = matrix.shape[1]
    all_names = thruster_names(names, m)
    keep = left_after(all_names, lost)
    length = lever_arm(matrix, axes) if length_m is None else length_m
    left = matrix[:, keep]
    table, allowed = None, None
    if limits is not None:
        table = thruster_limits(limits, m)[keep]
        allowed = AllowedForces.from_limits(table, len(keep), dead_zones=False)
    spaces = subspaces(left, length_m=length, rank_tolerance=rank_tolerance, cost_limit=cost_limit)
    directions = final_approach(left, length_m=length)
    return Analysis(
        names=tuple(all_names[i] for i in keep),
        lost=tuple(name for name in all_names if name in set(lost)),
        subspaces=spaces,
        gains=first_approach(left, length_m=length),
        component_costs=second_approach(left, length_m=length),
        directions=directions,
        kept=directions.least_costly(spaces.rank),
        dropped=spaces.threshold.dropped(directions.gains),
        extents=None if table is None else extents(left, table, rest=rest),
        indices=indices(spaces, allowed),
        verdict=judge(spaces, hull, allowed, requirements),
    )

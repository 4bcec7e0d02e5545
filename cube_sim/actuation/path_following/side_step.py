"""How far a vehicle can step to the side of its course in a given time: a linear programme over all its forces."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cube_sim.actuation.path_following.linear_motion import LinearMotion
from cube_sim.errors import ActuationError
from cube_sim.wrench.axes import Matrix, Vector

_STEPS = 10
_MADE_GOOD = 1e-9


@dataclass(frozen=True)
class SideStepBounds:
    """Within these a side step must stay: beyond them small motions say nothing.

    Attributes:
        horizon_s: the time it may take.
        most_turn_rad: largest rotation about each body axis.
        fastest_m_s: largest change of each component of the velocity.
        furthest_m: longer steps are not looked for.
    """

    horizon_s: float
    most_turn_rad: float
    fastest_m_s: float
    furthest_m: float


def side_step(
    motion: LinearMotion, low: Vector, high: Vector, within: SideStepBounds, *, above_m: float = 0.0
) -> float:
    """Largest displacement [m] that can be made good to either side of a course and, in 3-D, up and down: the least.

    It leads from the course to a parallel one. At the end the vehicle moves along that (no cross-track rate) and has
    stopped turning; slip and the angle that makes up for it may be left. It is the maximum over all histories of the
    forces, held over ten equal steps. The bounds are looked at where a step ends. A thruster fewer can only shorten it.

    Args:
        motion: about the course.
        low: (m,) what each force may change by downwards [N], not positive.
        high: (m,) and upwards [N], not negative.
        within: the bounds.
        above_m: a direction that does not exceed this ends the search; its displacement is returned.

    Raises:
        ActuationError: the linear programme could not be solved.
    """
    manoeuvre = _Manoeuvre.of(motion, low, high, within)
    least = within.furthest_m
    for side in np.concatenate([np.eye(len(motion.C)), -np.eye(len(motion.C))]):
        if manoeuvre.least_effort(side) < within.furthest_m:
            least = min(least, manoeuvre.longest(side))
        if least <= above_m:
            break
    return least


@dataclass(frozen=True)
class _Manoeuvre:
    """The side step in units of its bounds: x_j+1 = A_d x_j + B_d u_j, ends x_N = [displacement, 0].

    Attributes:
        A_d: (k,k).
        B_d: (k,m).
        ends: (e,k) rows that read displacement [m], then cross-track rates and angular velocities.
        largest: (k,) bound of each state, infinite where there is none.
        low: (m,) bounds of u.
        high: (m,)
        furthest_m: bound of the displacement.
    """

    A_d: Matrix
    B_d: Matrix
    ends: Matrix
    largest: Vector
    low: Vector
    high: Vector
    furthest_m: float

    @staticmethod
    def of(motion: LinearMotion, low: Vector, high: Vector, within: SideStepBounds) -> _Manoeuvre:
        largest = np.full(len(motion.A), np.inf)
        largest[motion.angles], largest[motion.speeds] = within.most_turn_rad, within.fastest_m_s
        unit = np.where(np.isfinite(largest), largest, 1.0)
        span = np.where(high > low, high - low, 1.0)
        A_d, B_d = motion.sampled(within.horizon_s / _STEPS)
        still = np.vstack([motion.C @ motion.A, np.eye(len(unit))[motion.rates]])
        return _Manoeuvre(
            A_d=A_d * unit / unit[:, None],
            B_d=B_d * span / unit[:, None],
            ends=np.vstack([motion.C, still]) * unit,
            largest=largest / unit,
            low=low / span,
            high=high / span,
            furthest_m=within.furthest_m,
        )

    def least_effort(self, side: Vector) -> float:
        """A displacement [m] that is possible: the forces of least square sum, scaled until something meets its bound.

        Args:
            side: (c,) unit vector across the course.
        """
        margins = np.minimum(self.high, -self.low)
        blocks = [self.B_d * margins]
        for _ in range(_STEPS - 1):
            blocks.append(self.A_d @ blocks[-1])
        transfer = self.ends @ np.hstack(blocks[::-1])
        aim = np.r_[side, np.zeros(len(transfer) - len(side))]
        u = np.linalg.lstsq(transfer, aim, rcond=1e-10)[0]
        if np.max(np.abs(transfer @ u - aim)) > _MADE_GOOD:
            return 0.0
        used, x = float(np.max(np.abs(u))), np.zeros(len(self.A_d))
        for step in u.reshape(_STEPS, -1):
            x = self.A_d @ x + self.B_d @ (margins * step)
            used = max(used, float(np.max(np.abs(x) / self.largest)))
        return 1.0 / used

    def longest(self, side: Vector) -> float:
        """The longest displacement [m], up to the furthest, as a linear programme.

        The unknowns are the state after each step, the forces of each step and the displacement, in this order.

        Args:
            side: (c,) unit vector across the course.
        """
        from scipy.optimize import Bounds, LinearConstraint, milp
        from scipy.sparse import csc_array

        k, m = self.B_d.shape
        states = _STEPS * k
        rows = np.zeros((states + len(self.ends), states + _STEPS * m + 1))
        for j in range(_STEPS):
            after, before = slice(j * k, (j + 1) * k), slice((j - 1) * k, j * k)
            rows[after, after] = np.eye(k)
            if j:
                rows[after, before] = -self.A_d
            rows[after, states + j * m : states + (j + 1) * m] = -self.B_d
        rows[states:, states - k : states] = self.ends
        rows[states : states + len(side), -1] = -side
        bounds = np.tile(self.largest, _STEPS)
        aim = np.zeros(rows.shape[1])
        aim[-1] = -1.0
        # Without integers milp is HiGHS' simplex method; presolving a problem this small takes longer than solving it,
        # but where rounding leaves the simplex method without an answer, presolving may find one.
        found = None
        for presolve in (False, True):
            found = milp(
                aim,
                constraints=LinearConstraint(csc_array(rows), 0.0, 0.0),
                bounds=Bounds(
                    np.r_[-bounds, np.tile(self.low, _STEPS), 0.0],
                    np.r_[bounds, np.tile(self.high, _STEPS), self.furthest_m],
                ),
                options={"presolve": presolve},
            )
            if found.x is not None:
                return float(found.x[-1])
        raise ActuationError(f"how far the vehicle can step aside could not be computed: {found.message}")

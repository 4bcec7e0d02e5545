"""What the thrusters still working can do for path following, and how the vehicle goes on with it.

A path needs forces; torques point them. What thrusters cannot produce are combinations N_f' F + N_t' M of both. A
torque about a level axis need not be produced where the hull rights itself: then every force is there, and roll or
pitch stay at trim. Where forces drag along more torque than the hull holds, forces give way, and the attitude has to
point the others. The number of directions of force that are left decides:

    3     the vehicle moves freely, at trim
    2, 1  the attitude points them where force is needed
    0     the vehicle cannot follow a path

Vehicles built for a level plane are judged in that plane, also where a thruster has been mounted a little high or low:
what then comes with their motion tilts them by next to nothing. They float upright. With surge, sway and yaw they move
freely in it; with yaw and one direction of force the heading points that force, as a unicycle does.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from functools import cached_property
from math import inf

import numpy as np

from cube_sim.control.pace import ForceBudget
from cube_sim.control.turned_round import TurnedRound
from cube_sim.spatial import Matrix, Record, Vector

OUT_OF_PLANE = np.array([False, False, True, True, True, False])
"""Heave, roll and pitch among the components of a wrench."""

CAPABILITY = np.dtype(
    [
        ("projector", np.float64, (6, 6)),
        ("shift", np.float64, 6),
        ("dragged", np.float64, (3, 3)),
        ("by_momentum", np.bool_),
        ("by_flow", np.bool_),
    ]
)
"""What compiled laws know of `Capability`: `project_onto_range` as projector w + shift, how a turning drags the hull
along, (3,3) [m], whether its attitude points a force that corrects its momentum, not its velocity, and whether it is
the flow that steers it."""


class Authority(IntEnum):
    """How a vehicle flies; the numbers are stable, recordings store them.

    Attributes:
        HOLONOMIC: all forces and torques: any motion in any attitude.
        PLANE: two directions of pure force, pointed by the attitude.
        LINE: one direction of pure force, pointed by the attitude.
        SAFE: no path can be followed.
        LEVEL: surge, sway and yaw and nothing else: any motion in a level plane.
        UNICYCLE: yaw and one direction of force in a level plane, pointed by the heading.
        TRIM: yaw and forces; roll or pitch stay where the water holds them.
        TURNED: forces, in whichever attitude what is stuck turns the hull to.
    """

    HOLONOMIC = 0
    PLANE = 1
    LINE = 2
    SAFE = 3
    LEVEL = 4
    UNICYCLE = 5
    TRIM = 6
    TURNED = 7


POINTING = (Authority.PLANE, Authority.LINE, Authority.UNICYCLE)
"""Ways of flying in which the attitude has to point the thrust."""


@dataclass(frozen=True)
class Capability:
    """What is left, and the projection of demands onto it.

    Attributes:
        authority: how to fly.
        pure_forces: P (3,p) orthonormal directions of force without torque, body axes.
        reason: one line for the log.
        lost_forces: N_f (3, 6 - rank) and
        lost_torques: N_t (3, 6 - rank) of the combinations N_f' F + N_t' M = b that hold for all the thrusters can do.
        yielding: D (6, 6 - rank) what gives way in a demand off the range of A, see `cube_sim.control.yielding`.
        effort: Q (6,6) [1, 1/m, 1/m^2], of `effort_matrix`.
        held: (6,) [N, N m] the wrench of thrusters that are stuck; it comes on top of whatever the others do.
        within_cost_limit: (6,6) projector onto the wrenches within the cost limit; None where no direction exceeds it.
        budget: what they can make; None where their limits are not known.
        strongest: force of the strongest of all thrusters, as they were whole [N]; infinite where it is not known.
        turned: how it is turned round, by its equations of motion; None for any other authority.
        by_flow: whether fins steer it, which without way on make nothing.
    """

    authority: Authority
    pure_forces: Matrix
    reason: str
    lost_forces: Matrix
    lost_torques: Matrix
    yielding: Matrix
    effort: Matrix
    held: Vector
    within_cost_limit: Matrix | None = None
    budget: ForceBudget | None = None
    strongest: float = inf
    turned: TurnedRound | None = None
    by_flow: bool = False

    def __getstate__(self) -> dict[str, object]:
        """What a copy takes over, taken at once: another thread may be filling in what is cached here."""
        return dict(self.__dict__)

    @property
    def lost(self) -> Matrix:
        """N (6, 6 - rank) of the combinations N' w = b, forces above torques."""
        return np.concatenate([self.lost_forces, self.lost_torques])

    @property
    def constants(self) -> Vector:
        """b (6 - rank,) [N], N' times the held wrench: zero while nothing is stuck."""
        return self.lost_forces.T @ self.held[:3] + self.lost_torques.T @ self.held[3:]

    @property
    def level(self) -> bool:
        """Whether it moves in a level plane only."""
        return self.authority in (Authority.LEVEL, Authority.UNICYCLE)

    @property
    def steers_by_attitude(self) -> bool:
        """Whether force has to be pointed where it is needed."""
        return self.authority in (*POINTING, Authority.TRIM)

    @property
    def dragged_force(self) -> Matrix:
        """(3,3) [1/m]: the force that comes with a torque, as forces give way to it."""
        if not self.steers_by_attitude:
            return np.zeros((3, 3))
        return -self.yielding[:3] @ np.linalg.solve(self.lost.T @ self.yielding, self.lost_torques.T)

    def project_onto_range(self, wrenches: Matrix) -> Matrix:
        """Wrenches (6,) or (q,6) in the range of A, displaced by the held one, that a demand gives way to.

        All that can be produced has N' w = N_f' F + N_t' M = b; w moves by -D (N' D)^-1 (N' w - b), D what yields. No
        limits of the thrusters are looked at. Where no path can be followed the wrench is left to the allocation, which
        comes as close as it can; directions beyond the cost limit are taken out of it there, too.
        """
        projector, shift = self.onto_range
        return wrenches @ projector.T + shift

    @cached_property
    def onto_range(self) -> tuple[Matrix, Vector]:
        """`project_onto_range` as a matrix (6,6) and what is added (6,)."""
        projector, shift = np.eye(6), np.zeros(6)
        if self.steers_by_attitude:
            lost = self.lost
            back = self.yielding @ np.linalg.inv(lost.T @ self.yielding)
            projector, shift = projector - back @ lost.T, back @ self.constants
        elif self.within_cost_limit is not None:
            projector = self.within_cost_limit
            shift = self.held - projector @ self.held
        if self.level:
            out = np.diag(OUT_OF_PLANE.astype(float))
            shift = shift + projector @ out @ self.held
            projector = projector @ (np.eye(6) - out)
        return projector, shift

    def record(self, total_mass: Matrix) -> Record:
        """What compiled laws know of it: (1,) of `CAPABILITY`.

        Args:
            total_mass: M (6,6) of the hull.
        """
        record = np.zeros(1, CAPABILITY)
        record["projector"], record["shift"] = self.onto_range
        record["dragged"] = np.linalg.solve(total_mass[:3, :3], self.dragged_force @ total_mass[3:, 3:])
        record["by_flow"] = self.by_flow
        record["by_momentum"] = self.authority in POINTING
        return record

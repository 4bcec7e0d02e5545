"""Which part of a demand gives way where missing thrusters couple forces with torques.

All that can be produced has N_f' F + N_t' M = b. A demand off it has to be changed, in its forces or in its torques. A
force that is not made moves the vehicle off its path. A torque about a level axis that is not made tilts the hull until
its righting moment makes up for it. So torques about level axes give way first, as far as the hull can hold them: with
a tilt of 30 degrees at most, a righting moment r holds the torque of a force F on a lever of r / (2 F). F is what
missions ask for along the axis whose force brings the torque, not along the broadest. On a longer lever the force gives
way, and the attitude has to point it (`balanced_attitude`).

Not so where it is torques alone that are missing: where all that is lost has a lever no longer than the thrusters' own
arms, and lies about level axes. Then every force is there in every attitude, and the place does not depend on the tilt.
The hull comes to rest in the water tilted farther, where its Munk moment, too, is part of the balance. On a lever many
times longer it is a force that is missing, and the least of it would spin the hull.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from cube_sim.spatial import Matrix, Vector
from cube_sim.vehicle.dynamics import Dynamics
from cube_sim.wrench.tolerances import RANK_TOLERANCE

FORCES_YIELD = np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0])
"""W of a hull that holds nothing: forces give way, torques do not."""
SMALL_FORCE = 1e-3
"""Share of the weight below which a force counts as none."""
MAX_TILT_SINE = 0.5
"""How far the hull may be tilted by torques that are left to it: by 30 degrees."""
LONGEST_ARMS = 1.2
"""Lever, in the thrusters' rms arms, up to which what is missing is a torque (a choice: where the water could hold all
that is missing, the catalogue has none between 3 and 90)."""


class WaterHold(NamedTuple):
    """What the water holds of a hull by itself.

    Attributes:
        righting: r (3,) [N m], body axes, see `Dynamics.righting_moment`.
        force: the sizes of the forces (3,) that its missions ask for [N], body axes, positive.
        hull: whose it is; None where only the righting moment is known.
        speed: of its missions [m/s].
        inclinations: (n,) angles of its courses above the horizontal [rad], where some of what moves it does so at that
            speed only, straight ahead: fins. None where nothing does.
    """

    righting: Vector
    force: Vector
    hull: Dynamics | None = None
    speed: float = 0.0
    inclinations: tuple[float, ...] | None = None

    @staticmethod
    def of(dynamics: Dynamics, speed_m_s: float, inclinations: tuple[float, ...] | None = None) -> WaterHold:
        """Of a hull whose missions ask for its drag at this speed, its weight less its buoyancy on top.

        Along each axis it is the drag of moving that way: a slender hull that is pushed sideways meets more of it, but
        its propeller's torque comes with the little that it meets ahead.
        """
        drag = np.array([np.linalg.norm(dynamics.damping(speed_m_s * axis)[:3]) for axis in np.eye(6)[:3]])
        force = drag + abs(dynamics.weight - dynamics.buoyancy)
        size = np.hypot(force, SMALL_FORCE * max(1.0, dynamics.weight))
        return WaterHold(dynamics.righting_moment, size, dynamics, speed_m_s, inclinations)

    def weights(self, up: Vector) -> Matrix:
        """W (6,6) [1, m^2]: how readily each force and torque gives way; W^-1 is the price of a change.

        W = diag(F^2, (r'z / 2)^2 (I - z z')) / max(F)^2. Torques about the vertical z, and all torques of a hull that
        does not right itself, do not give way: nothing else holds them.

        Args:
            up: z = R' e_z (3,), world up in body axes.
        """
        W, largest = np.zeros((6, 6)), float(np.max(self.force))
        W[:3, :3] = np.diag((self.force / largest) ** 2)
        lever = MAX_TILT_SINE * max(0.0, float(self.righting @ up)) / largest
        W[3:, 3:] = lever**2 * (np.eye(3) - np.outer(up, up))
        return W

    def arm_weights(self, up: Vector, length_m: float) -> Matrix:
        """W (6,6) [1, m^2] by which a torque about a level axis gives way on any lever shorter than a length.

        See `weights`; torques do not give way of a hull that does not right itself, either.
        """
        W = FORCES_YIELD.copy()
        if float(self.righting @ up) > 0.0:
            W[3:, 3:] = length_m**2 * (np.eye(3) - np.outer(up, up))
        return W


class Yielding(NamedTuple):
    """What gives way in a demand that the thrusters cannot produce.

    Attributes:
        directions: D (6,k), one for each lost combination: torques that the hull holds, or forces.
        pointed: how many of them are forces, which the attitude has to point.
    """

    directions: Matrix
    pointed: int


def held_or_pointed(lost: Matrix, hold: WaterHold | None, up: Vector, length_m: float) -> Yielding | None:
    """Who gives way for each lost combination of a hull that is upright: torques alone where they can, else both kinds.

    Args:
        lost: see `yielding_directions`, like the answer.
        hold: what the water holds of the hull; None for nothing.
        up: (3,) world up in body axes.
        length_m: the thrusters' rms lever arm [m].
    """
    found = yielding_directions(lost, FORCES_YIELD if hold is None else hold.weights(up), length_m)
    if found is None or found.pointed == 0 or hold is None:
        return found
    tilted = yielding_directions(lost, hold.arm_weights(up, LONGEST_ARMS * length_m), length_m)
    return tilted if tilted is not None and tilted.pointed == 0 else found


def yielding_directions(lost: Matrix, weights: Matrix, length_m: float) -> Yielding | None:
    """Who gives way for each lost combination: its torques where they are the cheaper, else its forces. Never both.

    A share s of a combination falls on forces, the rest on torques: the eigenvalues of (N' W N)^-1 N_f' W_f N_f. Up to
    a half the torques take all of it, so that no attitude the hull cannot reach costs the path any force.

    Args:
        lost: N (6,k) the combinations N' w = b of all that can be produced [1, 1/m].
        weights: W (6,6), of `WaterHold.weights`.
        length_m: the thrusters' rms lever arm, which makes forces and torques comparable [m].

    Returns:
        None where some combination is neither pointed nor held: the vehicle cannot be steered.
    """
    scaled = np.concatenate([lost[:3], lost[3:] * length_m])
    firm = lost[:3].T @ lost[:3] + lost[3:].T @ weights[3:, 3:] @ lost[3:]  # a small force is pointed as a large one is
    if not np.linalg.eigvalsh(firm)[0] > (RANK_TOLERANCE * float(np.linalg.norm(scaled, 2))) ** 2:
        return None
    size, axes = np.linalg.eigh(lost.T @ weights @ lost)
    unit = lost @ axes / np.sqrt(size)
    _, share_roots, turn = np.linalg.svd(np.sqrt(weights[:3, :3]) @ unit[:3])
    shares = np.zeros(len(size))
    shares[: len(share_roots)] = share_roots**2
    forces = shares > 0.5
    directions = weights @ unit @ turn.T
    directions[3:, forces] = 0.0
    directions[:3, ~forces] = 0.0
    return Yielding(directions, int(np.count_nonzero(forces)))

"""The fins of a mission's vehicle: what the controller believes of them, and how they are asked for a wrench."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from cube_sim.allocation import FaultTolerant
from cube_sim.allocation.fin_shares import FinParts, steer_fins
from cube_sim.scenario import Scenario
from cube_sim.scenario.knowledge_block import KnowledgeBlock
from cube_sim.spatial import State, Vector
from cube_sim.vehicle.fin_health import FinHealth
from cube_sim.vehicle.fins import Fins, FinsAtSpeed
from cube_sim.vehicle.vehicle import Vehicle
from cube_sim.wrench.axes import SPATIAL
from cube_sim.wrench.matrix import lever_arm


def believed_fins(vehicle: Vehicle, knowledge: KnowledgeBlock) -> Fins | None:
    """The fins of a vehicle as the controller reckons with them; None where it has none."""
    return None if vehicle.fins is None else vehicle.fins.with_area(knowledge.fins)


def fins_at(vehicle: Vehicle, scenario: Scenario) -> FinsAtSpeed | None:
    """What they do at the speed of a scenario; None where there are none."""
    fins = believed_fins(vehicle, scenario.knowledge)
    return None if fins is None else fins.at_speed(scenario.guidance.speed_m_s)


class FinAnswer(NamedTuple):
    """What fins are asked for.

    Attributes:
        wanted: (k,) deflections [rad].
        made: (6,) what they make by them [N, N m], body axes.
        rest: (6,) what is left of the wrench for the thrusters.
        missed: how much of it nobody makes [N].
    """

    wanted: Vector
    made: Vector
    rest: Vector
    missed: float


@dataclass(frozen=True)
class FinSteering:
    """Shares wrenches between fins and thrusters.

    Attributes:
        fins: where they are in the model that flies.
        believed: their numbers as the controller knows them.
        period_s: of a tick.
        length_m: by which torques are compared with forces [m].
    """

    fins: Fins
    believed: Fins
    period_s: float
    length_m: float

    @staticmethod
    def of(flown: Vehicle, believed: Vehicle, allocator: FaultTolerant, scenario: Scenario) -> FinSteering | None:
        """Of a vehicle; None for one without fins.

        Args:
            flown: the vehicle in the model that flies.
            believed: as the controller knows it, before the factors of `knowledge`.
            allocator: over its thrusters.
            scenario: whose speed and control period count.
        """
        fins, at_speed = believed_fins(believed, scenario.knowledge), fins_at(believed, scenario)
        if flown.fins is None or fins is None or at_speed is None:
            return None
        together = np.column_stack([allocator.A, at_speed.matrix])
        return FinSteering(flown.fins, fins, scenario.control_period_s, lever_arm(together, SPATIAL))

    def parts(self, allocator: FaultTolerant, known: FinHealth, keeps_course: bool = False) -> FinParts:
        """What the sharing knows, with thrusters and fins in the state that is believed.

        A fin that does not steer is asked for where it is: what it makes there counts, and is nobody's to change.

        Args:
            allocator: over the thrusters.
            known: of the fins.
            keeps_course: whether they steer the hull.
        """
        health, scale = allocator.health, SPATIAL.scale(self.length_m)
        forces = np.ascontiguousarray(allocator.limits_now[:, [0, 3]] * health.efficiency[:, None])
        stuck = ~np.isnan(health.stuck)
        forces[stuck] = health.stuck[stuck, None]
        moving = scale[:, None] * allocator.A[:, forces[:, 0] < forces[:, 1]]
        beyond = np.eye(6) - (moving @ np.linalg.pinv(moving) if moving.size else 0.0)
        fins = self.believed
        rate = np.minimum(np.where(known.steers, fins.rate, 0.0), known.rate)
        reach = rate * (fins.lag_s + self.period_s)
        travel = np.clip(fins.travel, known.travel[:, :1], known.travel[:, 1:])
        travel[known.loose] = -np.pi, np.pi  # wherever the flow turns it
        tables = fins.table, fins.linear, fins.square
        return FinParts(*tables, travel, reach, allocator.A, forces, beyond, scale, keeps_course)

    def share(
        self, parts: FinParts, wrench: Vector, known: State, current: Vector, deflections: Vector, force_ratio: float
    ) -> FinAnswer:
        """Deflections for a wrench.

        Args:
            parts: of `parts`.
            wrench: (6,) [N, N m], body axes.
            known: the state the controller sees.
            current: (3,) as it is estimated [m/s], world axes.
            deflections: (k,) of the moment [rad].
            force_ratio: share of their force that the supply leaves the thrusters.
        """
        given = map(np.ascontiguousarray, (wrench, known.rotation, known.velocity, known.rates, current, deflections))
        out = np.empty(len(deflections)), np.empty(6), np.empty(6)
        return FinAnswer(*out, steer_fins(parts, *given, force_ratio, *out))

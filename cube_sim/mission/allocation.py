"""The allocation a scenario asks for, over the thrusters of its vehicle."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from cube_sim.allocation import FaultTolerant
from cube_sim.allocation.fault_tolerant import Build
from cube_sim.allocation.methods import is_exact, make_allocator
from cube_sim.allocation.protocol import WrenchAllocator
from cube_sim.mission.own.allocator import own_build
from cube_sim.mission.own.code import Codes, refused
from cube_sim.scenario import Loaded, Scenario
from cube_sim.scenario.python_block import PythonBlock
from cube_sim.vehicle.vehicle import Vehicle

DWELL_S = 1.0
"""Time on one side up to which a penalty counts in full [s]: it is the price of what saves as many N^2 for so long."""


def allocator_of(loaded: Loaded, vehicle: Vehicle, codes: Codes) -> FaultTolerant:
    """Wrench to thruster forces, as the `allocation` block says, by the matrix the controller believes in.

    Raises:
        ScenarioError: code of the user's own makes no allocator; with position.
    """
    scenario = loaded.scenario
    limits = clear_of_dead_zone(vehicle.thrusters.limits, scenario.allocation.dead_zone_margin)
    A = scenario.knowledge.thrust * vehicle.actuation_matrix
    method = scenario.allocation.method
    if not isinstance(method, PythonBlock):
        return FaultTolerant(A, limits, _build(method, vehicle, scenario))
    build = own_build(loaded, codes["allocation.method"], vehicle.thrusters)
    with refused(loaded):
        # An answer that is none is found before the flight.
        build(A, limits, np.arange(len(limits))).allocate(np.zeros(6))
        return FaultTolerant(A, limits, build)


def _build(method: str, vehicle: Vehicle, scenario: Scenario) -> Build:
    """What builds an allocator of cube_sim's for the thrusters that respond."""
    thrusters, block = vehicle.thrusters, scenario.allocation

    def build(A: NDArray[np.float64], limits: NDArray[np.float64], which: NDArray[np.int_]) -> WrenchAllocator:
        options: dict[str, Any] = {"allow_off": block.allow_off}
        if is_exact(method):
            weights = np.ones(6)
            weights[3:] = block.torque_weight
            options |= {
                "objective": block.objective,
                "wrench_weights": weights,
                "unattainable": block.unattainable,
                "reversal_penalty": block.reversal_penalty_N2,
                "switching_penalty": block.switching_penalty_N2,
                "dwell_calls": DWELL_S / scenario.control_period_s,
                "change_limit": block.change_limit_N,
            }
            if block.thruster_weights is not None:
                options["weights"] = np.array(block.thruster_weights)[which]
            if block.target_N is not None:
                options["target"] = np.array(block.target_N)[which]
            if block.objective.startswith("reactivity"):
                options["reactivity"] = thrusters.reactivity[which]
        return make_allocator(method, A, limits, options)

    return build


def clear_of_dead_zone(limits: NDArray[np.float64], margin: float) -> NDArray[np.float64]:
    """Limits whose dead zones are wider by the share `margin`, never beyond saturation.

    A lagging motor approaches a constant command from inside: commanded exactly onto the edge of its dead zone it
    would never start, and close to the edge it starts late, after lag * ln(1 / margin).

    Args:
        limits: (m,4) [F_max-, F_DZ-, F_DZ+, F_max+] [N].
        margin: share of F_DZ.
    """
    wider = limits.copy()
    wider[:, 1] = np.maximum(limits[:, 0], limits[:, 1] * (1.0 + margin))
    wider[:, 2] = np.minimum(limits[:, 3], limits[:, 2] * (1.0 + margin))
    return wider

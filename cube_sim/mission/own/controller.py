"""The controller that a factory of the user's own makes."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace

from cube_sim.control.authority import Capability
from cube_sim.control.controller import Controller, Decision
from cube_sim.guidance.law import TargetView
from cube_sim.mission.own.code import OwnCode, made, numbers_of, refused, without
from cube_sim.mission.own.compiled_law import CompiledLaw
from cube_sim.mission.own.compiled_part import CompiledPart
from cube_sim.mission.own.handed import handed
from cube_sim.mission.own.law import LawSetup, OwnLaw
from cube_sim.scenario import Loaded
from cube_sim.spatial import State, Vector


class OwnController:
    """A `Controller` of the user's own, whose decisions are looked at.

    Args:
        code: where it comes from.
        controller: it.
    """

    def __init__(self, code: OwnCode, controller: Controller) -> None:
        self._code, self._controller = code, controller

    def view(self, state: State) -> TargetView:
        """See `Controller.view`."""
        view: TargetView = self._code.call(self._controller.view, handed(state))
        return handed(view)

    def reconfigure(self, left: Capability) -> None:
        """See `Controller.reconfigure`."""
        self._code.call(self._controller.reconfigure, deepcopy(left))

    def decide(self, state: State, applied: Vector, dt: float, force_ratio: float = 1.0) -> Decision:
        """See `Controller.decide`."""
        decision = self._code.call(self._controller.decide, handed(state), applied.copy(), dt, force_ratio)
        if not isinstance(decision, Decision):
            raise self._code.refuse(f"answers {type(decision).__name__} to decide; it takes a Decision")
        for name, width in (("wrench", 6), ("secondary", 6), ("disturbance", 6), ("current", 3), ("quaternion", 4)):
            numbers_of(self._code, getattr(decision, name), (width,), f"the {name}")
        return handed(decision)


CONTROLLER_METHODS = "decide", "view", "reconfigure"


def own_controller(loaded: Loaded, code: OwnCode, setup: LawSetup) -> Controller:
    """The controller of what a factory makes: a function of an `Aim`, or a whole `Controller`.

    Raises:
        ScenarioError: it makes neither; with position.
    """
    own = replace(
        setup,
        vehicle=deepcopy(setup.vehicle),
        dynamics=deepcopy(setup.dynamics),
        A=setup.A.copy(),
        limits=setup.limits.copy(),
        capability=deepcopy(setup.capability),
    )
    law = made(loaded, code, own)
    with refused(loaded):
        if hasattr(law, "decide"):
            if missing := without(law, CONTROLLER_METHODS):
                raise code.refuse(f"makes a {type(law).__name__} without the method {missing}")
            return OwnController(code, law)
        if isinstance(law, CompiledPart):
            return CompiledLaw(code, law, setup)
        if not callable(law):
            raise code.refuse(f"makes a {type(law).__name__}; it takes a function of an aim, or an object with decide")
    return OwnLaw(code, law, setup)

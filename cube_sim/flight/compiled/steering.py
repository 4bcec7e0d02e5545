"""What the compiled loop is steered by: one of the two laws, or one of the user's own, and the others at rest."""

from __future__ import annotations

from functools import cache
from typing import NamedTuple

import numpy as np

from cube_sim.control.answering import LawParts
from cube_sim.control.answering_by_own import answer_by_own
from cube_sim.control.compiled_parts import attitude_address, resting_law
from cube_sim.control.controller import Controller
from cube_sim.control.path_follower import PathFollower
from cube_sim.control.planar.follower import PlanarFollower
from cube_sim.control.planar.steering import PlanarParts, resting_planar_law
from cube_sim.control.safe_mode import LossOfTargetMonitor, SafeMode
from cube_sim.control.shortage import SHORTAGE
from cube_sim.flight.compiled.callees import ANSWERING, STEERING
from cube_sim.guidance.law import Target
from cube_sim.mission.own.compiled_law import CompiledLaw
from cube_sim.native.apart import finish
from cube_sim.spatial import Matrix, Record


class Steering(NamedTuple):
    """A controller as the compiled loop flies it.

    Attributes:
        in_plane: whether the planar law steers.
        law: the law for all axes, at rest where the planar one steers.
        planar: the planar law, at rest where the other one steers.
        target: on the path.
        loss: record of `cube_sim.control.safe_mode.LOSS`; of one that is never lost where nobody asks.
        shortage: record of `cube_sim.control.shortage.SHORTAGE`.
        steers: whether the attitude is balanced in any case.
        coupling: (3,3) of `yield_attitude`.
        yields: whether the attitude gives way to the path.
        authority: code of how the vehicle flies.
    """

    in_plane: bool
    law: LawParts
    planar: PlanarParts
    target: Target
    loss: Record
    shortage: Record
    steers: bool
    coupling: Matrix
    yields: bool
    authority: float

    @classmethod
    def of(cls, controller: Controller) -> Steering | None:
        """None where only Python flies a controller, or where it has something to say at the coming tick."""
        never_lost, nothing_short = LossOfTargetMonitor(SafeMode()).memory, np.zeros(1, SHORTAGE)
        if type(controller) is PlanarFollower:
            told = controller.target, never_lost, nothing_short, False, np.zeros((3, 3)), False
            return cls(True, resting_law(), controller.parts, *told, float(controller.authority))
        if type(controller) is CompiledLaw and (own := controller.parts) is not None:
            told = controller.target, never_lost, nothing_short, False, np.zeros((3, 3)), own.own.in_parts
            return cls(False, own, resting_planar_law(), *told, float(controller.capability.authority))
        if type(controller) is not PathFollower or (parts := controller.ready) is None:
            return None
        left = controller.capability
        told = controller.target, controller.monitor.memory, controller.shortage, controller.points
        yielding = controller.coupling, controller.attitude_yields
        return cls(False, parts.arguments(controller), resting_planar_law(), *told, *yielding, float(left.authority))

    @property
    def addresses(self) -> tuple[int, int, int]:
        """Where the code of either law lies, and of `want_attitude`; what is at rest is not asked for, nor compiled."""
        if self.in_plane:
            return 0, planar_law_address(), 0
        return own_law_address() if self.law.own.code else law_address(), 0, attitude_address()


LAW = f"{__name__}:law_address"
"""What compiles the law for all axes, for `cube_sim.native.apart`."""


@cache
def law_address() -> int:
    """Where the code of the law for all axes lies, which is large."""
    if not ANSWERING.on_disk:
        finish(LAW)
    return ANSWERING.address()


@cache
def planar_law_address() -> int:
    """Where the code of the planar law lies; it is compiled only for those who fly by it."""
    return STEERING.address()


@cache
def own_law_address() -> int:
    """Where the code lies that asks a law of the user's own; it is compiled only for those who fly by one."""
    return ANSWERING.address(answer_by_own)

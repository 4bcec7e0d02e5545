"""Parts of a controller that are the user's own: the attitude wanted, and the motion law."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from cube_sim.control.attitude_mode import DesiredAttitude, Situation
from cube_sim.control.authority import Capability
from cube_sim.control.loop_times import LoopTimes
from cube_sim.guidance.law import DesiredMotion, TargetView
from cube_sim.guidance.path import Path
from cube_sim.mission.own.code import OwnCode, made, numbers_of, refused
from cube_sim.mission.own.handed import handed
from cube_sim.mission.own.others import NOBODY, Others
from cube_sim.scenario import Loaded, Scenario
from cube_sim.spatial import Vector
from cube_sim.vehicle.dynamics import Dynamics


@dataclass(frozen=True)
class PartSetup:
    """What an attitude or a motion law of one's own is made from.

    Attributes:
        scenario: what is flown.
        path: the path.
        dynamics: the hull's equations of motion, as the controller believes them.
        capability: what the thrusters can do.
        times: how fast the loops are that follow it [s].
        others: of several vehicles in one water, the states of the others, see `Others`.
    """

    scenario: Scenario
    path: Path
    dynamics: Dynamics
    capability: Capability
    times: LoopTimes
    others: Others = NOBODY


class OwnAttitude:
    """An `AttitudeMode` around a function of situation and dt, or around another one.

    The function answers a quaternion q_WD (4,) wxyz of any length, or that and its angular velocity (3,) [rad/s], world
    axes; by itself it is taken to stand still.

    Args:
        code: where it comes from.
        attitude: it.
    """

    def __init__(self, code: OwnCode, attitude: Any) -> None:
        self._code: OwnCode = code
        self._attitude: Any = attitude

    def attitude(self, situation: Situation, dt: float) -> DesiredAttitude:
        """See `AttitudeMode.attitude`."""
        ask = getattr(self._attitude, "attitude", self._attitude)
        quaternion, rates = two_parts(self._code.call(ask, handed(situation), dt))
        wanted = numbers_of(self._code, quaternion, (4,), "a quaternion")
        size = float(np.linalg.norm(wanted))
        if not size > 0.0:
            raise self._code.refuse("answers a quaternion without a direction")
        return DesiredAttitude(wanted / size, _or_zero(self._code, rates, "angular velocity"))


class OwnMotion:
    """A `MotionLaw` around a function of the view, or around another one.

    The function answers the velocity wanted (3,) [m/s], over ground, world axes, or that and its derivative along the
    present motion (3,) [m/s^2]; by itself it is taken to be steady.

    Args:
        code: where it comes from.
        motion: it.
    """

    def __init__(self, code: OwnCode, motion: Any) -> None:
        self._code: OwnCode = code
        self._motion: Any = motion

    def motion(self, view: TargetView) -> DesiredMotion:
        """See `MotionLaw.motion`."""
        ask = getattr(self._motion, "motion", self._motion)
        velocity, acceleration = two_parts(self._code.call(ask, handed(view)))
        wanted = numbers_of(self._code, velocity, (3,), "a velocity")
        return DesiredMotion(wanted, _or_zero(self._code, acceleration, "its derivative"))


def own_attitude(loaded: Loaded, code: OwnCode, setup: PartSetup) -> OwnAttitude:
    """The attitude a factory makes.

    Raises:
        ScenarioError: it makes none; with position.
    """
    return OwnAttitude(code, _asked(loaded, code, "attitude", setup))


def own_motion(loaded: Loaded, code: OwnCode, setup: PartSetup) -> OwnMotion:
    """The motion law a factory makes.

    Raises:
        ScenarioError: it makes none; with position.
    """
    return OwnMotion(code, _asked(loaded, code, "motion", setup))


def two_parts(answer: Any) -> tuple[Any, Any]:
    """An answer and what goes with it, None where it comes alone."""
    return (answer[0], answer[1]) if isinstance(answer, tuple | list) and len(answer) == 2 else (answer, None)


def _asked(loaded: Loaded, code: OwnCode, method: str, setup: PartSetup) -> Any:
    """What a factory makes, if it can be asked."""
    own = replace(setup, dynamics=deepcopy(setup.dynamics), capability=deepcopy(setup.capability))
    thing = made(loaded, code, own)
    with refused(loaded):
        if not callable(getattr(thing, method, thing)):
            raise code.refuse(f"makes a {type(thing).__name__}; it takes a function, or an object with {method}")
    return thing


def _or_zero(code: OwnCode, answer: Any, what: str) -> Vector:
    return np.zeros(3) if answer is None else numbers_of(code, answer, (3,), what)

"""A control law of the user's own that is compiled, as a controller: both loops ask the same machine code."""

from __future__ import annotations

from typing import Any

import numpy as np

from cube_sim.control.answering import LawParts
from cube_sim.control.asked import MEMORY as ASKED
from cube_sim.control.attitude_mode import DESIRED, Situation
from cube_sim.control.authority import Capability
from cube_sim.control.compiled_parts import own_law_parts
from cube_sim.control.controller import Decision
from cube_sim.control.following import FOLLOWED
from cube_sim.control.own_law import ANSWERED, OwnLawParts, PlainAim, ask, plain_aim, still_aim
from cube_sim.errors import OwnCodeError
from cube_sim.guidance.law import DesiredMotion, Target, TargetView
from cube_sim.guidance.view_record import record_of
from cube_sim.mission.own.asked_again import asked_again
from cube_sim.mission.own.code import OwnCode, numbers_of
from cube_sim.mission.own.compiled_part import CompiledPart
from cube_sim.mission.own.compiler_words import compiler_words
from cube_sim.mission.own.law import LawSetup
from cube_sim.native.asking import WORD
from cube_sim.spatial import State, Vector
from cube_sim.tuples import turned_to_world

ARRAY = "array(float64, 1d, C)"
"""What numba calls an array (n,) of floats that lie side by side."""


class CompiledLaw:
    """The controller around a compiled function of an aim, as `OwnLaw` is around one of Python's.

    Args:
        code: where the law comes from.
        part: the law.
        setup: what it was made from.

    Attributes:
        function: the law.
        target: on the path.
        capability: what the thrusters can do.

    Raises:
        OwnCodeError: it cannot be compiled, or answers something else than a wrench.
    """

    def __init__(self, code: OwnCode, part: CompiledPart, setup: LawSetup) -> None:
        self._code, self.function, self._parameters = code, part.function, part.parameters.copy()
        self.target: Target = setup.target
        self.capability = setup.capability
        self._motion, self._attitude = setup.motion, setup.attitude
        self._memory, self._ticks, self._asked = part.memory.copy(), np.zeros(1, np.int64), np.zeros(1, ASKED)
        self._scratch, self._secondary = np.zeros(part.memory.itemsize // WORD.itemsize), np.zeros(6)
        self._at: tuple[int, bool] | None = None
        self._own()  # compiled before the flight

    def __getstate__(self) -> dict[str, Any]:
        """All but where the machine code lies, which means nothing in another process."""
        return {**vars(self), "_at": None}

    @property
    def parts(self) -> LawParts | None:
        """The law as the compiled loop asks it; None where its motion or attitude is one that only Python knows."""
        return own_law_parts(self._own(), self._attitude, self._motion, self.capability.effort, self._asked)

    def take_up(self, other: CompiledLaw) -> None:
        """See `GoesOn.take_up`; the law itself and what it remembers stay."""
        self.target, self._motion, self._attitude = other.target, other._motion, other._attitude

    def view(self, state: State) -> TargetView:
        """See `Controller.view`."""
        return self.target.view(state.position, state.rotation @ state.velocity)

    def reconfigure(self, left: Capability) -> None:
        """Go on with other thrusters; the law is not told."""
        self.capability = left

    def decide(self, state: State, applied: Vector, dt: float, force_ratio: float = 1.0) -> Decision:
        """See `Controller.decide`."""
        R, before, own = state.rotation, self._asked[0], self._own()
        view = self.target.view(state.position, turned_to_world(R, state.velocity))
        motion = self._motion.motion(view)
        told = before["force"].copy(), before["torque"].copy(), np.zeros(3), self.capability.effort, force_ratio
        wanted = self._attitude.attitude(Situation(view, R, *told, np.asarray(motion.velocity, dtype=float)), dt)
        desired, followed = np.zeros(1, DESIRED), np.zeros(1, FOLLOWED)
        desired["quaternion"], desired["rates"] = wanted
        moving = R, state.quaternion, state.velocity, state.rates, *_vectors(motion)
        seen = record_of(view)
        given = *moving, applied, dt, force_ratio
        if ask(own, self._asked, seen, desired, followed, *given) != ANSWERED:
            raise self._error(plain_aim(self._ticks[0], seen, desired, *given))
        self.target.advance(view.speed, dt)
        answer = followed[0]
        return Decision(
            wrench=answer["wrench"],
            secondary=self._secondary.copy(),
            disturbance=np.zeros(6),
            current=np.zeros(3),
            view=view,
            remaining=view.remaining,
            velocity=answer["velocity"],
            rates=answer["rates"],
            quaternion=desired["quaternion"][0],
            attitude_error=float(answer["attitude_error"]),
            authority=self.capability.authority,
        )

    def _own(self) -> OwnLawParts:
        """The law as compiled code asks it."""
        self._at = self._at or self._compiled()
        address, in_parts = self._at
        words = self._memory.view(np.float64)
        return OwnLawParts(
            address,
            in_parts,
            self._ticks,
            self._parameters.view(WORD),
            self._memory.view(WORD),
            words,
            self._scratch,
            self._secondary,
        )

    def _compiled(self) -> tuple[int, bool]:
        """Where its machine code lies, and whether it answers two parts."""
        try:
            form = self.function.form(still_aim(), self._parameters[0], self._memory[0])
        except Exception as error:
            raise OwnCodeError(self._code.key, compiler_words(error, self._code)) from error
        if form.answers not in ((ARRAY,), (ARRAY, ARRAY)):
            answers = " and ".join(form.answers)
            text = (
                f"answers, compiled, {answers}; it takes a new array of 6 floats, or two: np.array or .copy() makes one"
            )
            raise self._code.refuse(text)
        return form.address, len(form.answers) == 2

    def _error(self, aim: PlainAim) -> OwnCodeError:
        """What went wrong, from a law that is asked once more."""
        answer = asked_again(self._code, self.function, aim, self._parameters, self._memory)
        if isinstance(answer, tuple):
            for part, what in zip(answer, ("a primary wrench", "a secondary wrench"), strict=True):
                numbers_of(self._code, part, (6,), what)
            answer = answer[0] + answer[1]
        numbers_of(self._code, answer, (6,), "a wrench")
        return self._code.refuse("raises an exception that it does not raise when it is asked again")


def _vectors(motion: DesiredMotion) -> tuple[Vector, Vector]:
    velocity, acceleration = motion
    return np.array(velocity, dtype=float), np.array(acceleration, dtype=float)

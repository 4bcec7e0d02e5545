"""An allocator of the user's own that is compiled: both loops ask the same machine code."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from cube_sim.allocation.allocation import Allocation, Status
from cube_sim.allocation.baselines.model import BaselineModel
from cube_sim.allocation.baselines.own_rule import answer_by_own_rule, pack_own_rule, places
from cube_sim.allocation.baselines.packing import PSEUDO_INVERSE
from cube_sim.allocation.exact.fewest_calls import INSTEAD
from cube_sim.allocation.exact.solve import answer_of, answer_size
from cube_sim.allocation.flown import FlownAllocator, SearchCodes
from cube_sim.allocation.previous import PreviousForces
from cube_sim.errors import OwnCodeError
from cube_sim.mission.own.allocation_setup import AllocationSetup
from cube_sim.mission.own.asked_again import asked_again
from cube_sim.mission.own.code import OwnCode, numbers_of
from cube_sim.mission.own.compiled_part import CompiledPart
from cube_sim.mission.own.compiler_words import compiler_words
from cube_sim.spatial import Vector

ARRAY = "array(float64, 1d, C)"
"""What numba calls an array (n,) of floats that lie side by side."""


class CompiledAllocator:
    """A compiled function from a wrench (6,) to forces (k,), whose answers are looked at.

    Args:
        code: where it comes from.
        part: it.
        setup: what it was made from.

    Raises:
        OwnCodeError: it cannot be compiled, or answers something else than forces.
    """

    def __init__(self, code: OwnCode, part: CompiledPart, setup: AllocationSetup) -> None:
        self._code, self._part = code, part
        self._model = BaselineModel(setup.A, setup.limits, setup.allow_off)
        words = (record.copy().view(np.float64) for record in (part.parameters, part.memory))
        self._packed = pack_own_rule(self._model.packed(PSEUDO_INVERSE), *words)
        self._address = self._compiled()

    def allocate(self, wrench: ArrayLike) -> Allocation:
        """See `WrenchAllocator.allocate`."""
        demand, finite = self._model.demand(wrench)
        n, k = self._model.A.shape
        row, sides = np.zeros(answer_size(n, k)), np.zeros(k, np.int8)
        answer_by_own_rule(self._address, 0, self._packed, demand, row, sides, np.zeros(2, np.int64))
        answer = answer_of(row, n, k)
        residual, cost, status = answer.rest[:3].tolist()
        if np.isnan(residual):
            self.ask_again()
        ended = Status(int(status)) if finite else Status.INVALID_WRENCH
        return Allocation(answer.force, answer.wrench, answer.error, residual, cost, sides, ended)

    def allocate_by_priority(self, primary: ArrayLike, secondary: ArrayLike) -> Allocation:
        """See `WrenchAllocator.allocate_by_priority`; the function gets the sum."""
        return self.allocate(self._model.sum_of_parts(primary, secondary))

    def ask_again(self) -> None:
        """Ask for the demand that had no answer, for the reason.

        Raises:
            OwnCodeError: it has none again.
        """
        first, second, third, fourth = places(self._packed)
        parameters, memory = self._packed[first:second].copy(), self._packed[second:third].copy()
        records = parameters.view(self._part.parameters.dtype), memory.view(self._part.memory.dtype)
        answer = asked_again(self._code, self._part.function, self._packed[fourth:], *records)
        numbers_of(self._code, answer, (self._model.A.shape[1],), "forces")
        raise self._code.refuse("has no answer that it has when it is asked again")

    def reset(self) -> None:
        """See `WrenchAllocator.reset`."""
        self._told()[:] = np.concatenate([each.view(np.float64) for each in (self._part.parameters, self._part.memory)])

    def resume(self, previous: PreviousForces) -> None:
        """See `WrenchAllocator.resume`; the function knows its own memory only."""

    def memory(self) -> Vector:
        """What `recall` needs to go on from here."""
        return self._told().copy()

    def recall(self, memory: Vector) -> None:
        """Go on from a memory."""
        self._told()[:] = memory

    def flown(self, two_parts: bool) -> FlownAllocator:
        """See `FlownAllocator`."""
        size = answer_size(*self._model.A.shape)
        return FlownAllocator(self._packed, self._codes, size, lambda *_: None, False, lambda *_: None)

    def _codes(self) -> SearchCodes:
        return SearchCodes(self._address, INSTEAD.address(answer_by_own_rule), 0)

    def _told(self) -> Any:
        """Parameters and memory: nothing keeps a function from writing into either."""
        first, _, third, _ = places(self._packed)
        return self._packed[first:third]

    def _compiled(self) -> int:
        """Where its machine code lies."""
        part = self._part
        try:
            form = part.function.form(np.zeros(len(self._model.A)), part.parameters[0], part.memory[0])
        except Exception as error:
            raise OwnCodeError(self._code.key, compiler_words(error, self._code)) from error
        if form.answers != (ARRAY,):
            text = "it takes a new array of floats, one for each thruster: np.array or .copy() makes one"
            raise self._code.refuse(f"answers, compiled, {' and '.join(form.answers)}; {text}")
        return form.address

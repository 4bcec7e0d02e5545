"""A compiled function that has failed is asked once more, for the reason."""

from __future__ import annotations

from typing import Any

import numpy as np

from cube_sim.errors import OwnCodeError
from cube_sim.mission.own.code import OwnCode
from cube_sim.mission.own.handed import handed
from cube_sim.native.function import CompiledFunction
from cube_sim.spatial import Record


def asked_again(code: OwnCode, function: CompiledFunction, given: Any, parameters: Record, memory: Record) -> Any:
    """What a compiled function answers.

    Args:
        code: where it comes from.
        function: it.
        given: an aim, or a wrench (6,).
        parameters: (1,) structured.
        memory: (1,) structured; neither this nor what else is given changes.

    Raises:
        OwnCodeError: it raises. Compiled code does not know on which line an index is out of bounds: Python is asked.
    """
    try:
        return code.call(function, handed(given), parameters.copy()[0], memory.copy()[0])
    except OwnCodeError as error:
        if not isinstance(error.__cause__, IndexError):
            raise
        as_python = [record.copy().view(np.recarray)[0] for record in (parameters, memory)]
        code.call(function.py_func, handed(given), *as_python)
        raise

"""What numba says of a function that it cannot compile, in one line."""

from __future__ import annotations

import re
from pathlib import Path
from traceback import walk_tb
from typing import Any

from cube_sim.mission.own.code import OwnCode, failure, one_line

LONGEST = 200
"""Of numba's words, in letters: what follows are its own candidates."""
_LOOKED_AT = "inst", "expr", "stmt", "constraint", "self"
"""What numba's own functions call the piece of the user's that they are at."""
WRITES = "floats into whole numbers, into arrays from outside, or m.a = for m.a[:] ="
"""What numba has no words for, and ends at with an error of its own."""


def compiler_words(error: Exception, code: OwnCode) -> str:
    """Why a function cannot be compiled, and the line of its file where that shows.

    Args:
        error: of the compiler's.
        code: where the function comes from.
    """
    place, said = getattr(error, "loc", None), [line.strip() for line in str(error).splitlines() if line.strip()]
    if said and said[0].startswith("Failed in nopython mode"):
        said = said[1:]
    if place is None or not said:
        if line := _line_of(error, code.file):
            return f"{Path(code.file).name}:{line}: cannot be compiled: {_reason(error)[:LONGEST]}"
        return failure(error, code.file) or f"{code.name} cannot be compiled: {one_line(error)[:LONGEST]}"
    words = f"{said[0]} {said[1]}" if said[0].endswith(":") and len(said) > 1 else said[0]
    words = re.sub(r"(of type \w+)\(.*", r"\1", words)[:LONGEST]
    return f"{Path(place.filename).name}:{place.line}: cannot be compiled: {words}"


def _reason(error: Exception) -> str:
    if isinstance(error, KeyError):
        return f"neither parameters nor memory have the name {error}"
    if isinstance(error, AttributeError | AssertionError):
        return f"numba fails here, as it does where one writes {WRITES} ({one_line(error)})"
    return one_line(error).removesuffix(" Raised from None").replace("..", ".")


def _line_of(error: Exception, file: str) -> int | None:
    """The line of a file at which the compiler was when it failed, None where it was at none."""
    lines = []
    for frame, _ in walk_tb(error.__traceback__):
        for name in _LOOKED_AT:
            place: Any = getattr(frame.f_locals.get(name), "loc", None)
            if file and getattr(place, "filename", None) == file:
                lines.append(place.line)
                break
        if lines and (step := frame.f_locals.get("current_inst")) is not None:
            lines.append(step.lineno)
    return lines[-1] if lines else None

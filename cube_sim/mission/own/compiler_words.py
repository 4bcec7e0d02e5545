"""What numba says of a function that it cannot compile, in one line."""

from __future__ import annotations

import re
from pathlib import Path

from cube_sim.mission.own.code import OwnCode, failure, one_line

LONGEST = 200
"""Of numba's words, in letters: what follows are its own candidates."""


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
        return failure(error, code.file) or f"{code.name} cannot be compiled: {one_line(error)[:LONGEST]}"
    words = f"{said[0]} {said[1]}" if said[0].endswith(":") and len(said) > 1 else said[0]
    words = re.sub(r"(of type \w+)\(.*", r"\1", words)[:LONGEST]
    return f"{Path(place.filename).name}:{place.line}: cannot be compiled: {words}"

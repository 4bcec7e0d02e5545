"""Thrusters by name: all of them, and those that are left."""

from __future__ import annotations

from collections.abc import Sequence

from cube_sim.errors import WrenchError
from cube_sim.nearest import among


def thruster_names(names: Sequence[str] | None, m: int) -> tuple[str, ...]:
    """(m,) names, T1..Tm unless given.

    Raises:
        WrenchError: there are not m different ones.
    """
    chosen = tuple(f"T{i + 1}" for i in range(m)) if names is None else tuple(names)
    if len(chosen) != m or len(set(chosen)) != m:
        raise WrenchError(f"the names {', '.join(chosen)} are not {m} different ones")
    return chosen


def left_after(names: tuple[str, ...], lost: Sequence[str]) -> list[int]:
    """Indices of the thrusters that are not lost.

    Raises:
        WrenchError: a lost one does not exist, or none is left.
    """
    for name in lost:
        if name not in names:
            raise WrenchError(f"no thruster {name!r}; there are {among(str(name), names)}")
    keep = [i for i, name in enumerate(names) if name not in set(lost)]
    if not keep:
        raise WrenchError(f"no thruster is left: all of {', '.join(names)} are lost")
    return keep

"""Values in place of a scenario's by dotted path, some of them relative to what stands there."""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from cube_sim.scenario.distribution_blocks import Gives

PARAMETERS = "parameters."
"""Before the name of a parameter of the model, in the path of one."""


_PARAMETER = re.compile(r"(?:vehicles\.(?P<vehicle>[^.]+)\.)?parameters\.(?P<name>.+)", re.DOTALL)


class ParameterPath(NamedTuple):
    """Where a parameter of a model is.

    Attributes:
        vehicle: among several, whose; "" of one.
        name: of the parameter.
    """

    vehicle: str
    name: str

    def beside(self, name: str) -> str:
        """The dotted path of another parameter of the same model."""
        return f"vehicles.{self.vehicle}.{PARAMETERS}{name}" if self.vehicle else f"{PARAMETERS}{name}"


def parameter_at(path: str) -> ParameterPath | None:
    """Which parameter of a model a dotted path names; None for a key of the scenario."""
    found = _PARAMETER.fullmatch(path)
    return None if found is None else ParameterPath(found["vehicle"] or "", found["name"])


def is_parameter(path: str) -> bool:
    """Whether a dotted path names a parameter of a model."""
    return parameter_at(path) is not None


def value_at(data: Any, path: str) -> Any:
    """What stands at a dotted path of plain data.

    Raises:
        LookupError: nothing does.
    """
    here = data
    for step in path.split("."):
        if isinstance(here, Mapping) and step in here:
            here = here[step]
        elif isinstance(here, list | tuple) and step.isdigit() and int(step) < len(here):
            here = here[int(step)]
        else:
            raise LookupError(path)
    return here


def combined(nominal: Any, gives: Gives, drawn: Any) -> Any:
    """The value that a drawn number makes of the one that stands there.

    Args:
        nominal: a number, or a list of n numbers; anything where `gives` is "value".
        gives: what the number drawn is.
        drawn: a number, or one for each of the n.

    Raises:
        ValueError: they do not go together; says why.
    """
    if gives == "value":
        return drawn
    if not _is_numbers(nominal):
        raise ValueError(f"there is no number that a {gives} could be of, but {nominal!r:.60}")
    numbers, change = np.asarray(nominal, dtype=np.float64), np.asarray(drawn, dtype=np.float64)
    if change.shape not in ((), numbers.shape):
        raise ValueError(f"takes 1 number, or one for each of the {numbers.size} that stand there; not {change.size}")
    match gives:
        case "factor":
            changed = numbers * change
        case "percent":
            changed = numbers * (1.0 + change / 100.0)
        case "offset":
            changed = numbers + change
    return changed.tolist()


def overrides_of(written: Mapping[str, Any], resolved: Mapping[str, Any], path: str, value: Any) -> dict[str, Any]:
    """Overrides that put a value at a path, also into a list that the file leaves to its default.

    Args:
        written: the scenario as the file has it, as plain data.
        resolved: the same with its defaults.
        path: dotted.
        value: plain; one number for a parameter of the model counts as a list of one.
    """
    if is_parameter(path) and isinstance(value, int | float) and not isinstance(value, bool):
        value = [value]
    steps = path.split(".")
    for depth in range(1, len(steps)):
        outer = ".".join(steps[:depth])
        if steps[depth].isdigit() and not _is_list_at(written, outer) and _is_list_at(resolved, outer):
            return {outer: list(value_at(resolved, outer)), path: value}
    return {path: value}


def _is_list_at(data: Mapping[str, Any], path: str) -> bool:
    try:
        return isinstance(value_at(data, path), list | tuple)
    except LookupError:
        return False


def _is_numbers(value: Any) -> bool:
    items = value if isinstance(value, list | tuple) and value else [value]
    return all(isinstance(item, int | float) and not isinstance(item, bool) for item in items)

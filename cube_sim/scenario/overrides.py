"""Overrides: values that replace those of a scenario file, addressed by dotted paths."""

from __future__ import annotations

import copy
import os
import re
from collections.abc import Mapping
from dataclasses import dataclass
from difflib import get_close_matches
from typing import Any

from cube_sim.scenario.document import Location

_TABLE = {"times_s", "values"}
"""What a table of set-points has to have."""
_INDEX = re.compile(r"0|[1-9][0-9]*")


@dataclass(frozen=True)
class Override:
    """One override.

    Attributes:
        path: as given, for example ``checks.0.at_most``.
        location: the path's keys and indices.
        value: plain data.
    """

    path: str
    location: Location
    value: Any


def apply(data: Any, overrides: Mapping[str, Any]) -> tuple[Any, list[Override], list[str]]:
    """Put overrides into a scenario's data; outer blocks first, whatever their order.

    Args:
        data: the parsed file; left as it is.
        overrides: dotted path -> value; numpy arrays and tuples count as lists, paths as text.

    Returns:
        The data with the overrides, the overrides that were applied, and a message per path that leads
        nowhere.
    """
    data = copy.deepcopy(data)
    applied: list[Override] = []
    messages: list[str] = []
    # A program may hand over anything as a key.
    messages += [f"override {path!r}: a path is text" for path in overrides if not isinstance(path, str)]
    named = [(path, value) for path, value in overrides.items() if isinstance(path, str)]
    for path, value in sorted(named, key=lambda item: item[0].count(".")):
        try:
            location = _put(data, path, _plain(value))
        except LookupError as error:
            messages.append(f"override {path}: {error.args[0]}")
        else:
            applied.append(Override(path, location, value))
    messages += _in_no_table(data, applied)
    return data, applied, messages


def _in_no_table(data: Any, applied: list[Override]) -> list[str]:
    """A message for what is put into set-points that nobody has: a new table takes both of its lists.

    Their names are an actuator's, so that a misspelt one makes a block of its own.
    """
    messages = []
    for each in applied:
        at = next((i for i, step in enumerate(each.location[:-2]) if step == "setpoints"), None)
        if at is None:
            continue
        there = data
        for step in each.location[: at + 1]:
            there = there[step]
        name = str(each.location[at + 1])
        if name not in there:
            continue
        others = [key for key, block in there.items() if key != name and isinstance(block, dict) and {*block} >= _TABLE]
        if isinstance(there[name], dict) and there[name].keys() >= _TABLE:
            continue
        there.pop(name)  # what it lacks is no news
        near = get_close_matches(name, others, n=1)
        meant = (
            f"did you mean {near[0]}?"
            if near
            else f"a new table takes times_s and values, beside those of {', '.join(others) or 'none'}"
        )
        messages.append(f"override {each.path}: no set-points of '{name}'; {meant}")
    return messages


def _put(data: Any, path: str, value: Any) -> Location:
    steps = path.split(".")
    if not all(steps):
        raise LookupError("an empty name in the path; write for example guidance.speed_m_s")
    here = data
    location: list[str | int] = []
    key: Any
    for depth, step in enumerate(steps):
        last = depth == len(steps) - 1
        parent = ".".join(steps[:depth]) or "the scenario"
        if isinstance(here, list):
            if not _INDEX.fullmatch(step) or int(step) >= len(here):
                raise LookupError(f"{parent} is a list of {len(here)}, '{step}' is not an index of it")
            key = int(step)
        elif isinstance(here, dict):
            key = step
            # A block that the file leaves to its defaults comes into being here.
            if not last and here.get(key) is None:
                here[key] = {}
        else:
            raise LookupError(f"{parent} is a single value and has no '{step}' inside")
        location.append(key)
        if last:
            here[key] = value
        else:
            here = here[key]
    return tuple(location)


def _plain(value: Any) -> Any:
    """Dicts, lists and scalars, from whatever a program hands over."""
    if isinstance(value, Mapping):
        return {str(key): _plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(item) for item in value]
    if hasattr(value, "tolist"):
        return value.tolist()
    return str(value) if isinstance(value, os.PathLike) else value

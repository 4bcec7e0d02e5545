"""The numbers of a channel's row by name, as any viewer shows them: `command.T1`, `lateral.y1_m`, `status: EXACT`.

A name that a viewer shows ends with its unit, as the keys of a scenario do. Numbers with names of their own are a
message inside the message; those whose names have two parts (`Fx/T1`) are messages inside that; where the first part
counts (`0/x`), a list of messages. A quantity whose values have labels is an enum.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from typing import NamedTuple, TypeAlias

from cube_sim.recording.channels import Channel, Field


class Number(NamedTuple):
    """A double.

    Attributes:
        name: as viewers show it.
        column: of the row.
    """

    name: str
    column: int


class Code(NamedTuple):
    """A number 0, 1, 2 ... that stands for a label.

    Attributes:
        name: as viewers show it.
        column: of the row.
        labels: what each stands for.
    """

    name: str
    column: int
    labels: tuple[str, ...]


class Numbers(NamedTuple):
    """Doubles without names.

    Attributes:
        name: of all of them.
        column: of the first.
        width: how many.
    """

    name: str
    column: int
    width: int


class Group(NamedTuple):
    """A message inside a message, or a list of them.

    Attributes:
        name: as viewers show it.
        elements: parts of each; one where it is no list.
        listed: whether it is one.
    """

    name: str
    elements: tuple[tuple[Part, ...], ...]
    listed: bool = False


Part: TypeAlias = "Number | Code | Numbers | Group"


def parts_of(channel: Channel) -> tuple[Part, ...]:
    """What a row of a channel holds behind its time, field by field."""
    return tuple(_part(field, columns.start) for field, columns in zip(channel.fields, channel.columns, strict=True))


def _part(field: Field, column: int) -> Part:
    if field.labels and field.is_single_number:
        return Code(field.name, column, field.labels)
    if field.is_single_number:
        return Number(_named(field.name, field.units[0]), column)
    if not field.columns:
        return Numbers(_named(field.name, field.units[0]), column, field.width)
    halves = [name.partition("/") for name in field.columns]
    numbers = [
        Number(_named(second or first, unit), column + k)
        for k, ((first, _, second), unit) in enumerate(zip(halves, field.units, strict=True))
    ]
    if not all(second for _, _, second in halves):
        return Group(field.name, (_distinct(numbers),))
    elements: dict[str, list[Number]] = {}
    for (first, _, _), number in zip(halves, numbers, strict=True):
        elements.setdefault(first, []).append(number)
    lists = tuple(_distinct(each) for each in elements.values())
    alike = {tuple(number.name for number in each) for each in lists}
    if len(alike) == 1 and all(name.isdigit() for name in elements):
        return Group(field.name, lists, listed=True)
    names = _distinct(Number(_named(name, "1"), 0) for name in elements)
    return Group(field.name, (tuple(Group(each.name, (some,)) for each, some in zip(names, lists, strict=True)),))


def identifier(text: str) -> str:
    """A text as a name that protobuf allows."""
    signs = text.replace("+", "_plus").replace("-", "_minus") if text[-1:] in ("+", "-") else text
    name = re.sub(r"[^A-Za-z0-9]+", "_", signs).strip("_") or "unnamed"
    return f"n{name}" if name[0].isdigit() else name


def _named(name: str, unit: str) -> str:
    """A name with its unit at its end; a pure number has none."""
    return identifier(name) if unit == "1" else f"{identifier(name)}_{identifier(unit.replace('^', ''))}"


def _distinct(numbers: Iterable[Number]) -> tuple[Number, ...]:
    """The same, names that have become alike told apart by a number."""
    taken: dict[str, int] = {}
    told = []
    for number in numbers:
        count = taken[number.name] = taken.get(number.name, 0) + 1
        told.append(number if count == 1 else number._replace(name=f"{number.name}_{count}"))
    return tuple(told)

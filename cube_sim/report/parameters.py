"""What a scenario sets to something else than the default."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from pydantic_core import PydanticUndefined

from cube_sim.scenario.values import Block

LISTED_ELSEWHERE = ("schema_version", "name", "description", "checks", "events")
"""Keys at the top that the page shows in places of their own."""


@dataclass(frozen=True)
class SetParameter:
    """One key of a scenario.

    Attributes:
        key: dotted path, its unit in its last name.
        value: as the run had it.
        default: what it is otherwise; None where it has to be given.
    """

    key: str
    value: str
    default: str | None


def set_parameters(block: Block, default: object = None, prefix: str = "") -> Iterator[SetParameter]:
    """Every key below a block whose value is not the default.

    Args:
        block: of the scenario.
        default: the block in its place when nothing is given; where it is of another kind, or none, the keys of
            this kind have their own defaults.
        prefix: dotted path of the block, with a dot at its end.
    """
    for name, field in type(block).model_fields.items():
        if not prefix and name in LISTED_ELSEWHERE:
            continue
        key, value = f"{prefix}{name}", getattr(block, name)
        usual: Any = field.get_default(call_default_factory=True, validated_data={})
        if type(default) is type(block):
            usual = getattr(default, name)
        yield from _below(key, value, usual)


def _below(key: str, value: Any, usual: Any) -> Iterator[SetParameter]:
    if isinstance(value, Block):
        if usual is None:
            yield SetParameter(key, "given", "none")
        yield from set_parameters(value, usual, f"{key}.")
    elif isinstance(value, tuple) and any(isinstance(item, Block) for item in value):
        for index, item in enumerate(value):
            yield from _below(f"{key}.{index}", item, PydanticUndefined)
    elif isinstance(value, Mapping):
        for name, item in value.items():
            yield from _below(f"{key}.{name}", item, None)
    elif value != usual:
        yield SetParameter(key, _shown(value), None if usual is PydanticUndefined else _shown(usual))


def _shown(value: Any) -> str:
    """As a scenario file has it."""
    if value is None or value == ():
        return "none" if value is None else "[]"
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return f"{value:.12g}"
    if isinstance(value, tuple):
        return f"[{', '.join(map(_shown, value))}]"
    if isinstance(value, Block):
        return str(next(iter(value.model_dump().values()), "given"))
    return str(value)
